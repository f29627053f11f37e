"""What this machine asks of its devices, and shows, before a run may begin."""

from __future__ import annotations

from math import inf

from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import Proof
from tester.kinds.wheel_on_belt.procedures.lift_check import Unloaded
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN
from tester.machine.wires import CAN_SILENT


class WheelArming:
    """The press lifts and the load cell is asked; wheel, belt and press follow, and stop without our heartbeat."""

    def __init__(self, devices: Devices, rig: RigConfig) -> None:
        """Nothing is sent."""
        self.devices = devices
        self.rig = rig

    def heard(self) -> bool:
        """Tell whether every Modbus device and the press drive's inputs have been heard."""
        return self.devices.answering() and self.devices.axes.press.inputs_stamp_s > -inf

    def renew(self) -> None:
        """Renew the jacket's lease; it stays in standby."""
        self.devices.jacket.set_setpoint(self.rig.loops.heat.hub_min_c)

    def unfit(self, now: float, configured_s: float) -> str:
        """Return what the safety inputs say, or that they say nothing."""
        press = self.devices.axes.press
        if not press.inputs & INPUT_SAFETY_CHAIN:
            return "safety chain"
        if not press.inputs & INPUT_GUARD:
            return "guard open"
        heard_s = max(press.inputs_stamp_s, configured_s)
        if not now - heard_s <= self.rig.interlocks.stale_inputs_s:
            return f"inputs stale: the {press.config.name} drive sends none"
        return ""

    def silent(self) -> str:
        """Return the row that says so."""
        return f"{CAN_SILENT.name}: {CAN_SILENT.cause}"

    def lift(self) -> Unloaded:
        """Lift the press, and ask the load cell."""
        return Unloaded(self.devices, self.rig)

    def prove(self) -> Proof:
        """Try out the drives."""
        return Proof(self.devices, self.rig)
