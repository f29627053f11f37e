"""The figures over many seeds judge their input: each can miss."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.campaigns.seeds.__main__ import measure
from tests.campaigns.seeds.sweeps import Sweeps, SweepSpec, Swept
from tests.campaigns.seeds.topics import TOPICS

RUN = {"exit_code": "0", "missing_rows": "0", "rows": "2", "outcome": "done", "rig_seconds": "1000"}
ROW = {"compound": "1#", "load_n": "100", "slip_velocity_mm_s": "300", "sideslip_deg": "0", "temperature_c": "40"}


class Played(Sweeps):
    """Sweeps with prepared results: some oddity of the first run and of some rows."""

    def __init__(
        self, rows: int, odd_run: dict[str, str] | None = None, odd_rows: dict[int, dict[str, str]] | None = None,
        *, full: bool = False,
    ) -> None:
        super().__init__(Path(), full=full, jobs=1)
        self.rows = rows
        self.odd_run = odd_run or {}
        self.odd_rows = odd_rows or {}
        self.planned = {"rig_seconds": 1000, "rig_seconds_low": 900, "rig_seconds_high": 1100, "conditions": rows}

    def sweep(self, spec: SweepSpec) -> Swept:
        """Return results without running anything."""
        runs = [{**RUN, "seed": str(seed)} for seed in range(spec.seeds)]
        runs[0] |= self.odd_run
        conditions = [{**ROW, "seed": "0", "status": "ok", "reason": ""} for _ in range(self.rows * spec.seeds)]
        for place, odd in self.odd_rows.items():
            conditions[place] |= odd
        code = 6 if self.odd_run.get("exit_code", "0") != "0" else 0
        return Swept(code, runs, conditions)

    def plan(self, spec: SweepSpec) -> dict[str, object]:
        """Return a plan of 1000 s."""
        return dict(self.planned)


def missed(topic: str, sweeps: Sweeps) -> int:
    return measure([TOPICS[topic]], sweeps)


@pytest.mark.parametrize("topic", ["quickstart", "loads", "table2", "estimate"])
def test_results_as_asked_miss_nothing(topic: str) -> None:
    rows = {"quickstart": 2, "loads": 24, "table2": 9, "estimate": 2}[topic]
    assert missed(topic, Played(rows)) == 0


@pytest.mark.parametrize("odd", [{"exit_code": "6"}, {"missing_rows": "1"}, {"rows": "1"}])
def test_one_incomplete_seed_of_the_quickstart_misses(odd: dict[str, str]) -> None:
    assert missed("quickstart", Played(2, odd)) > 0


def test_a_lost_condition_of_24_is_more_than_one_per_cent() -> None:
    assert missed("loads", Played(24, odd_rows={3: {"status": "insufficient"}})) == 1


def test_a_trip_in_table_2_misses() -> None:
    assert missed("table2", Played(9, {"outcome": "tripped"})) == 1


def test_a_missing_row_of_table_2_misses() -> None:
    short = Played(9)
    short.planned["conditions"] = 10
    assert missed("table2", short) == 1


def test_a_condition_without_a_reason_misses() -> None:
    lost = {"status": "temperature cannot be held", "reason": ""}
    assert missed("table2", Played(9, odd_rows={0: lost})) == 1


def test_a_row_without_value_for_drift_misses_and_one_for_heat_does_not() -> None:
    drifted = {"status": "insufficient", "reason": "2 of 3 valid: repeat 1 drift +3 %"}
    hot = {"status": "temperature cannot be held", "reason": "surface warms by 2 K/s"}
    assert missed("table2", Played(9, odd_rows={0: drifted})) == 1
    assert missed("table2", Played(9, odd_rows={0: hot})) == 0


def test_an_estimate_six_per_cent_off_misses() -> None:
    slow = Played(2, full=True)
    slow.planned["rig_seconds"] = 940
    assert missed("estimate", slow) == 5


def test_a_range_that_holds_few_runs_misses() -> None:
    narrow = Played(2)
    narrow.planned["rig_seconds_low"] = 1001
    assert missed("estimate", narrow) == 1
