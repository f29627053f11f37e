"""Files of surfaces: every problem at its line and column."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tester.base.source import InvalidSource
from tester.inputs.materials.surface_file import LoadedSurface, load_surface


def loaded(folder: Path, text: str) -> LoadedSurface:
    (folder / "s.yaml").write_text(text, encoding="utf-8")
    return load_surface(folder / "s.yaml", "s.yaml")


def refused(folder: Path, text: str) -> list[str]:
    with pytest.raises(InvalidSource) as raised:
        loaded(folder, text)
    return [str(problem) for problem in raised.value.problems]


def test_a_spectrum_arrives_in_si(tmp_path: Path) -> None:
    one = loaded(tmp_path, "name: x\nspectrum: {C0: 2.6e-19 m4, q0: 20 1/mm, q1: 0.2 1/um, H: 0.8}\n")
    assert one.model.spectrum is not None
    assert (one.model.spectrum.q0, one.model.spectrum.q1) == (2e4, 2e5)
    assert one.holds() == "self-affine, H 0.8, waves of 31.4 um to 314 um"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("spectrum: {C0: 1e-19 m4, q0: 2e5 1/m, q1: 2e4 1/m, H: 0.8}", "q1, 20000 1/m, is not above q0, 200000 1/m"),
        ("spectrum: {C0: 1e-19 m4, q0: 2e4 1/m, q1: 2e4 1/m, H: 0.8}", "is not above q0"),
        ("spectrum: {C0: 1e-19, q0: 2e4 1/m, q1: 2e5 1/m, H: 0.8}", "has no unit"),
        ("spectrum: {C0: -1e-19 m4, q0: 2e4 1/m, q1: 2e5 1/m, H: 0.8}", "too small (expected more than 0 m4)"),
        ("spectrum: {C0: 1e-19 m4, q0: 2e4 1/m, q1: 2e5 1/m, H: 1.8}", "too large (expected at most 1)"),
        ("spectrum: {C0: 1e-19 m4, q0: 2e4 1/m, q1: 2e5 1/m}", "H is missing"),
        ("spectum: {}", 'unknown key "spectum", did you mean spectrum?'),
        ("waves: {coarse: {wavelength: 1 mm, Ra: 10 mm}, fine: {wavelength: 0.1 mm, Ra: 1 um}}", "are they swapped?"),
        ("waves: {coarse: {wavelength: 1 mm, Ra: 1 um}, fine: {wavelength: 2 mm, Ra: 1 um}}", "fine is not finer"),
        ("note: nothing", "nothing is given of its heights"),
        ("scan: {file: x.csv}\nradial: {rows: []}", "radial and scan are given"),
        ("scan: {file: x.csv}", 'there is no file "x.csv" beside this one'),
    ],
)
def test_impossible_values_are_refused_at_their_line(tmp_path: Path, text: str, message: str) -> None:
    problems = refused(tmp_path, f"name: x\n{text}\n")
    assert any(message in one and one.startswith("s.yaml:") for one in problems), problems


def test_a_table_of_a_spectrum_has_to_rise(tmp_path: Path) -> None:
    text = "name: x\nradial:\n  rows:\n    - [1e4, 1e-18]\n    - [1e4, 1e-19]\n    - [5e3, -1]\n"
    assert refused(tmp_path, text) == [
        "s.yaml:5:7: q 10000 1/m does not rise above 10000 1/m: a point twice, or out of order",
        "s.yaml:6:7: q 5000 1/m does not rise above 10000 1/m: a point twice, or out of order",
        "s.yaml:6:7: q 5000 1/m, C -1 m4: both are to be above 0",
    ]
    assert "too few (expected 2 or more)" in refused(tmp_path, "name: x\nradial: {rows: [[1, 1]]}\n")[0]


def test_a_scan_beside_becomes_a_spectrum_with_its_method(tmp_path: Path) -> None:
    heights = np.random.default_rng(1).normal(size=(32, 40))
    np.savetxt(tmp_path / "map.csv", heights, delimiter=";")
    one = loaded(tmp_path, "name: x\nscan: {file: map.csv, pixel: 2 um, unit: um, detrend: mean}\n")
    assert one.radial is not None
    assert one.radial.q_1_m[-1] <= np.pi / 2e-6
    assert one.file.data[0].name == "map.csv"
    assert one.notes[0].startswith("32 x 40 heights, 2 x 2 um apart, without their mean; rms ")


def test_a_scan_without_unit_or_pixel_is_asked(tmp_path: Path) -> None:
    np.savetxt(tmp_path / "map.csv", np.ones((20, 20)))
    problems = refused(tmp_path, "name: x\nscan: {file: map.csv}\n")
    assert any("the heights have no unit (expected nm, um, mm or m; unit: um)" in one for one in problems)
    assert any("the distance from point to point is missing (expected such as pixel: 1 um)" in one for one in problems)
