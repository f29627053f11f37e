"""The README's moving picture: `python docs/moving_picture.py [FILE [RUN]]` writes docs/pictures/quickstart.gif.

The operator's screen replays the packaged quickstart in 20 s. Without a RUN the recipe is carried out on the simulated
rig first. Chromium draws the screens (`pip install ".[browser]"`, and Debian's package chromium).
"""

from __future__ import annotations

import asyncio
import io
import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from pictures import FONTS, MOMENT, SIZE, finished_run, settle
from PIL import Image
from playwright.async_api import async_playwright

from tester.base import clock
from tester.tui.playback import load
from tester.tui.replay import ReplayApp
from tester.tui.stored import read

LENGTH_S = 20.0
FRAMES_S = 0.4
"""Time of a frame, s: a terminal changes four times a second at most."""
LAST_S = 2.0
"""Time of the last frame, s, which shows the results."""
COLOURS = 32
WIDTH = 980
"""Width of the picture, px."""


async def film(run: Path, path: Path) -> None:
    """Write the moving picture of a run."""
    playback = load(run)
    count = round((LENGTH_S - LAST_S) / FRAMES_S)
    app = ReplayApp(playback, read(str(run), run.parent), theme="dark")
    shots: list[str] = []
    async with app.run_test(size=SIZE) as pilot:
        await pilot.press("f3")
        for frame in range(count + 1):
            app.action_seek(playback.length_s * frame / count - app.at_s)
            await pilot.pause()
            shots.append(app.export_screenshot(title="tester run quickstart"))
        await pilot.press("f5", "tab")
        await settle(app, pilot, "results")
        shots.append(app.export_screenshot(title="tester run quickstart"))
    pictures = await _drawn([FONTS.sub("", shot) for shot in shots])
    shared = pictures[-2].quantize(COLOURS, dither=Image.Dither.NONE)
    frames = [picture.quantize(palette=shared, dither=Image.Dither.NONE) for picture in pictures]
    times_ms = [round(1e3 * FRAMES_S)] * (len(frames) - 1) + [round(1e3 * LAST_S)]
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=times_ms, loop=0, optimize=True)


async def _drawn(shots: list[str]) -> list[Image.Image]:
    """Return screens as pictures."""
    found: list[Image.Image] = []
    async with async_playwright() as playwright:
        browser = await playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox", "--disable-gpu"]
        )
        page = await browser.new_page(viewport={"width": WIDTH, "height": WIDTH})
        for shot in shots:
            await page.set_content(f'<body style="margin:0;background:#121212">{shot}</body>')
            box = await page.locator("svg").first.bounding_box()
            assert box is not None
            found.append(Image.open(io.BytesIO(await page.screenshot(clip=box))).convert("RGB"))
        await browser.close()
    return found


def main() -> None:
    """Film into the file named, else docs/pictures/quickstart.gif beside this file."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "pictures" / "quickstart.gif"
    clock.utc_now = lambda: MOMENT
    clock.local_stamp = lambda: MOMENT[:19].replace(":", "-")
    with TemporaryDirectory() as out:
        run = Path(sys.argv[2]) if len(sys.argv) > 2 else finished_run(Path(out), "quickstart")
        asyncio.run(film(run, path))
    print(path)


if __name__ == "__main__":
    main()
