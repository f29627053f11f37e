"""The README's pictures, drawn by the screens themselves: `python docs/pictures.py [FOLDER]`.

A short run on the simulated rig is carried out, and screens of its replay are written as SVG.
"""

from __future__ import annotations

import asyncio
import contextlib
import io
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.cli.main import invoke
from tester.tui.playback import load
from tester.tui.replay import ReplayApp
from tester.tui.stored import read

SIZE = (120, 40)
"""Columns and rows."""
MOMENTS = {"run": ("f3", 0.93), "results": ("f5", 1.0)}
"""Name of a picture, key of its screen, share of the run's rig time."""


async def draw(run: Path, folder: Path) -> list[Path]:
    """Write the pictures of a run and return their files."""
    written: list[Path] = []
    app = ReplayApp(load(run), read(str(run), run.parent), theme="dark")
    async with app.run_test(size=SIZE) as pilot:
        for name, (key, share) in MOMENTS.items():
            await pilot.press(key)
            app.action_seek(share * app.playback.length_s - app.at_s)
            await pilot.pause()
            path = folder / f"{name}.svg"
            path.write_text(app.export_screenshot(title="friction-tester"), encoding="utf-8")
            written.append(path)
    return written


def short_run(out: Path) -> Path:
    """Carry out the quickstart and return the run's folder."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        code = invoke(["run", "quickstart", "--yes", "--seed", "1", "--out", str(out)])
    if code not in (0, 6):
        raise SystemExit(code)
    return Path(printed.getvalue().splitlines()[-1])


def main() -> None:
    """Draw into the folder named, else docs/pictures beside this file."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory() as out:
        for path in asyncio.run(draw(short_run(Path(out)), folder)):
            print(path)


if __name__ == "__main__":
    main()
