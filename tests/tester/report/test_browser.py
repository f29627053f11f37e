"""A report in a browser, where a Chromium is found: on a screen, a phone and paper. Look at its pictures.

``python -m pytest -n 0 -m campaign tests/tester/report/test_browser.py``. TESTER_CHROMIUM names a browser,
TESTER_ARTEFACTS the folder that keeps the pictures, TESTER_REPORT a report to look at in place of a made-up one.
"""

from __future__ import annotations

import html
import os
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.tester.kinds.wheel_on_belt.fit.made import made_run

pytestmark = pytest.mark.campaign
image = pytest.importorskip("matplotlib.image", reason="needs the extra `report`")
NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome")
SCREEN, SMALL, PHONE = 1280, 400, 360
"""Widths, px."""
SCRIPT = "<script>document.title = 'run'</script>"
FRAME = """<!DOCTYPE html><title>not measured</title><iframe id="f" style="width: {width}px; height: 900px; border: 0"
srcdoc="{page}"></iframe><script>onload = () => {{
const page = document.getElementById("f").contentDocument;
const cells = [...page.querySelectorAll("header td[data-head^='U '], #r1-conditions td[data-head^='U ']")];
const out = cells.filter(one => one.getBoundingClientRect().right > {width} || one.getBoundingClientRect().width < 9);
const drawn = [...page.querySelectorAll(".drawn")].map(one => one.getBoundingClientRect().width);
const svgs = [...page.querySelectorAll(".drawn > .wide svg")].map(one => one.getBoundingClientRect().width);
const narrow = svgs.filter(one => one < drawn[0] - 1);
document.title = [page.documentElement.scrollWidth, cells.length, out.length, svgs.length, narrow.length].join(" ")
}}</script>"""
"""Measures a page that is ``width`` px wide, which no window of a browser is where that is a phone's: how far it
reaches; cells of U, and those of them out of sight; wide figures, and those of them narrower than their column."""
POLICY = re.compile(r'<meta http-equiv="Content-Security-Policy"[^>]*>')


@pytest.fixture(scope="module")
def chromium() -> str:
    found = os.environ.get("TESTER_CHROMIUM") or next((path for name in NAMES if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("no Chromium is found (TESTER_CHROMIUM)")
    return found


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    kept = os.environ.get("TESTER_ARTEFACTS")
    place = Path(kept) if kept else tmp_path_factory.mktemp("pictures")
    place.mkdir(parents=True, exist_ok=True)
    return place


@pytest.fixture(scope="module")
def report(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = folder / "report.html"
    given = os.environ.get("TESTER_REPORT")
    if given:
        path.write_bytes(Path(given).read_bytes())
        return path
    from tester.report.charts import Material, values_of
    from tester.report.page import page_of
    from tester.report.record_section import MachineWords, read_record
    from tester.report.report_build import report_of

    design = [(t, load, slip) for t in (25.0, 55.0) for load in (100.0, 200.0, 400.0) for slip in (0.1, 0.3)]
    run = made_run(tmp_path_factory.mktemp("runs") / "one", design, carried=[2], failed=[4])
    found = read_record(run, MachineWords("rubber wheel on a belt", "the friction coefficient of a wheel"))
    page = page_of(report_of([found], lambda one: Material(values_of(one.results))))
    path.write_text(page, encoding="utf-8")
    return path


def browse(chromium: str, page: Path, profile: Path, *arguments: str) -> str:
    """Open a page without a window; return what the browser writes."""
    command = [chromium, "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}", *arguments]
    done = subprocess.run([*command, page.as_uri()], capture_output=True, text=True, timeout=120, check=True)
    return done.stdout


def title(chromium: str, page: Path, profile: Path) -> str:
    found = re.search("<title>(.*?)</title>", browse(chromium, page, profile, "--window-size=1400,900", "--dump-dom"))
    assert found
    return found[1]


@pytest.mark.parametrize("width", [SCREEN, SMALL, PHONE])
def test_a_page_fits_its_screen_and_is_not_empty(
    chromium: str, report: Path, folder: Path, tmp_path: Path, width: int
) -> None:
    picture = folder / f"report-{width}.png"
    browse(chromium, report, tmp_path, f"--window-size={width},3000", f"--screenshot={picture}", "--hide-scrollbars")
    pixels = image.imread(picture)
    assert pixels.shape[:2] == (3000, width)
    assert pixels[:600, :, :3].std() > 0.1 and pixels[2400:, :, :3].std() > 0.02
    measured = tmp_path / "measured.html"
    text = html.escape(POLICY.sub("", report.read_text(encoding="utf-8")))
    measured.write_text(FRAME.format(width=width, page=text), encoding="utf-8")
    reaches, cells, out, figures, narrow = (int(each) for each in title(chromium, measured, tmp_path).split())
    assert reaches <= width
    assert cells > 10 and not out
    assert figures and not narrow


def test_a_script_that_got_in_would_not_run(chromium: str, report: Path, tmp_path: Path) -> None:
    changed = tmp_path / "changed.html"
    text = report.read_text(encoding="utf-8").replace("</body>", f"{SCRIPT}</body>")
    changed.write_text(text, encoding="utf-8")
    assert title(chromium, changed, tmp_path) != "run"
    changed.write_text(POLICY.sub("", text), encoding="utf-8")
    assert title(chromium, changed, tmp_path) == "run"


def test_a_page_prints_on_a4_with_all_its_sections(chromium: str, report: Path, folder: Path, tmp_path: Path) -> None:
    printed = folder / "report.pdf"
    browse(chromium, report, tmp_path, "--no-pdf-header-footer", f"--print-to-pdf={printed}")
    sizes = re.findall(rb"/MediaBox *\[0 0 ([\d.]+) ([\d.]+)\]", printed.read_bytes())
    assert sizes and {(round(float(wide)), round(float(high))) for wide, high in sizes} == {(595, 842)}
    reads = shutil.which("pdftotext")
    if reads is None:
        pytest.skip("the words of the PDF need pdftotext")
    words = subprocess.run([reads, printed, "-"], capture_output=True, text=True, check=True).stdout
    for heading in ("Conditions", "Uncertainty budgets", "Where it is from"):
        assert heading in words
    assert "\f" in words.strip("\f")
