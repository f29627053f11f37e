"""The commands of each mode, and the inputs of the interlock rows, as a kind of machine implements them.

``tester.machine.control`` calls them at their places of a scan.
"""

from __future__ import annotations

from math import copysign, isfinite
from typing import Generic, TypeVar

from tester.machine.image import BaseDemand, BaseReadings, BaseSetpoints
from tester.machine.inputs import ScanInputs
from tester.machine.state import ControlState

StateT = TypeVar("StateT", bound=ControlState[BaseSetpoints])
ReadingsT = TypeVar("ReadingsT", bound=BaseReadings)
DemandT = TypeVar("DemandT", bound=BaseDemand)
InputsT = TypeVar("InputsT", bound=ScanInputs)


class ModeCommands(Generic[StateT, ReadingsT, DemandT, InputsT]):
    """A kind's part of its control: what each mode commands, and the ends of its stops."""

    def __init__(self, state: StateT, view: InputsT) -> None:
        """``state``: control's memory, with the setpoints; ``view``: the inputs of the interlock rows."""
        self.state = state
        self.view = view

    # -- the inputs of its rows --------------------------------------------------------------------

    def look(self, demand: DemandT, readings: ReadingsT, scan_s: float, dt: float) -> None:
        """Update ``view`` for this scan, including ``ScanInputs.note_times``."""
        raise NotImplementedError

    def unfit(self, readings: ReadingsT) -> list[str]:
        """Return obstacles to arming beyond the rows."""
        return []

    def detail(self, readings: ReadingsT) -> str:
        """Return the values most useful to a reader of the trip."""
        raise NotImplementedError

    # -- outputs, written to ``state.setpoints`` ---------------------------------------------------

    def run_outputs(self, demand: DemandT, readings: ReadingsT, dt: float) -> None:
        """Command the demand, within the bounds; in RUN and in HOLD."""
        raise NotImplementedError

    def keep(self, held: DemandT, demand: DemandT) -> None:
        """Write a hold's demand after ``demand`` into ``held``: no contact."""
        raise NotImplementedError

    def stop_outputs(self) -> None:
        """Command a controlled stop, or a fast one (``state.mode``)."""
        raise NotImplementedError

    def safe_outputs(self) -> None:
        """Command a safe state at once, without reading anything: the program cannot continue."""
        raise NotImplementedError

    def emergency_outputs(self) -> None:
        """Mirror the hardware's emergency stop: nothing may start when the power returns."""
        raise NotImplementedError

    def rest_outputs(self) -> None:
        """Command nothing and request no power. An escalation remains until it is acknowledged."""
        raise NotImplementedError

    def withdraw_escalation(self) -> None:
        """Resume heartbeats to drives and devices: a person has acknowledged, or a run is armed."""
        self.state.setpoints.power_off = False

    def end_lease(self, readings: ReadingsT) -> None:
        """Let the lease of a device that is still on run out (``Interlock.ends_lease``)."""

    # -- stops ---------------------------------------------------------------------------------

    def note_stop(self) -> None:
        """Record the speeds and positions at the begin of a stop."""

    def note_fast_stop(self) -> None:
        """Record the speeds at the begin of a quick stop."""

    def note_rest(self) -> None:
        """Record the positions to rest at."""

    def stop_ended(self) -> bool:
        """Return whether the rig is at rest, unloaded and without heat, or the time for that is over."""
        raise NotImplementedError

    def must_cool(self) -> str:
        """Return why the machine must not stop turning yet after a controlled stop; "" if it may."""
        return ""

    def cool_outputs(self) -> str:
        """Command the cool-down; return why it is over, "" until then."""
        raise NotImplementedError


def may_move(readings: BaseReadings) -> bool:
    """Return whether drives may be powered: safety chain and guard closed, every drive without a fault."""
    return readings.safety_chain and readings.guard_closed and not readings.drive_fault


def bounded(value: float, limit: float) -> float:
    """Clamp to +-limit; a value that is not finite becomes 0."""
    if -limit <= value <= limit:
        return value
    return copysign(limit, value) if isfinite(value) else 0.0
