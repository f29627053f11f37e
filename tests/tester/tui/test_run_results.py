"""A run's results on the Run screen: a finished condition's value in Steps, and the table at the end."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from tester.results.columns import Output
from tester.results.conditions_table import conditions_table
from tester.results.run_results import results_of
from tester.service.present_results import grown_view, results_view
from tester.service.results_view import GivenResults, OpenValue
from tester.service.state_view import PlanStep, PlanView, StateView
from tester.store.run_reader import RunReader
from tester.tui.pages.run_page import RunPage
from tests.tester.kinds.wheel_on_belt.fit.made import made_run
from tests.tester.service.views import state
from tests.tester.tui.stage import Stage, play
from tests.tester.tui.test_screens import compare

DESIGN = [(25.0, 100.0, 0.3), (25.0, 200.0, 0.3), (25.0, 300.0, 0.3)]
TITLES = ("1#, 300 mm/s, 100 N, 25 degC", "200 N", "300 N")
"""Titles of the steps: in full, and by their differences."""


def at_run(folder: Path, over: int, outcome: str = "running") -> StateView:
    """Return the state of a stored run while it was under way."""
    view = state("RUN" if outcome == "running" else "OFFLINE")
    assert view.run is not None
    run = replace(view.run, name=folder.name, folder=str(folder), outcome=outcome, exit=0)
    progress = replace(view.progress, over=over, conditions=3)
    return replace(view, run=run, progress=progress)


def steps(done: int) -> PlanView:
    """Return a plan whose first conditions are done, and the next is under way."""
    listed = tuple(
        PlanStep(number, "condition", title, "done" if number <= done else "now" if number == done + 1 else "later",
                 60.0, 60.0 if number <= done else None, 60.0, number)
        for number, title in enumerate(TITLES, 1)
    )  # fmt: skip
    return PlanView("a", len(TITLES), 1, listed, 180.0)


def given(folder: Path) -> GivenResults:
    """Return the service's messages about a stored run."""
    with RunReader(folder) as reader:
        return results_view(reader, results_of(reader), folder.name, running=False)


def under_way(folder: Path, n: int) -> GivenResults:
    """Return the same while condition ``n`` is under way."""
    with RunReader(folder) as reader:
        results = results_of(reader)
        table = conditions_table(results)
        row = next(row for row in table.rows if row.info.condition == n)
        growing = grown_view(reader, results, table, row)
    whole = given(folder)
    return replace(whole, conditions=whole.conditions[:n], growing=growing, over=False)


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
        await on.show(at_run(folder, 2), steps(2), given(folder))
        await on.until(lambda: two in on.text(), "the values are shown")
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
        await on.show(at_run(folder, 1), steps(1), given(folder))
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
        assert on.app.scene.table is None and not page.has_class("-ended") and not on.app.shown_messages

    play(act, tmp_path)


def test_a_screen_on_another_computer_has_the_values_that_the_service_sends(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "elsewhere" / "one", DESIGN)
    one, two, three = shown_by_tables(folder)

    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        far = replace(at_run(folder, 2), run=replace(at_run(folder, 2).run, folder="/not/here/one"))
        await on.show(far, steps(2), given(folder))
        await on.until(lambda: one in on.text() and two in on.text() and three not in on.text(), "in Steps")
        assert far.run is not None
        await on.show(replace(far, mode="OFFLINE", run=replace(far.run, outcome="done")), steps(3))
        await on.until(lambda: "Results of one" in on.text(), "at the end")
        assert all(value in on.text() for value in (one, two, three))

    play(act, tmp_path, (120, 40))


def test_the_present_condition_shows_its_value_as_it_grows(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "runs" / "one", DESIGN)
    growing = under_way(folder, 2)
    assert growing.growing is not None
    growing = replace(growing, growing=replace(growing.growing, open=OpenValue(4, 0.6543, 12)))
    assert growing.growing is not None
    last = growing.growing.grown[-1]

    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        await on.show(at_run(folder, 1), steps(1), growing)
        wanted = f"now: {last.text} after {last.repeats} of {growing.growing.asked}; repeat 4: 0.654 so far"
        await on.until(lambda: wanted in on.text(), "it grows")

    play(act, tmp_path, (120, 40))


def test_results_of_another_run_are_not_shown(tmp_path: Path) -> None:
    folder = made_run(tmp_path / "runs" / "one", DESIGN)
    one, *_ = shown_by_tables(folder)

    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        await on.show(at_run(folder, 1), steps(1), replace(given(folder), run="another"))
        await on.pilot.pause()
        assert one not in on.text()

    play(act, tmp_path, (120, 40))
