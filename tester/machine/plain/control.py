"""The commands of a plain machine in each mode: the demand in RUN, standstill in every other mode."""

from __future__ import annotations

from tester.inputs.rig.plain_rig import PlainRig
from tester.machine.interlock_table import InterlockTable
from tester.machine.mode_commands import bounded
from tester.machine.plain.image import PlainDemand, PlainReadings, PlainSetpoints
from tester.machine.plain.rows import HOLD_AT_MOST_S, STOP_TIMEOUT_S, PlainInputs
from tester.machine.standstill import StandstillControl
from tester.machine.state import ControlState

State = ControlState[PlainSetpoints]


class PlainControl(StandstillControl[State, PlainReadings, PlainDemand, PlainInputs[PlainReadings]]):
    """The control of drives with speeds."""

    def __init__(self, rig: PlainRig, table: InterlockTable, readings: PlainReadings) -> None:
        """``readings``: the kind's readings, before anything has been read."""
        view = PlainInputs(rig=rig, readings=readings)
        state = ControlState(PlainSetpoints())
        super().__init__(rig, state, view, table, (PlainDemand(), PlainDemand()), HOLD_AT_MOST_S)
        self.axes = rig.axes
        self.stand()

    def look(self, demand: PlainDemand, readings: PlainReadings, scan_s: float, dt: float) -> None:
        """Update the inputs of the rows."""
        self.view.look(self.state, demand, readings, scan_s)

    def detail(self, readings: PlainReadings) -> str:
        """Return the speeds of the drives."""
        return ", ".join(f"{name} {value:.4g} {self.axes[name].unit}" for name, value in readings.drives.items())

    def run_outputs(self, demand: PlainDemand, readings: PlainReadings, dt: float) -> None:
        """Command the demand within the bounds; nothing moves before every drive is in operation."""
        self.enable(demand, readings)
        self.stand()
        if readings.drives_enabled:
            for name, wanted in demand.speeds.items():
                self.state.setpoints.speeds[name] = bounded(wanted, self.axes[name].max_speed)

    def keep(self, held: PlainDemand, demand: PlainDemand) -> None:
        """Demand standstill."""
        held.speeds.clear()

    def stand(self) -> None:
        """Command zero to every drive."""
        for name in self.axes:
            self.state.setpoints.speeds[name] = 0.0

    def motion_over(self) -> bool:
        """Return whether every drive is known to be at rest."""
        r = self.view.readings
        return r.standing and r.now_s - r.drives_at_s <= self._fresh_s

    def stop_ended(self) -> bool:
        """Return whether every drive is at rest, or the time limit for that has passed."""
        v = self.view
        over = v.readings.now_s - self.state.mode_since_s > v.parameters[STOP_TIMEOUT_S]
        return over or self.motion_over()

    _fresh_s = 0.5
    """A stop does not end on data older than this, s [A]: five scans at rest."""
