"""A run's results on the Run screen: a finished condition's value in Steps, and the table at the end."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.results.columns import Output
from tester.results.conditions_table import conditions_table
from tester.results.run_results import results_of
from tester.service.state_view import PlanStep, PlanView, StateView
from tester.store.run_reader import RunReader
from tester.tui.pages.run_page import RunPage
from tester.tui.stored import read
from tester.tui.widgets.ended_panel import step_value
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.service.views import state
from tests.tester.tui.stage import Stage, play
from tests.tester.tui.test_screens import compare

DESIGN = [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3), (25.0, 300.0, 0.3)]
TITLES = ("1#, 300 mm/s, 100 N, 25 degC", "200 N", "300 N")
"""Titles of the steps: in full, and by what differs."""


def at_run(folder: Path, over: int, outcome: str = "running") -> StateView:
    """Return the state of a stored run in its course."""
    view = state("RUN" if outcome == "running" else "OFFLINE")
    assert view.run is not None
    run = replace(view.run, name=folder.name, folder=str(folder), outcome=outcome, exit=0)
    progress = replace(view.progress, over=over, conditions=3)
    return replace(view, run=run, progress=progress)


def steps(done: int, first: int = 1, titles: tuple[str, ...] = TITLES) -> PlanView:
    """Return a plan whose first conditions are done."""
    listed = tuple(
        PlanStep(number, "condition", title, "done" if number < first + done else "later", 60.0,
                 60.0 if number < first + done else None, 60.0)
        for number, title in enumerate(titles, first)
    )  # fmt: skip
    return PlanView("a", len(titles) + first - 1, first, listed, 180.0)


def shown_by_tables(folder: Path) -> list[str]:
    """Return mu ± U of each condition as `tester show` prints both."""
    with RunReader(folder) as reader:
        table = conditions_table(results_of(reader)).view(Output.SHOW)
    return [f"{table['mu'].text(row)} ± {table['u_expanded'].text(row)}" for row in table.rows]


def test_steps_and_the_table_at_the_end_have_the_values_of_show(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "runs" / "one", DESIGN)
    one, two, three = shown_by_tables(folder)
    assert len({one, two, three}) == 3

    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        await on.show(at_run(folder, 2), steps(2))
        await on.until(lambda: on.app.scene.results is not None and two in on.text(), "the values are read")
        (first,) = [line for line in on.text().split("\n") if one in line]
        assert "300 mm/s, 100 N" in first and three not in on.text()
        assert f"last: 200 N: {two}" in on.text()
        await on.show(at_run(folder, 0, "done"), steps(3))
        await on.until(lambda: "Results of one: 3 of 3" in on.text(), "the table takes the place of the gauges")
        assert "Process: measured" not in on.text() and "Surface temp" not in on.text()
        text = on.text()
        for value in (one, two, three):
            assert all(number in text for number in value.split(" ± ")), text

    play(act, tmp_path, (120, 40))


def test_a_small_screen_has_the_last_value_and_the_table(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "runs" / "one", DESIGN)
    one, *_ = shown_by_tables(folder)

    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        await on.show(at_run(folder, 1), steps(1))
        await on.until(lambda: one in on.text(), "the last value is shown")
        await on.show(at_run(folder, 0, "done"), steps(3))
        await on.until(lambda: "Results of one" in on.text(), "the table is shown")
        assert "STOP" in on.line(-1) and one.split(" ± ")[1] in on.text()
        compare("run-80x24-ended", on.text())

    play(act, tmp_path, (80, 24))


def test_a_record_that_is_elsewhere_shows_no_value_and_no_complaint(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        await on.show(at_run(tmp_path / "runs" / "gone", 0, "done"), steps(3))
        page = on.app.query_one(RunPage)
        await on.until(lambda: not [w for w in on.app.workers if w.group == "results"], "it was looked for")
        assert on.app.scene.results is None and not page.has_class("-ended") and not on.app.shown_messages

    play(act, tmp_path)


@pytest.mark.parametrize(("first", "value"), [(1, True), (7, False)])
def test_replicates_are_told_apart_only_where_the_list_is_whole(tmp_path: Path, first: int, value: bool) -> None:
    folder = made_run(tmp_path / "runs" / "twice", [DESIGN[0], DESIGN[0]])
    stored = read(str(folder), tmp_path / "runs")
    plan = steps(2, first, (TITLES[0], TITLES[0]))
    found = [step_value(stored, plan.steps, at, whole=plan.first == 1) for at in (0, 1)]
    assert found == ([row.short for row in stored.rows] if value else ["", ""])
