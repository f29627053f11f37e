"""Ring: errors against angle, speed and age, of the stored runs of one rig; nowhere for a machine without one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.analysis.ring_errors import RingRun, RingSegment
from tester.tui.pages.ring_page import RingPage
from tester.tui.rings import KeptRings
from tester.tui.widgets.ring_panel import columns
from tests.tester.kinds.wheel_on_belt.run.test_slip_ring import ring_run
from tests.tester.service.views import HOSTILE
from tests.tester.service.views import state as a_state
from tests.tester.tui.stage import Stage, play
from tests.tester.tui.test_other_kind import TRACK
from tests.tester.tui.test_screens import SIZES, compare


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with three runs, of 10, 20 and 60 errors."""
    for number, errors in enumerate((10, 20, 60), 1):
        ring_run(tmp_path / "runs" / f"2026-0{number}-01-run", f"2026-0{number}-01T08:00:00.000Z", errors)
    return tmp_path


async def at_ring(on: Stage) -> RingPage:
    await on.show(replace(a_state("OFFLINE"), run=None))
    await on.pilot.press("f7")
    page = on.app.query_one(RingPage)
    await on.until(lambda: bool(page.rows) and "looking" not in str(page.table.border_title), "the runs are read")
    await on.pilot.pause()
    return page


@pytest.mark.parametrize("size", SIZES)
def test_angle_speed_and_age_stand_on_the_page(size: str, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.tui.formatting.local", lambda moment: moment)

    async def act(on: Stage) -> None:
        await at_ring(on)
        text = on.text()
        assert "2026-03-01-run" in text and "3000" in text and "6.00" in text
        assert "1: most at 90°" in text and "2 to 4 rev/s" in text and "grows" in text
        compare(f"ring-{size}", text)

    play(act, folder, SIZES[size])


def test_the_run_under_the_cursor_is_described(folder: Path) -> None:
    async def act(on: Stage) -> None:
        page = await at_ring(on)
        assert page.chosen is not None and page.chosen.errors == 60
        await on.pilot.press("up", "up")
        await on.pilot.pause()
        assert page.chosen.errors == 10

    play(act, folder)


def test_a_new_ring_counts_from_the_run_under_the_cursor(folder: Path) -> None:
    async def act(on: Stage) -> None:
        page = await at_ring(on)
        await on.pilot.press("up", "n")
        await on.pilot.pause()
        assert [row.age for row in page.rows] == [1000.0, 2000.0]
        assert page.chosen is not None and page.chosen.name == "2026-02-01-run"
        assert "since 2026-02-01-run" in on.text()
        await on.pilot.press("n")
        assert [row.age for row in page.rows] == [1000.0, 2000.0, 3000.0]

    play(act, folder)


def test_a_machine_without_a_ring_has_no_such_screen(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        assert "F7 Ring" in on.line(1)
        on.fake.machine(TRACK)
        await on.until(lambda: on.app.scene.machine == TRACK, "the tables arrive")
        await on.show(a_state("OFFLINE"))
        await on.pilot.press("f7")
        await on.until(lambda: "this machine has no ring" in on.text(), "it is said")
        assert "F7" not in on.line(1) and on.app.view.id == "recipes"

    play(act, tmp_path)


def test_missing_and_invalid_runs_are_reported(tmp_path: Path) -> None:
    (tmp_path / "runs" / "broken").mkdir(parents=True)
    (tmp_path / "runs" / "broken" / "run.db").write_bytes(b"no database")

    async def act(on: Stage) -> None:
        await on.pilot.press("f7")
        page = on.app.query_one(RingPage)
        await on.until(lambda: str(page.table.border_title) == "Runs: 0", "the runs are read")
        assert "no run has a record of a ring" in on.text()

    play(act, tmp_path)


def test_stop_works_on_the_page(folder: Path) -> None:
    from tester.service.commands import Stop

    async def act(on: Stage) -> None:
        await at_ring(on)
        await on.pilot.press("f12")
        assert await on.ordered(Stop) == Stop(False)

    play(act, folder)


def test_columns_are_as_high_as_their_counts_and_the_greatest_has_its_number() -> None:
    counts = [0, 1, 4, 8, 0, 0, 0, 0, 0, 0, 0, 0]
    lines = columns(counts, 36, 6)
    assert len(lines) == 6 and lines[0].strip() == "8" and lines[-1].startswith("0     60")
    filled = [sum(line[3 * at : 3 * at + 1] not in ("", " ") for line in lines[1:-1]) for at in range(4)]
    assert filled == [0, 1, 2, 4]


def test_only_runs_of_the_rig_that_ran_last_are_shown(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from tester.run.kind_lookup import RingFound, ring_part

    part = ring_part("wheel_on_belt")
    assert part is not None

    def of(path: Path) -> RingFound:
        segment = RingSegment(100.0, [0, 0, 0, 10, 0], [0, 0, 0, 1, 0], [3.5])
        return RingFound(part, RingRun(path.name, path.name, [segment]), "a" if "01-01" in path.name else HOSTILE)

    monkeypatch.setattr("tester.tui.rings.ring_in", of)
    kept = KeptRings()
    kept.read(folder / "runs")
    assert [row.run.name for row in kept.rows()] == ["2026-02-01-run", "2026-03-01-run"]
