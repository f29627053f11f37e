"""The README's picture of the page: `python -m docs.page_picture [FOLDER]`, from a checkout's first folder.

A service on the simulated rig carries out the quickstart at 60 times; the page of `tester page` is drawn by Chromium
(`pip install ".[browser]"`, and Debian's package chromium) while the wheel slides for the last time.
"""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from playwright.sync_api import sync_playwright

from tests.tester.page.browser.whole import whole

SPEED = 60.0
LAST = re.compile(r"\d +200 N")
"""Title of the step that is under way in the picture."""
WIDTH, HEIGHT = 1280, 900
WITHIN_MS = 300_000


def main() -> None:
    """Draw page.png into the folder named, else into docs/pictures."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent / "pictures"
    flags = ["--no-sandbox", "--disable-gpu"]
    with TemporaryDirectory() as made, whole(Path(made)) as both, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=flags)
        page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, color_scheme="light")
        page.goto(both.origin)
        page.get_by_label("Code, six digits").fill(both.code("control"))
        page.get_by_label("Name of this device").fill("the lab's tablet")
        page.get_by_role("button", name="Pair", exact=True).click()
        both.run(speed=SPEED)
        page.locator(".step.now", has_text=LAST).wait_for(timeout=WITHIN_MS)
        page.wait_for_timeout(3_000)  # two repeats or so
        page.screenshot(path=folder / "page.png")
        browser.close()


if __name__ == "__main__":
    main()
