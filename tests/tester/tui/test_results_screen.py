"""Results: the series in the plot, the repeats of a condition, and leaving one out with a reason."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from textual.widgets import Input

from tester.analysis.flags import FLAGS
from tester.base.lock import RUN_LOCK, ExclusiveUse
from tester.kinds.wheel_on_belt.image.axes import AXES
from tester.results.run_files import write_all
from tester.results.run_results import results_of
from tester.service.address import HAS_UNIX
from tester.service.commands import ExcludeRepeat, Stop
from tester.service.state_view import ProgressView
from tester.store.run_reader import RunReader
from tester.tui.dialogs.repeats_dialog import ExcludeDialog, RepeatsDialog
from tester.tui.pages.results_page import ResultsView
from tester.tui.stored import Row, Stored, points, read, series
from tests.tester.service.views import state
from tests.tester.store.build import small_run
from tests.tester.tui.stage import Stage, play

HELD = AXES.setpoint("1#", slip_velocity=0.3, load=200.0, temperature=25.0)
ROW = Row((), HELD, "1#", 0.7, 1)
ROWS = (
    ROW,
    replace(ROW, held=HELD.but(load=300.0), condition=2),
    replace(ROW, held=HELD.but(temperature=40.0), condition=3),
    replace(ROW, held=HELD.but("2#", load=300.0), compound="2#", condition=4),
    replace(ROW, held=HELD.but(load=400.0), mu=None, condition=5),
    replace(ROW, held=HELD.but(load=500.0, camber=5.0), condition=6),
)
STORED = Stored("run", Path(), "some recipe", "finished", (), "", ROWS, AXES)


def a_run(folder: Path, name: str = "one") -> Path:
    """Write a run of two loads below the folder of runs and return its folder."""
    run = small_run(folder / "runs" / name, ([0.90, 0.91, 0.89, 0.90], [0.70, 0.74, 0.72, 0.73]))
    write_all(run)
    return run


async def at_repeats(on: Stage, run: Path) -> None:
    """Open the repeats of the second condition."""
    await on.pilot.press("f5")
    view = on.app.screen_stack[0].query_one(ResultsView)
    view.open(read(str(run), run.parent))
    view.conditions_table.focus()
    await on.pilot.press("down", "enter")
    await on.until(lambda: "repeat 4: mu as measured 0.730" in on.text(), "the repeats are read")


def test_the_series_of_a_condition_differs_along_one_axis_alone() -> None:
    assert [row.condition for row in series(STORED, ROW, AXES["load"])] == [1, 2]
    assert [row.condition for row in series(STORED, ROW, AXES["temperature"])] == [1, 3]


def test_another_camber_is_another_series_and_camber_can_be_plotted_against() -> None:
    assert 6 not in [row.condition for row in series(STORED, ROW, AXES["load"])]
    assert [one.name for one in STORED.plotted] == ["load", "slip_velocity", "temperature", "sideslip", "camber"]


def test_points_of_other_series_are_faint_dots() -> None:
    assert [point.sign for point in points(STORED, AXES["load"], ROW)] == ["●", "●", "·", "·", "·"]


def test_a_condition_without_a_series_leaves_every_sign_as_it_is() -> None:
    assert [point.sign for point in points(STORED, AXES["slip_velocity"], ROW)] == ["1", "1", "1", "2", "1"]


def test_flags_are_shown_whole_and_a_longer_cell_ends_in_an_ellipsis(tmp_path: Path) -> None:
    flags = ", ".join(FLAGS)
    long = replace(STORED, header=("flags",), rows=(replace(ROW, cells=(flags,)), replace(ROW, cells=("x" * 400,))))

    async def act(on: Stage) -> None:
        await on.pilot.press("f5")
        view = on.app.screen_stack[0].query_one(ResultsView)
        view.open(long)
        cells = [str(view.conditions_table.get_row_at(row)[0]) for row in (0, 1)]
        assert cells == [flags, "x" * 299 + "…"]

    play(act, tmp_path)


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
def test_the_end_of_a_run_names_the_key_that_shows_its_results(size: tuple[int, int], tmp_path: Path) -> None:
    run = a_run(tmp_path)

    async def act(on: Stage) -> None:
        before = state("OFFLINE")
        assert before.run is not None
        over = replace(before.run, folder=str(run), outcome="incomplete", missing=("1#, 300 N: insufficient",), exit=6)
        await on.show(replace(before, run=over, progress=ProgressView(), prompt=None))
        await on.pilot.press("f3")
        await on.until(lambda: "Enter shows its results. Last run incomplete" in on.text(), "the run is over")
        await on.pilot.press("enter")
        await on.until(lambda: "0.900" in on.text() and on.app.view.id == "results", "the table is shown")

    play(act, tmp_path, size)


def test_enter_leads_nowhere_while_a_run_is_under_way(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f3", "enter")
        assert on.app.view.id == "run"

    play(act, tmp_path)


@pytest.mark.parametrize("size", [(80, 24), (120, 40)])
def test_the_plot_is_reached_at_every_size_and_names_its_series(size: tuple[int, int], tmp_path: Path) -> None:
    run = a_run(tmp_path)

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        await on.pilot.press("escape", *(["p"] if size[0] < 110 else []))
        assert "mu ± U against load (N): ● 1#, 300 mm/s, 25 degC   · others" in on.text()
        await on.pilot.press("p")
        assert "mu ± U against slip velocity (mm/s)" in on.text()

    play(act, tmp_path, size)


def test_a_repeat_is_left_out_with_a_reason_and_the_table_follows(tmp_path: Path) -> None:
    run = a_run(tmp_path)

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        await on.pilot.press("enter")
        assert isinstance(on.app.screen, ExcludeDialog) and "mu as measured 0.700" in on.text()
        await on.pilot.press(*"[/x]", "enter")
        await on.until(lambda: "✘ not in the mean: excluded by hand:" in on.text(), "the repeat is left out")
        assert "mu 0.730" in on.line(3)
        await on.until(lambda: "2/1 excluded" in on.text(), "what has become of the condition is said")
        await on.pilot.press("escape")
        await on.until(lambda: "excluded" in on.text() and "0.723" not in on.text(), "the table follows")

    play(act, tmp_path)
    with RunReader(run) as reader:
        (word,) = reader.exclusions()
    assert (word.target, word.reason, bool(word.operator)) == ((2, 1, 1), "[/x]", True)


@pytest.mark.skipif(not HAS_UNIX, reason="Unix sockets")
def test_a_repeat_of_the_run_under_way_is_left_out_by_the_screens_own_service(tmp_path: Path) -> None:
    shown = state().run
    assert shown is not None
    run = a_run(tmp_path, shown.name)

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        await on.pilot.press("enter", *"debris", "enter")
        assert await on.ordered(ExcludeRepeat) == ExcludeRepeat(shown.name, 2, "debris", 1)
        await on.until(lambda: "made anew at the run's end" in on.text(), "the end of it is said")

    with ExclusiveUse() as use:
        use.lock_file(run.name, run / RUN_LOCK, run.name, lasting=False)
        play(act, tmp_path)


def test_both_uncertainties_stand_above_the_repeats(tmp_path: Path) -> None:
    run = a_run(tmp_path)
    with RunReader(run) as reader:
        result = list(results_of(reader).conditions())[1].result

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        this, compound = result.budget.expanded, result.compound_budget.expanded
        told = f"mu {result.mu:.3f}  U this wheel {this:.3f}  U compound {compound:.3f}"
        await on.until(lambda: told in on.text(), "both are told, by name")

    play(act, tmp_path)


def test_the_head_of_the_record_is_below_the_runs(tmp_path: Path) -> None:
    run = a_run(tmp_path)
    with RunReader(run) as reader:
        head = reader.record_head()

    async def story(on: Stage) -> None:
        await on.pilot.press("f5")
        view = on.app.screen_stack[0].query_one(ResultsView)
        view.open(read(str(run), run.parent))
        await on.until(lambda: f"record head {head[:16]}" in on.text(), "the head is shown")
        assert 0 < on.text().index("Runs") < on.text().index("record head")

    play(story, tmp_path)


def test_without_a_reason_nothing_is_done(tmp_path: Path) -> None:
    run = a_run(tmp_path)
    before = (run / "run.db").read_bytes()

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        await on.pilot.press("enter", "space", "enter")
        await on.until(lambda: "a reason is needed" in on.text(), "the reason is asked for")
        assert isinstance(on.app.screen, ExcludeDialog)

    play(act, tmp_path)
    assert (run / "run.db").read_bytes() == before


def test_a_view_only_screen_changes_nothing(tmp_path: Path) -> None:
    run = a_run(tmp_path)

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        await on.pilot.press("enter")
        assert isinstance(on.app.screen, RepeatsDialog) and "view only" in on.text()

    play(act, tmp_path, view_only=True)


@pytest.mark.parametrize(("place", "keys"), {"repeats": [], "reason": ["enter", "a"], "plot": ["escape", "p"]}.items())
def test_stop_reaches_the_service_from(place: str, keys: list[str], tmp_path: Path) -> None:
    run = a_run(tmp_path)

    async def act(on: Stage) -> None:
        await at_repeats(on, run)
        await on.pilot.press(*keys)
        assert len(on.app.screen_stack) == (3 if place == "reason" else 2), on.text()
        assert place != "reason" or isinstance(on.app.focused, Input)
        for key in ("f12", "ctrl+x"):
            on.fake.orders.clear()
            await on.pilot.press(key)
            assert await on.ordered(Stop) == Stop()

    play(act, tmp_path)
