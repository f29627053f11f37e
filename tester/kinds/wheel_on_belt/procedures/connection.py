"""This machine's checks of its devices, and proofs, before a run may begin."""

from __future__ import annotations

from tester.kinds.wheel_on_belt.image.devices import Devices
from tester.kinds.wheel_on_belt.procedures.arming import Proof
from tester.kinds.wheel_on_belt.procedures.lift_check import Unloaded
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.connect import Arming


class WheelArming(Arming[Devices, RigConfig]):
    """The press lifts and the load cell is asked; wheel, belt and press follow, and stop without our heartbeat."""

    def renew(self) -> None:
        """Renew the jacket's lease; it stays in standby."""
        self.devices.jacket.set_setpoint(self.rig.loops.heat.hub_min_c)

    def lift(self) -> Unloaded:
        """Lift the press, and ask the load cell."""
        return Unloaded(self.devices, self.rig)

    def prove(self) -> Proof:
        """Try out the drives."""
        return Proof(self.devices, self.rig)
