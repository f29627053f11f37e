"""This machine, for a service (``tester.machine.served``)."""

from __future__ import annotations

from typing import Final

from drivers.temperature_controller import JACKET_LEASE_S
from tester.base.quantities import Quantities
from tester.base.screen import MachineView
from tester.inputs.rig import Rig
from tester.inputs.rig.profiles import profile_of
from tester.kinds.wheel_on_belt.context import Attendant
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.served import manual
from tester.kinds.wheel_on_belt.served.left_on_rig import HeatHistory, WheelLeft, left_by
from tester.kinds.wheel_on_belt.served.screen import MACHINE, WheelPanel
from tester.machine.engine import Engine
from tester.machine.panel import drives_alone
from tester.machine.rig_ports import Ports
from tester.machine.served import ByHand, History, Left, ServedKind
from tester.store.recorder import Recorder
from tester.store.run_reader import RunReader

PRESS = "The press stops where it is: where no spring lifts it, its load stays on the wheel."


def left_alone(rig: RigConfig) -> str:
    """Return the unattended behaviour of drives and heating with its times, from the rig file's numbers."""
    return drives_alone(rig, PRESS, _heating(rig))


def _heating(rig: RigConfig) -> str:
    jacket = rig.devices["jacket"]
    profile = profile_of(jacket.profile)
    if "lease" in profile.writes:
        return f"The jacket stops heating by itself ({JACKET_LEASE_S:g} s without a command)."
    if jacket.heat_off == "fallback" and profile.falls_back_s is not None:
        return f"The jacket falls back to a setpoint of no heat ({profile.falls_back_s:g} s without a command)."
    if jacket.heat_off == "relay":
        return "The jacket has no watchdog of its own: a relay, the rig file says, takes its supply. See to it."
    return "The jacket has no watchdog of its own: switch its supply off."


class WheelOnBelt(ServedKind):
    """The kind's answers to a service."""

    machine: MachineView = MACHINE
    quantities: Quantities = QUANTITIES

    def panel(self, engine: Engine) -> WheelPanel:
        """Return the view of a run for clients."""
        return WheelPanel(engine)

    def alone(self, rig: Rig) -> str:
        """Return the behaviour of drives and heating without a master."""
        return left_alone(RigConfig.of(rig))

    def left(self, reader: RunReader, name: str) -> WheelLeft:
        """Return the wheel that a run left on its rig."""
        return left_by(reader, name)

    def by_hand(
        self, rig: Rig, ports: Ports, attendant: Attendant, record: Recorder, left: Left | None, history: History
    ) -> ByHand:
        """Let a person command the run instead of a recipe."""
        heat = history.ratio if isinstance(history, HeatHistory) else NO_HISTORY
        mounted = left if isinstance(left, WheelLeft) else None
        return manual.by_hand(RigConfig.of(rig), ports, attendant, record, mounted, heat)


SERVED: Final = WheelOnBelt()
