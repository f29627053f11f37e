"""The commands of each mode, and the inputs of the interlock rows, as a kind of machine implements them.

``tester.machine.control`` calls them at their places of a scan.
"""

from __future__ import annotations

from math import copysign, isfinite
from typing import Generic, TypeVar

from tester.base.deriving import mypyc_attr
from tester.machine.image import BaseDemand, BaseReadings, BaseSetpoints
from tester.machine.inputs import ScanInputs
from tester.machine.state import ControlState

StateT = TypeVar("StateT", bound=ControlState[BaseSetpoints])
ReadingsT = TypeVar("ReadingsT", bound=BaseReadings)
DemandT = TypeVar("DemandT", bound=BaseDemand)
InputsT = TypeVar("InputsT", bound=ScanInputs)


@mypyc_attr(allow_interpreted_subclasses=True)
class ModeCommands(Generic[StateT, ReadingsT, DemandT, InputsT]):
    """A kind's part of its control: the commands in each mode, and how its stops end."""

    def __init__(self, state: StateT, view: InputsT) -> None:
        """``state``: control's state between scans, with the setpoints; ``view``: the inputs of the interlock rows."""
        self.state = state
        self.view = view

    # -- the inputs of its rows --------------------------------------------------------------------

    def look(self, demand: DemandT, readings: ReadingsT, scan_s: float, dt: float) -> None:
        """Update ``view`` for this scan, including ``ScanInputs.note_times``."""
        raise NotImplementedError

    def unfit(self, readings: ReadingsT) -> list[str]:
        """Return the obstacles to arming that no row covers."""
        return []

    def doubts(self, readings: ReadingsT) -> list[str]:
        """Return what looks wrong in a rig at rest and does not prevent arming."""
        return []

    def detail(self, readings: ReadingsT) -> str:
        """Return the values that help a reader of the trip most."""
        raise NotImplementedError

    # -- outputs, written to ``state.setpoints`` ---------------------------------------------------

    def run_outputs(self, demand: DemandT, readings: ReadingsT, dt: float) -> None:
        """Command the demand, within the bounds; called in RUN and in HOLD."""
        raise NotImplementedError

    def keep(self, held: DemandT, demand: DemandT) -> None:
        """Write into ``held`` the demand of a hold that follows ``demand``: no contact."""
        raise NotImplementedError

    def stop_outputs(self) -> None:
        """Command a controlled stop, or a fast stop if ``state.mode`` is FAST_STOP."""
        raise NotImplementedError

    def safe_outputs(self) -> None:
        """Command a safe state at once, without reading anything, because the program cannot continue."""
        raise NotImplementedError

    def emergency_outputs(self) -> None:
        """Mirror the hardware's emergency stop, so that nothing starts when the power returns."""
        raise NotImplementedError

    def rest_outputs(self) -> None:
        """Command nothing and request no power. An escalation remains until a person acknowledges it."""
        raise NotImplementedError

    def withdraw_escalation(self) -> None:
        """Resume heartbeats to drives and devices, after an acknowledgement or when a run is armed."""
        self.state.setpoints.power_off = False

    def end_lease(self, readings: ReadingsT) -> None:
        """Let the lease of a device that is still on expire (``Interlock.ends_lease``)."""

    # -- stops ---------------------------------------------------------------------------------

    def note_stop(self) -> None:
        """Record the speeds and positions at the start of a stop."""

    def note_fast_stop(self) -> None:
        """Record the speeds at the start of a quick stop."""

    def note_rest(self) -> None:
        """Record the positions at which the axes rest."""

    def motion_over(self) -> bool:
        """Return whether the readings show that every axis has ended what a stop moves it for."""
        return self.stop_ended()

    def stop_ended(self) -> bool:
        """Return whether the rig is at rest, unloaded and without heat, or the time limit for that has passed."""
        raise NotImplementedError

    def must_cool(self) -> str:
        """Return why the machine must keep turning after a controlled stop; "" if it may stop."""
        return ""

    def cool_outputs(self) -> str:
        """Command the cool-down; return why it is over, "" while it continues."""
        raise NotImplementedError

    def cools_s(self) -> float:
        """Return the rig time for which the cool-down surely continues, s: noise of readings allowed for; 0 if it may
        end.
        """
        return 0.0


def may_move(readings: BaseReadings) -> bool:
    """Return whether drives may be powered: safety chain and guard closed, every drive without a fault."""
    return readings.safety_chain and readings.guard_closed and not readings.drive_fault


def bounded(value: float, limit: float) -> float:
    """Clamp to +-limit; a value that is not finite becomes 0."""
    if -limit <= value <= limit:
        return value
    return copysign(limit, value) if isfinite(value) else 0.0
