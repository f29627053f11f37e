"""A stored run on the screens: results, replay, pictures."""

from __future__ import annotations

import asyncio
import runpy
from collections.abc import Awaitable, Callable
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tester.cli.main import invoke
from tester.tui.playback import Playback, load
from tester.tui.replay import ReplayApp
from tester.tui.screen_scene import ScreenScene
from tester.tui.stored import condition, read
from tests.tester.tui.stage import WAIT_S, screen_text

RECIPE = """\
recipe: short [/x]
specimens: [{compound: "1#"}]
measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 5 rev, temperature_band: 2 degC}
grids:
  - {name: one, slip_velocity: 200 mm/s, load: 100 N, temperature: 25 degC}
contact: {area: 500 mm2, source: ink print}
"""
PICTURES = Path(__file__).parents[3] / "docs" / "pictures.py"


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """Return a short run on the simulated rig."""
    folder = tmp_path_factory.mktemp("replay")
    (folder / "short.yaml").write_text(RECIPE, encoding="utf-8")
    invoke(["run", str(folder / "short.yaml"), "--yes", "--seed", "1", "--out", str(folder / "runs")])
    return next((folder / "runs").glob("2*"))


@pytest.fixture(scope="module")
def playback(run: Path) -> Playback:
    """Return its record."""
    return load(run)


Press = Callable[..., Awaitable[None]]


def replay(run: Path, playback: Playback, act: Callable[[ReplayApp, Press], Awaitable[None]]) -> None:
    """Open a replay and do something with it."""

    async def main() -> None:
        app = ReplayApp(playback, read(str(run), run.parent), theme="dark")
        async with app.run_test(size=(120, 40), notifications=True) as pilot:
            await act(app, pilot.press)

    asyncio.run(main())


def test_keys_move_in_time_and_not_beyond_the_run(run: Path, playback: Playback) -> None:
    async def act(app: ReplayApp, press: Press) -> None:
        await press("right", "right", "left")
        assert app.at_s == 10.0
        await press("end", "right")
        assert app.at_s == playback.length_s
        await press("home", "left")
        assert app.at_s == 0.0

    replay(run, playback, act)


def test_a_moment_shows_the_values_recorded_at_it(run: Path, playback: Playback) -> None:
    first = playback.repeats[0].result
    at_s = 0.5 * (first.started_s + first.ended_s)

    async def act(app: ReplayApp, press: Press) -> None:
        app.action_seek(at_s)
        state = app.scene.state
        assert state is not None and state.progress.over == 0 and state.progress.repeats == 3
        surface = state.value("surface")
        load, pressure = state.value("load"), state.value("pressure")
        assert load is not None and pressure is not None and pressure.setpoint == 200.0
        assert load.value is not None and pressure.value == pytest.approx(2.0 * load.value)
        assert surface is not None and surface.value is not None and abs(surface.value - 25.0) < 3.0
        assert all(event.t_s <= at_s for event in app.scene.events)
        await press("f3")
        assert "REPLAY" in screen_text(app) and "0/1 done" in screen_text(app)

    replay(run, playback, act)


def test_space_plays_and_pauses_and_nothing_is_commanded(run: Path, playback: Playback) -> None:
    async def act(app: ReplayApp, press: Press) -> None:
        await press("space")
        assert app.playing
        await press("space", "f12")
        assert not app.playing and "a replay has no rig" in screen_text(app)

    replay(run, playback, act)


def test_revolutions_and_burst_are_those_of_the_moment(run: Path, playback: Playback) -> None:
    first = playback.repeats[0]
    burst = playback.bursts[first.key][0]
    scene = ScreenScene()
    playback.show(scene, 0.5 * (burst.started_s + burst.ended_s))
    state = scene.state
    assert state is not None and (state.progress.burst, state.progress.revolutions_wanted) == (1, 5.0)
    assert state.progress.revolutions == pytest.approx(0.5 * burst.revolutions)


def test_the_runs_own_line_is_in_the_table_of_runs(run: Path, playback: Playback) -> None:
    async def act(app: ReplayApp, press: Press) -> None:
        await press("f5")
        assert "Runs: 1" in screen_text(app) and run.name in screen_text(app)

    replay(run, playback, act)


def test_results_show_the_conditions_and_their_repeats(run: Path, playback: Playback) -> None:
    stored = read(str(run), run.parent)
    assert [row.cells[:6] for row in stored.rows] == [("1#", "200", "100", "200.0", "0", "25")]
    row, found = condition(run, 1, 40)
    shown = stored.rows[0]
    assert replace(row, cells=shown.cells) == shown
    assert row.cells[-4:] == shown.cells[-4:]  # the figures: the whole run decides which axes have a column
    repeats = [one.repeat for one in found]
    assert len(found) >= 3 and repeats == list(range(1, len(found) + 1)) and all(one.trace for one in found)

    async def act(app: ReplayApp, press: Press) -> None:
        await press("f5", "tab", "enter")
        late = asyncio.get_running_loop().time() + WAIT_S
        while "repeat 3: mu" not in screen_text(app) and asyncio.get_running_loop().time() < late:
            await press("f20")
        assert "repeat 3: mu" in screen_text(app)

    replay(run, playback, act)


def test_pictures_are_svg_of_the_screens(run: Path, tmp_path: Path) -> None:
    draw = runpy.run_path(str(PICTURES))["draw"]
    written = asyncio.run(draw(run, tmp_path))
    assert [path.name for path in written] == ["run.svg", "results.svg", "repeats.svg"]
    for path in written:
        assert ElementTree.parse(path).getroot().tag.endswith("svg")
        text = path.read_text(encoding="utf-8")
        assert "F12" in text and "url(" not in text.replace("url(#", "")
