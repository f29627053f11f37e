"""A whole run with two belts on the twin; a run that dies in the middle of a change and is resumed."""

from __future__ import annotations

import csv
import sqlite3
from contextlib import closing
from math import prod
from pathlib import Path

import pytest

from tester.machine.prompts import DONE, Prompt, Prompts
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.record_file import DATABASE
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.run.cut_short import StoppedError
from tests.tester.run.test_session import Screen

A, B = "zirconia corundum belt", "corundum 80"
TEXT = (
    SHORT.replace("window: 14 rev", "window: 4 rev\n  temperature_band: 4 degC")
    .replace("temperature: 25 degC", "temperature: 24 degC")
    .replace("load: 200 N", f"load: 60 N\n    surface: [{A}, {B}]")
    + "reference: {every: 9, temperature: 24 degC, load: 60 N, slip_velocity: 200 mm/s}\n"
)
"""On each belt a reference, a condition, a reference."""
SETS = (*(one for one in QUIET if "scatter" not in one), "sim.variability.wheel=0", "sim.variability.run=0",
        "sim.friction_heat_fraction=0", "sim.counterface.loss=0.1", "sim.counterface.loss_travel=1000 m",
        "sim.record_truth=true")  # fmt: skip


def options(home: Path) -> SessionOptions:
    (home / "belts.yaml").write_text(TEXT, encoding="utf-8")
    return SessionOptions(recipe=str(home / "belts.yaml"), out=home / "runs", overrides=SETS, seed=3)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A complete run."""
    home = tmp_path_factory.mktemp("whole")
    assert Session(options(home), Screen()).run() == 0
    return next((home / "runs").iterdir())


@pytest.fixture(scope="module")
def resumed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that died when a person had to change to the second belt, and was resumed."""
    home = tmp_path_factory.mktemp("resumed")
    ask = Prompts.ask

    def dying(
        self: Prompts, now: float, text: str, *, near: bool = True, unit: str = "", by_itself: str = DONE
    ) -> Prompt:
        if B in text:
            raise StoppedError
        return ask(self, now, text, near=near, unit=unit, by_itself=by_itself)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Prompts, "ask", dying)
        with pytest.raises(StoppedError):
            Session(options(home), Screen()).run()
    folder = next((home / "runs").iterdir())
    assert Session(SessionOptions(), Screen()).resume(folder, "") == 0
    return folder


def truth(folder: Path, name: str) -> list[float]:
    """Return a value that the twin knew at each repeat that was begun."""
    with closing(sqlite3.connect(folder / DATABASE)) as database:
        return [value for (value,) in database.execute("SELECT value FROM truth WHERE name = ? ORDER BY id", (name,))]


def table(folder: Path) -> dict[str, dict[str, str]]:
    with (folder / "conditions.csv").open(encoding="utf-8") as file:
        return {row["surface"]: row for row in csv.DictReader(file) if row["grid"] == "one"}


def test_the_table_has_a_row_for_each_belt(whole: Path) -> None:
    rows = table(whole)
    assert [*rows] == [A, B] and all(row["mu"] for row in rows.values())


def test_the_coefficients_are_those_of_the_belt_that_was_on(whole: Path) -> None:
    rows, model, belt = table(whole), truth(whole, "model"), truth(whole, "belt")
    ratio = model[4] * belt[4] / (model[1] * belt[1])  # of the conditions between the references
    assert abs(ratio - 1.0) > 0.02
    assert float(rows[B]["mu"]) / float(rows[A]["mu"]) == pytest.approx(ratio, rel=0.03)


def test_each_belt_has_its_own_wear(whole: Path) -> None:
    grips = truth(whole, "belt")
    first, second = grips[:3], grips[3:]
    assert first == sorted(first, reverse=True) and second == sorted(second, reverse=True)
    assert second[0] > first[-1]  # a fresh belt, although the first one has travelled


def test_each_belt_has_its_own_drift_and_chart(whole: Path) -> None:
    with RunReader(whole) as reader:
        watch = results_of(reader).watch
    assert watch is not None and [*watch.drifts] == [A, B]
    assert [(chart.surface, len(chart.points)) for chart in watch.charts] == [(A, 2), (B, 2)]
    assert [line.partition(":")[0] for line in watch.lines("wheel")][:2] == [f"on {A}", f"on {B}"]


def test_the_belts_and_the_questions_are_on_record(whole: Path) -> None:
    with RunReader(whole) as reader:
        changes = [event.text.partition(" is on")[0] for event in reader.events() if event.kind == "surface"]
        asked = [prompt.text for prompt in reader.prompts() if prompt.text.startswith("put belt")]
        travels_m = resume_point(reader).stand.travels_m
    assert changes == [A, B]
    assert asked == [f"put belt {A} on, clean and without dust", f"put belt {B} on, clean and without dust"]
    assert travels_m[A] > 0.0 and travels_m[B] > 0.0


def test_a_change_that_was_interrupted_is_asked_for_again_before_anything_moves(resumed: Path) -> None:
    with RunReader(resumed) as reader:
        second = next(one for one in reader.sessions() if one.session == 2)
        prompts = [one for one in reader.prompts() if one.asked_s >= second.origin_s]
        begun = [one.begun_s for one in reader.repeats() if one.begun_s >= second.origin_s]
    assert prompts[0].text == f"put belt {B} on, clean and without dust, if it is not on already"
    assert begun and prompts[0].answered_s <= min(begun)


@pytest.mark.parametrize("place", ["whole", "resumed"])
def test_nothing_is_measured_twice_and_every_coefficient_is_the_twins(
    place: str, request: pytest.FixtureRequest
) -> None:
    folder: Path = request.getfixturevalue(place)
    with RunReader(folder) as reader:
        assert [one.condition for one in reader.repeats()] == [1, 2, 3, 4, 5, 6]
    rows, factors = table(folder), [truth(folder, name) for name in ("model", "condition", "belt")]
    known = {A: prod(values[1] for values in factors), B: prod(values[4] for values in factors)}
    assert {name: float(row["mu"]) for name, row in rows.items()} == pytest.approx(known, rel=0.03)
    assert factors[2][3] > factors[2][2]  # the second belt is fresh, also where the run resumed on it
