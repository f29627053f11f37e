"""`python -m tests.campaigns.browser [--sample] [--runs FOLDER]`: speed and memory of the page in a real browser.

A stored run of 1e6 samples, before the real page process: its first picture, and zooms. A map of 165 conditions, six
runs of 165 laid over each other: with ``--runs``, from at least six such runs stored in that folder, through the page
process; otherwise the browser's part alone, from prepared answers. A page that stays open during a run. Prints a line a
figure; exit code 1 where one misses. Needs Chromium and the extra `browser`; without them it prints that, exit code 0.
"""

from __future__ import annotations

import argparse
import dataclasses
import gzip
import math
import shutil
import sqlite3
import sys
import threading
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import pytest

import tester.page
from tester.cli.main import invoke
from tester.store.run_reader import RunReader
from tester.store.sample_blocks import unpack_array
from tests.campaigns.acceptance.figure import Figure, at_most, equal
from tests.tester.page.browser import records
from tests.tester.page.browser.stage import WATCH, Front, browser, chromium, front
from tests.tester.page.browser.whole import Whole, whole
from tests.tester.service import views

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

SAMPLES = 1_000_000
FIRST_MS, ZOOM_MS, MAP_MS, OVERLAY_MS, HEAP_MB = 500.0, 150.0, 100.0, 500.0, 10.0
WHEEL_KB, LOAD_KB = 250.0, 120.0
TIMES = 5
BARE = """() => {
  const begun = performance.now();
  for (let i = 0, x = 0; i < 1e7; i += 1) x += i % 7;
  return performance.now() - begun;
}"""
"""A bare loop, which shows how much of a core the browser gets."""
SNAPSHOTS_A_RIG_HOUR = 240
"""At 60 times the speed, four a second."""
PACE_S = 0.02
"""Time between two snapshots of the open page: it draws each of them, so hours pass in minutes."""
DRAWN = """(wanted) => new Promise((done) => {
  const begun = performance.now();
  const painted = () => done(performance.now() - begun);
  const look = () => requestAnimationFrame(wanted() ? painted : look);
  look();
})"""
"""Measures the time until something is painted on the page, ms."""


def enlarged(folder: Path, samples: int) -> None:
    """Append shifted copies of a stored run's samples until it has so many."""
    with RunReader(folder) as reader:
        columns = len(reader.quantities().names)
    store = sqlite3.connect(folder / "run.db")
    with store:
        blocks = store.execute("SELECT repeat_id, rows, first_s, last_s, data FROM sample_block ORDER BY id").fetchall()
        length_s = max(block[3] for block in blocks) + 1.0
        count = sum(block[1] for block in blocks)
        copies = math.ceil(samples / count)
        for copy in range(1, copies):
            for _, rows, first_s, last_s, data in blocks:
                values = unpack_array(data, rows, columns).copy()
                values[0] += copy * length_s
                later = (0, rows, first_s + copy * length_s, last_s + copy * length_s)
                store.execute("INSERT INTO sample_block (repeat_id, rows, first_s, last_s, data) VALUES (?,?,?,?,?)",
                              (*later, zlib.compress(values.astype("<f8").tobytes(), 1)))  # fmt: skip
    store.close()


def timed(page: Page, action: str, wanted: str) -> float:
    """Run a script and return the time until something is on the page, ms."""
    return float(page.evaluate(f"() => {{ {action}; return ({DRAWN})(() => {wanted}); }}"))


def opened(page: Page, view: str) -> str:
    """Return the script that opens a view."""
    return f"document.querySelector(\"nav a[href='#{view}']\").click()"


@contextmanager
def page_of(both: Whole, launched: Browser) -> Iterator[Page]:
    """Open the page of a real page process, paired."""
    context = launched.new_context(viewport={"width": 1280, "height": 900})
    context.set_default_timeout(120_000)
    page = context.new_page()
    page.add_init_script(WATCH)
    page.goto(both.origin)
    page.get_by_label("Code, six digits").fill(both.code("control"))
    page.get_by_label("Name of this device").fill("campaign")
    page.get_by_role("button", name="Pair", exact=True).click()
    page.locator("nav").wait_for(state="visible")
    yield page
    context.close()


NOTE = "document.querySelector('.replay .run-charts p')?.textContent"
CHARTS = f"document.querySelectorAll('.replay canvas').length >= 4 && ({NOTE} ?? '').includes('of rig time')"


def first_picture(both: Whole, launched: Browser) -> list[Figure]:
    """Measure a run of 1e6 samples: the first picture by a new page, and zooms."""
    with page_of(both, launched) as page:  # the page process prepares the pyramid meanwhile
        bare = float(page.evaluate(BARE))
        made = timed(page, opened(page, "replay"), CHARTS)
        print(f"     the first picture by the first page: {made:.0f} ms (a bare loop: {bare:.0f} ms)")
    firsts: list[float] = []
    zooms: list[float] = []
    violations: list[str] = []
    for _ in range(TIMES):
        with page_of(both, launched) as page:
            bare = float(page.evaluate(BARE))
            firsts.append(timed(page, opened(page, "replay"), CHARTS))
            for button in ("Zoom in", "Zoom in", "Zoom out", "Zoom in"):
                found = f"[...document.querySelectorAll('.replay button')].find((b) => b.textContent === '{button}')"
                zooms.append(timed(page, f"window.before = {NOTE}; {found}.click()", f"{NOTE} !== window.before"))
            violations += page.evaluate("window.__violations")
    print(f"     a bare loop in the browser: {bare:.0f} ms")
    firsts.sort()
    zooms.sort()
    return [
        at_most(
            f"1e6 samples, first picture, median of {TIMES}", firsts[TIMES // 2], FIRST_MS, "ms", 0,
            note=f" (greatest {firsts[-1]:.0f} ms)",
        ),
        at_most(
            f"zoom, median of {len(zooms)}", zooms[len(zooms) // 2], ZOOM_MS, "ms", 0,
            note=f" (greatest {zooms[-1]:.0f} ms)",
        ),
        equal("violations of the policy", violations, []),
    ]


def big_run(launched: Browser) -> list[Figure]:
    """Make the run and measure it through the real page process."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        invoke(["run", "quickstart", "--yes", "--seed", "1", "--out", str(folder / "runs")])
        enlarged(next((folder / "runs").glob("2*")), SAMPLES)
        with whole(folder) as both:
            return first_picture(both, launched)


CELLS = "document.querySelectorAll('[role=gridcell][data-n]').length >= 165"
CHECKED = "[...document.querySelectorAll('table.runs input[type=checkbox]')].slice(0, 6).forEach((box) => box.click())"
LAID = "document.querySelectorAll('.overlay canvas').length === 3"


def map_and_overlay(page: Page, source: str) -> list[Figure]:
    """Measure a map of 165 cells and six runs laid over each other."""
    timed(page, opened(page, "map"), CELLS)
    drawn = """() => { const m = document.querySelectorAll('.field select')[1]; const begun = performance.now();
      m.dispatchEvent(new Event('change')); m.offsetHeight; return performance.now() - begun; }"""
    maps = sorted(float(page.evaluate(drawn)) for _ in range(9))
    timed(page, opened(page, "results"), "document.querySelectorAll('table.runs input[type=checkbox]').length >= 6")
    page.evaluate(f"() => {{ {CHECKED} }}")
    lay = "document.querySelectorAll('.overlay canvas').forEach((one) => one.remove()); "
    lay += "document.querySelector('.found p.buttons button').click()"
    laid = sorted(timed(page, lay, LAID) for _ in range(TIMES))
    return [
        at_most(
            f"165 cells, {source}", maps[len(maps) // 2], MAP_MS, "ms", 0, note=f" (greatest of 9: {maps[-1]:.0f} ms)"
        ),
        at_most(
            f"six runs of 165 laid over each other, {source}", laid[TIMES // 2], OVERLAY_MS, "ms", 0,
            note=f" (greatest of {TIMES}: {laid[-1]:.0f} ms)",
        ),
    ]


def heap(served: Front, launched: Browser, hours: int) -> list[Figure]:
    """Measure the growth of a page beside a run."""
    context = launched.new_context(viewport={"width": 1280, "height": 900})
    page = served.paired(context, "control")
    tools = context.new_cdp_session(page)
    state = views.state()
    assert state.run is not None
    state = dataclasses.replace(state, run=dataclasses.replace(state.run, name=records.RUN))

    def pass_time(first: int, count: int) -> None:
        for at in range(first, first + count):
            t_s = 15.0 * at
            row = (t_s, t_s, 0.7 + 0.02 * math.sin(at / 9), 199.0, 200.0, 299.0, 300.0, 40.0, 40.0)
            served.call(
                lambda t_s=t_s, row=row: served.stage.fake.show(dataclasses.replace(state, t_s=t_s, wall_s=t_s), row)
            )
            if at % 40 == 0:
                served.call(lambda at=at: served.stage.fake.event("repeat", f"repeat {at}: mu as measured 0.7"))
            threading.Event().wait(PACE_S)

    def used_mb() -> float:
        tools.send("HeapProfiler.collectGarbage")
        return float(tools.send("Runtime.getHeapUsage")["usedSize"]) / 1e6

    pass_time(0, SNAPSHOTS_A_RIG_HOUR)
    before = used_mb()
    pass_time(SNAPSHOTS_A_RIG_HOUR, hours * SNAPSHOTS_A_RIG_HOUR)
    drawn = page.locator(".about-run").inner_text()  # before garbage collection: data go stale in 2 s
    after = used_mb()
    context.close()
    return [
        at_most(
            f"heap grows in {hours} rig hours at 60 times",
            after - before,
            HEAP_MB,
            "MB",
            1,
            note=f" (from {before:.1f} MB)",
        ),
        equal("it draws to the end", "running" in drawn, True),
    ]


def sizes() -> list[Figure]:
    """Measure the page's files."""
    static = Path(tester.page.__file__).parent / "static"
    files = [path for path in static.rglob("*") if path.is_file()]
    loaded = [path for path in files if path.suffix in (".html", ".js", ".css", ".svg")]
    return [
        at_most("page in the wheel", sum(path.stat().st_size for path in files) / 1e3, WHEEL_KB, "kB", 0),
        at_most(
            "first load, compressed",
            sum(len(gzip.compress(path.read_bytes())) for path in loaded) / 1e3,
            LOAD_KB,
            "kB",
            0,
        ),
    ]


def main(arguments: list[str] | None = None) -> int:
    """Measure everything; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.browser", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="2 rig hours of an open page instead of 24")
    parser.add_argument("--runs", type=Path, help="folder with at least six stored runs of 165 conditions")
    given = parser.parse_args(arguments)
    try:
        chromium()
    except pytest.skip.Exception as reason:
        print(f"not run: {reason}")
        return 0
    figures: list[Figure] = []

    def add(more: list[Figure]) -> None:
        for figure in more:
            print(figure, flush=True)
        figures.extend(more)

    add(sizes())
    with browser() as launched:
        add(big_run(launched))
        with TemporaryDirectory() as place:
            if given.runs is not None:
                shutil.copytree(given.runs, Path(place) / "runs")
                with whole(Path(place)) as both, page_of(both, launched) as page:
                    add(map_and_overlay(page, "with the page process"))
            with front(Path(place)) as served:
                context: Any = launched.new_context(viewport={"width": 1280, "height": 900})
                add(map_and_overlay(served.paired(context, "control"), "the browser's part"))
                context.close()
                add(heap(served, launched, 2 if given.sample else 24))
                add(
                    [
                        equal("requests elsewhere", served.elsewhere, []),
                        equal("violations, errors", served.violations(), []),
                    ]
                )
    return 0 if all(figure.ok for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
