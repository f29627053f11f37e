"""This machine, for a service (``tester.machine.served``)."""

from __future__ import annotations

from typing import Final

from drivers.temperature_controller import JACKET_LEASE_S
from tester.base.quantities import Quantities
from tester.base.screen import MachineView
from tester.inputs.rig import Rig
from tester.inputs.rig.profiles import profile_of
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.run.runs import RUNS
from tester.kinds.wheel_on_belt.served.left_on_rig import WheelLeft, left_by
from tester.kinds.wheel_on_belt.served.manual import WheelHand, take_over
from tester.kinds.wheel_on_belt.served.screen import MACHINE, WheelPanel
from tester.machine.panel import RunPanel, drives_alone
from tester.machine.run import Run
from tester.machine.run_parts import KindRun, Left
from tester.machine.served import ServedKind
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
        return "The jacket has no watchdog of its own: by the rig file a relay takes its supply. Check it."
    return "The jacket has no watchdog of its own: switch its supply off."


class WheelOnBelt(ServedKind):
    """The kind's answers to a service."""

    machine: MachineView = MACHINE
    quantities: Quantities = QUANTITIES
    runs: KindRun = RUNS
    panel: type[RunPanel] = WheelPanel

    def alone(self, rig: Rig) -> str:
        """Return the behaviour of drives and heating without a master."""
        return left_alone(RigConfig.of(rig))

    def left(self, reader: RunReader, name: str) -> WheelLeft:
        """Return the wheel that a run left on its rig."""
        return left_by(reader, name)

    def hand(self, run: Run, left: Left | None) -> tuple[WheelHand, str]:
        """Take the wheel that the newest run left, or a new one."""
        return take_over(run, left if isinstance(left, WheelLeft) else None)


SERVED: Final = WheelOnBelt()
