"""Every row of a plain machine in virtual time: against its delay, and with unknown inputs."""

from __future__ import annotations

from collections.abc import Callable
from math import inf, nan

import pytest

from tester.machine.plain.control import PlainControl
from tester.machine.plain.image import PlainDemand
from tester.machine.plain.rows import OPERATION, ROWS, SENSOR_SILENT, plain_table
from tester.machine.row import Interlock, Reaction
from tester.machine.state import Mode
from tester.machine.watches import condition
from tests.tester.machine.plain.bench import TABLE, BenchReadings, bench_rig

SCAN_S = 0.05
Change = Callable[[BenchReadings], None]


class Scans:
    """A control in RUN whose readings are healthy, scanned at 20 Hz."""

    def __init__(self) -> None:
        self.readings = BenchReadings()
        self.control = PlainControl(bench_rig(), TABLE, self.readings)
        self.demand = PlainDemand(enabled=True, speeds={"left": 10.0})
        self.now = 0.0
        self.change: Change = lambda r: None
        self.powered = self.standing = False
        self._read()
        self.readings.standing, self.readings.drives_disabled = True, True
        assert self.control.start(self.readings) == ""
        self.powered = True

    @property
    def mode(self) -> Mode:
        return self.control.state.mode

    def _read(self) -> None:
        r = self.readings
        r.now_s = r.inputs_at_s = r.drives_at_s = r.sensors_at_s = r.can_heard_s = self.now
        r.safety_chain = r.guard_closed = True
        r.drives_enabled, r.drives_disabled, r.standing = self.powered, not self.powered, self.standing
        r.drives = {"left": 10.0, "right": 0.0}
        r.drive_fault = r.device_fault = r.bus_fault = ""
        r.line_errors = 0.0

    def scan(self, count: int = 1) -> None:
        for _ in range(count):
            self.now = round(self.now + SCAN_S, 6)
            self._read()
            self.change(self.readings)
            self.control.step(self.demand, self.readings, SCAN_S)

    def until(self, holds: Callable[[], bool], at_most_s: float) -> float:
        """Scan until something holds; return the seconds it took. Raises TimeoutError."""
        began_s = self.now
        while not holds():
            if self.now - began_s > at_most_s:
                raise TimeoutError(self.mode)
            self.scan()
        return self.now - began_s

    def tripped(self) -> str:
        trip = self.control.state.trip
        return trip.name if trip is not None else ""


def frozen(name: str) -> Change:
    """Return a change that leaves a time stamp where it was at 1 s."""
    return lambda r: setattr(r, name, min(1.0, r.now_s))


def held(name: str, value: object) -> Change:
    return lambda r: setattr(r, name, value)


def drive(value: float) -> Change:
    return lambda r: r.drives.update(right=value)


CASES = [
    ("inputs stale", frozen("inputs_at_s"), 0.25),
    ("inputs stale", held("inputs_at_s", -inf), 0.0),
    ("inputs stale", held("inputs_at_s", nan), 0.0),
    ("device refused", held("device_fault", "exception 02"), 0.0),
    ("line noisy", held("line_errors", 0.31), 3.0),
    ("line noisy", held("line_errors", nan), 3.0),
    ("drive data stale", frozen("drives_at_s"), 0.125),
    ("drive data stale", held("drives_at_s", -inf), 0.0),
    ("drive data stale", held("drives_at_s", nan), 0.0),
    ("drive dropped out", held("drives_enabled", False), 0.05),
    ("overspeed", drive(105.1), 0.05),
    ("overspeed", drive(-105.1), 0.05),
    ("overspeed", drive(nan), 0.05),
    ("sensor silent", frozen("sensors_at_s"), 0.2),
    ("sensor silent", held("sensors_at_s", -inf), 0.0),
    ("sensor silent", held("sensors_at_s", nan), 0.0),
]


@pytest.mark.parametrize(("row", "change", "after_s"), CASES, ids=[f"{row}-{n}" for n, (row, _, _) in enumerate(CASES)])
def test_a_row_trips_after_its_delay_and_everything_is_commanded_to_stop(
    row: str, change: Change, after_s: float
) -> None:
    scans = Scans()
    scans.scan(19)
    scans.change = change
    took_s = scans.until(lambda: scans.tripped() != "", 5.0)
    assert scans.tripped() == row
    assert after_s - 1e-9 <= took_s <= after_s + 2 * SCAN_S + 1e-9
    out = scans.control.state.setpoints
    assert out.speeds == {"left": 0.0, "right": 0.0}
    fast = next(one.reaction for one in TABLE.rows if one.name == row) is Reaction.FAST
    assert scans.mode is (Mode.FAST_STOP if fast else Mode.STOPPING) and out.quick_stop is fast


@pytest.mark.parametrize(
    "change", [drive(105.0), held("line_errors", 0.3), lambda r: setattr(r, "sensors_at_s", r.now_s - 0.199)]
)
def test_at_its_limit_a_row_does_not_trip(change: Change) -> None:
    scans = Scans()
    scans.change = change
    scans.scan(100)
    assert scans.tripped() == "" and scans.mode is Mode.RUN


def test_a_stop_that_does_not_work_is_escalated_until_the_power_is_off() -> None:
    scans = Scans()
    scans.scan(20)
    scans.control.request_stop(scans.now, "stop")
    took_s = scans.until(lambda: scans.mode is Mode.FAST_STOP, 5.0)
    assert scans.tripped() == "not stopping" and took_s == pytest.approx(0.5 + 0.5, abs=2 * SCAN_S)
    took_s = scans.until(lambda: scans.control.state.setpoints.power_off, 5.0)
    assert took_s == pytest.approx(0.1 + 0.5, abs=2 * SCAN_S)
    scans.until(lambda: scans.mode is Mode.LATCHED, 12.0)
    assert any("stop not ended" in event.text for event in scans.control.state.events)


def test_a_stop_ends_only_by_the_readings() -> None:
    scans = Scans()
    scans.scan(20)
    scans.control.request_stop(scans.now, "stop")
    scans.scan(4)
    assert scans.mode is Mode.STOPPING
    scans.standing = True
    scans.scan()
    assert scans.mode is Mode.IDLE and not scans.control.state.setpoints.enable


def test_a_stop_does_not_end_on_old_data() -> None:
    scans = Scans()
    scans.scan(20)
    scans.standing, scans.change = True, held("drives_at_s", scans.now - 1.0)
    scans.control.request_stop(scans.now, "stop")
    scans.scan(4)
    assert scans.mode is not Mode.IDLE


@pytest.mark.parametrize("change", [held("standing", False), held("drives_at_s", -inf), held("drives_at_s", nan)])
def test_an_axis_that_moves_at_rest_or_is_unknown_loses_its_power(change: Change) -> None:
    scans = Scans()
    scans.control.request_stop(scans.now, "stop")
    scans.standing = True
    scans.scan(3)
    assert scans.mode is Mode.IDLE
    scans.change = change
    scans.scan(4)
    assert scans.tripped() == "moving at rest" and scans.control.state.setpoints.power_off


def test_power_that_a_run_does_not_want_trips() -> None:
    scans = Scans()
    scans.powered, scans.standing, scans.demand.enabled = False, True, False
    scans.scan(5)
    assert scans.mode is Mode.RUN
    scans.powered = True
    scans.scan(4)
    assert scans.tripped() == "moving at rest"


@pytest.mark.parametrize("row", [*ROWS, SENSOR_SILENT], ids=lambda row: row.name)
def test_every_row_states_its_limits_with_a_unit_and_has_a_message(row: Interlock) -> None:
    assert row in TABLE.rows and row.cause and row.watch.level and row.reset
    for one in row.declared():
        assert one.value is not None and one.text and one.hardest and one.because


def test_a_kinds_own_rows_stand_behind_the_wires_and_a_silent_sensor_and_before_the_rest() -> None:
    own = Interlock("own", "cause", condition("level", lambda v: False), SENSOR_SILENT.reaction, "reset")
    table = plain_table(own)
    names = [row.name for row in table.rows]
    assert names.index("sensor silent") < names.index("own") < names.index(ROWS[0].name)
    assert set(OPERATION) < set(table.parameters)


@pytest.mark.parametrize("asked", [150.0, -150.0, nan, inf])
def test_a_demand_beyond_the_axis_is_bounded_and_not_a_number_is_no_demand(asked: float) -> None:
    scans = Scans()
    scans.demand.speeds["left"] = asked
    scans.scan()
    expected = 0.0 if asked != asked or asked == inf else (100.0 if asked > 0.0 else -100.0)
    assert scans.control.state.setpoints.speeds["left"] == expected


@pytest.mark.parametrize("change", [held("safety_chain", False), held("guard_closed", False), held("drive_fault", "x")])
def test_nothing_is_enabled_while_it_may_not_move(change: Change) -> None:
    scans = Scans()
    scans.change = change
    scans.scan()
    assert scans.control.state.setpoints.speeds == {"left": 0.0, "right": 0.0}
    assert scans.mode is not Mode.RUN
