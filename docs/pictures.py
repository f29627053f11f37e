"""The README's pictures, drawn by the screens themselves: `python docs/pictures.py [FOLDER [RUN]]`.

Without a RUN, a short run on the simulated rig is carried out. Screens of the run's replay are written as SVG. The wall
clock stands still meanwhile, so that the same program draws the same pictures.
"""

from __future__ import annotations

import asyncio
import contextlib
import io
import re
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from textual.pilot import Pilot

from tester.base import clock
from tester.cli.main import invoke
from tester.results.exclude import Word, record_word
from tester.tui.playback import Playback, load
from tester.tui.replay import ReplayApp
from tester.tui.stored import read

SIZE = (120, 40)
"""Columns and rows."""
MOMENT = "2026-01-15T10:00:00.000Z"
RECIPE = """\
recipe: load and temperature
specimens: [{compound: "1#", note: "NR, N234"}]
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 200 N, duration: 4 min}
rest: {at_least: 20 min, until: 25 degC, within: 2 degC}
measure: {wheel_speed: 0.8 m/s, repeats: 3, min_valid: 2, window: 20 rev, temperature_band: 2 degC}
grids:
  - {name: load, slip_velocity: 300 mm/s, load: [100 N, 200 N, 300 N], temperature: [25 degC, 40 degC]}
"""
EXCLUDED = Word(2, 3, True, "debris on the belt", "A. Person")
KEYS: dict[str, Sequence[str]] = {
    "run": ("f3",),
    "results": ("f5", "tab"),
    "repeats": ("down", "down", "enter"),
}
"""Name of a picture, and the keys that lead from the one before to its screen."""
FONTS = re.compile(r"\s*@font-face \{.*?\}", re.DOTALL)
SLIDING_M_S = 0.05
TRIES = 400


async def draw(run: Path, folder: Path) -> list[Path]:
    """Write the pictures of a run and return their files."""
    written: list[Path] = []
    app = ReplayApp(_with_rig_time(load(run)), read(str(run), run.parent), theme="dark")
    async with app.run_test(size=SIZE) as pilot:
        app.action_seek(_moment(app.playback))
        for name, keys in KEYS.items():
            await pilot.press(*keys)
            await settle(app, pilot, name)
            picture = FONTS.sub("", app.export_screenshot(title="friction-tester"))
            path = folder / f"{name}.svg"
            path.write_text(picture.replace("Fira Code, monospace", "Fira Code, DejaVu Sans Mono, monospace"), "utf-8")
            written.append(path)
    return written


def _with_rig_time(playback: Playback) -> Playback:
    """Return a run whose journal shows the rig's time, which is the same each time it is carried out."""
    return replace(playback, events=tuple(replace(event, utc=_hours(event.t_s)) for event in playback.events))


def _hours(t_s: float) -> str:
    return f"{int(t_s) // 3600}:{int(t_s) // 60 % 60:02d}:{int(t_s) % 60:02d}"


def _moment(playback: Playback) -> float:
    """Return a rig time in which the wheel slides, well into the run."""
    times, slip = playback.samples["time_s"], playback.samples["slip_m_s"]
    sliding = [t_s for t_s, slip_m_s in zip(times, slip, strict=True) if slip_m_s > SLIDING_M_S]
    return sliding[4 * len(sliding) // 5] if sliding else playback.length_s


async def settle(app: ReplayApp, pilot: Pilot[str], name: str) -> None:
    """Let what is read in a thread arrive."""
    for _ in range(TRIES):
        await app.workers.wait_for_complete()
        await pilot.pause()
        if name != "repeats" or len(app.screen.query("#repeat-list")):
            break
    await pilot.pause()


def short_run(out: Path) -> Path:
    """Carry out a run, leave a repeat out by hand, and return the run's folder."""
    recipe = out / "recipe.yaml"
    recipe.write_text(RECIPE, encoding="utf-8")
    run = finished_run(out, str(recipe), "--set", "sim.scatter=0.3")
    record_word(run, EXCLUDED)
    return run


def finished_run(out: Path, recipe: str, *options: str) -> Path:
    """Carry out a recipe on the simulated rig and return the run's folder."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = invoke(["run", recipe, "--yes", "--seed", "1", *options, "--out", str(out / "runs")])
    if code not in (0, 6):
        raise SystemExit(code)
    return Path(printed.getvalue().splitlines()[-1])


def main() -> None:
    """Draw into the folder named, else docs/pictures beside this file."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    clock.utc_now = lambda: MOMENT
    clock.local_stamp = lambda: MOMENT[:19].replace(":", "-")
    with TemporaryDirectory() as out:
        run = Path(sys.argv[2]) if len(sys.argv) > 2 else short_run(Path(out))
        for path in asyncio.run(draw(run, folder)):
            print(path)


if __name__ == "__main__":
    main()
