"""Maps of heights as text and as instruments write them; holes are refused."""

from __future__ import annotations

import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from tester.base.plugins import MissingExtraError
from tester.base.source import InvalidSource
from tester.inputs.materials.files import Findings
from tester.inputs.materials.surface_scan import HeightMap, ScanOptions, read_scan, spectrum_of

GRID = np.arange(400.0).reshape(20, 20)
SAID = ScanOptions(pixel_m=1e-6, unit="um")


def read(text: str, options: ScanOptions = SAID, name: str = "m.csv") -> tuple[HeightMap, Findings]:
    found = Findings(name)
    return read_scan(Path(name), text.encode(), options, found), found


def refused(text: str, options: ScanOptions = SAID) -> list[str]:
    with pytest.raises(InvalidSource) as raised:
        read(text, options)
    return [str(problem) for problem in raised.value.problems]


def written(delimiter: str, comma: bool = False, end: str = "") -> str:
    rows = (delimiter.join(f"{cell:.2f}" for cell in row) + end for row in GRID)
    text = "# a scan\n" + "\n".join(rows) + "\n"
    return text.replace(".", ",") if comma else text


@pytest.mark.parametrize(
    "text",
    [written(","), written(";"), written("\t"), written("  "), written(";", comma=True), written("\t", end="\t")],
    ids=["comma", "semicolon", "tab", "spaces", "decimal comma", "tab at the end"],
)
def test_a_matrix_of_text_is_read_in_metres(text: str) -> None:
    scan, _ = read(text)
    assert scan.heights_m == pytest.approx(GRID * 1e-6, rel=1e-12)
    assert scan.pixel_m == (1e-6, 1e-6)


def test_holes_are_refused_with_how_many_and_where() -> None:
    lines = written(";").splitlines()
    lines[1] = lines[1].replace("7.00", "", 1)
    lines[5] = lines[5].replace("99.00", "NaN", 1)
    (problem,) = refused("\n".join(lines))
    assert "2 of 400 heights are holes, the first in row 1, column 8" in problem


def test_rows_of_another_length_and_words_are_refused_with_their_lines() -> None:
    lines = written(";").splitlines()
    lines[3], lines[5] = lines[3] + ";1", lines[5].replace("99.00", "9_9")
    problems = refused("\n".join(lines))
    assert problems == [
        "m.csv:4:1: 21 heights (expected 20, as in the first row)",
        'm.csv:6:1: "9_9" is not a height (expected a number)',
    ]


def test_nothing_is_no_map() -> None:
    assert "no heights" in refused("# only a remark\n")[0]


def test_unit_and_pixel_are_asked_for() -> None:
    problems = refused(written(";"), ScanOptions())
    assert [one.split(": ", 1)[1] for one in problems] == [
        "the distance from point to point is missing (expected such as --pixel 1um)",
        "the heights have no unit (expected nm, um, mm or m; --unit um)",
    ]


def test_removed_shapes_are_noted_and_a_map_without_its_long_waves_is_doubted() -> None:
    y, x = np.meshgrid(np.arange(64.0), np.arange(64.0), indexing="ij")
    found = Findings("m.csv")
    spectrum_of(HeightMap(np.sin(2 * np.pi * (x + y) / 8.0) * 1e-6, (1e-6, 1e-6)), "plane", found)
    assert found.doubts == []
    assert "64 x 64 heights, 1 x 1 um apart, without the plane of least squares; rms 0.7071 um" in found.notes
    spectrum_of(HeightMap(np.exp(-((x - 32) ** 2)) * 1e-6, (1e-6, 1e-6)), "mean", found)
    (doubt,) = found.doubts
    assert "off that of the heights" in doubt.message


def test_a_format_of_instruments_needs_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(MissingExtraError, match=r"friction-tester\[topography\]"):
        read("", name="m.al3d")


def reader(monkeypatch: pytest.MonkeyPatch, **given: object) -> None:
    """Replace the library's topography by one with these attributes."""
    one = SimpleNamespace(**given)
    monkeypatch.setitem(sys.modules, "SurfaceTopography", SimpleNamespace(read_topography=lambda path: one))


def test_sizes_and_unit_of_a_format_count(monkeypatch: pytest.MonkeyPatch) -> None:
    reader(monkeypatch, heights=lambda: GRID, physical_sizes=(40.0, 20.0), unit="µm")
    scan, found = read("", ScanOptions(), "m.al3d")
    assert scan.pixel_m == pytest.approx((2e-6, 1e-6)) and scan.heights_m[0, 1] == pytest.approx(1e-6)
    assert found.doubts == []


def test_a_statement_against_the_file_is_doubted(monkeypatch: pytest.MonkeyPatch) -> None:
    reader(monkeypatch, heights=lambda: GRID, physical_sizes=(20.0, 20.0), unit="mm")
    scan, found = read("", SAID, "m.al3d")
    assert scan.pixel_m == (1e-6, 1e-6)
    assert len(found.doubts) == len(found.lasting) == 2


def test_holes_of_a_format_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    masked = np.ma.masked_equal(GRID, 25.0)
    reader(monkeypatch, heights=lambda: masked, physical_sizes=(20.0, 20.0), unit="um")
    with pytest.raises(InvalidSource, match="1 of 400 heights are holes, the first in row 2, column 6"):
        read("", ScanOptions(), "m.al3d")


def test_a_real_file_is_read_by_the_library(tmp_path: Path) -> None:
    library = pytest.importorskip("SurfaceTopography")
    path = tmp_path / "m.nc"
    library.Topography(GRID, (20.0, 20.0), unit="um", periodic=False).to_netcdf(str(path))
    found = Findings("m.nc")
    scan = read_scan(path, path.read_bytes(), ScanOptions(), found)
    assert scan.heights_m == pytest.approx(GRID * 1e-6) and scan.pixel_m == pytest.approx((1e-6, 1e-6))
