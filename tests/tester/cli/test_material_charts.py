"""Charts of materials: every point of the file is in them, and a wrong import is seen beside the curve."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import recipes
from tester.cli.material_charts import compound_chart, surface_chart, unshifted_chart
from tester.inputs.materials.compound import load_compound
from tester.inputs.materials.library import Library, rubber_of, surface_of
from tester.report.chart import Chart, Series

LIBRARY = Library([recipes.FOLDER])


def compound(folder: Path, hertz: tuple[float, ...] = (1.0, 10.0, 100.0), glass: str = "Tg: -50 degC\n") -> Path:
    """Write a rubber of Ts = 0 degC whose points fall on one curve, and return its file."""
    from sim.physics.moduli import FractionalZener

    made = FractionalZener(2e6, 7e8, 1e-5, 0.6, 0.0, 20.0)
    rows: list[str] = []
    for celsius in np.arange(-30.0, 50.0, 4.0):
        for f, e in zip(hertz, 3.0 * made.complex_pa(2.0 * np.pi * np.array(hertz), float(celsius)), strict=True):
            rows.append(f"      - [{celsius}, {f}, {e.real / 1e6}, {e.imag / 1e6}]\n")
    path = folder / "c.yaml"
    columns = "columns: [temperature degC, frequency Hz, E' MPa, E'' MPa]"
    path.write_text(f"name: x\n{glass}moduli:\n  table:\n    {columns}\n    rows:\n{''.join(rows)}", encoding="utf-8")
    return path


def of_look(chart: Chart, panel: int, look: str) -> list[Series]:
    return [series for series in chart.panels[panel].series if series.look == look]


def off_decades(chart: Chart, panel: int = 0) -> float:
    """Return the greatest distance of a point from its curve, decades of the modulus."""
    far = 0.0
    for points in of_look(chart, panel, "published"):
        (line,) = [series for series in of_look(chart, panel, "law") if series.style == points.style]
        curve = np.interp(np.log10(points.x), np.log10(line.x), np.log10(line.y))
        far = max(far, float(np.max(np.abs(np.log10(points.y) - curve))))
    return far


def test_every_point_of_a_compound_is_drawn_and_lies_on_the_curve(tmp_path: Path) -> None:
    loaded = load_compound(compound(tmp_path))
    assert loaded.table is not None
    chart = compound_chart(rubber_of(loaded), loaded.table.rows, 20.0)
    moduli, tan = chart.panels
    storage, loss = of_look(chart, 0, "published")
    assert [round(1e6 * y) for y in storage.y] == [round(row.storage_pa) for row in loaded.table.rows]
    assert [round(1e6 * y) for y in loss.y] == [round(row.loss_pa) for row in loaded.table.rows]
    assert tan.series[0].y == pytest.approx([row.loss_pa / row.storage_pa for row in loaded.table.rows])
    assert moduli.log_y and chart.log_x and off_decades(chart) < 0.03
    # A point of 20 degC stays at its own frequency.
    assert next(x for x, row in zip(storage.x, loaded.table.rows, strict=True) if row.temperature_c == 22.0) < 1.0


def test_one_frequency_in_another_unit_is_seen_off_the_curve(tmp_path: Path) -> None:
    loaded = load_compound(compound(tmp_path))
    assert loaded.table is not None
    wrong = tuple(
        replace(row, storage_pa=1e-3 * row.storage_pa, loss_pa=1e-3 * row.loss_pa) if row.frequency_hz == 10.0 else row
        for row in loaded.table.rows
    )
    broken = replace(loaded, table=replace(loaded.table, rows=wrong))
    assert off_decades(compound_chart(rubber_of(broken), wrong, 20.0)) > 1.0


def test_a_wrong_glass_transition_is_seen_as_scatter(tmp_path: Path) -> None:
    right = load_compound(compound(tmp_path))
    wrong = load_compound(compound(tmp_path, glass="Tg: -75 degC\n"))
    assert right.table is not None and wrong.table is not None
    off = [off_decades(compound_chart(rubber_of(one), one.table.rows, 20.0)) for one in (right, wrong) if one.table]
    assert off[1] > 4.0 * off[0]


def test_a_formula_is_drawn_without_points() -> None:
    chart = compound_chart(LIBRARY.rubber("SBR"), (), 20.0)
    assert of_look(chart, 0, "published") == [] and "a formula" in chart.note
    tan = of_look(chart, 1, "law")[0]
    assert max(tan.y) == pytest.approx(1.240, abs=2e-3)
    assert tan.x[int(np.argmax(tan.y))] == pytest.approx(503.0, rel=0.2)


def test_points_without_a_shift_are_drawn_over_their_temperature(tmp_path: Path) -> None:
    loaded = load_compound(compound(tmp_path, glass=""))
    assert loaded.table is not None
    chart = unshifted_chart("x", loaded.table.rows, "Tg is missing")
    (storage, _) = of_look(chart, 0, "published")
    assert storage.x == tuple(row.temperature_c for row in loaded.table.rows) and not chart.log_x
    assert chart.note == "not shifted: Tg is missing" and of_look(chart, 0, "law") == []


def test_a_surface_has_its_spectrum_its_points_and_its_two_waves() -> None:
    loaded = LIBRARY.surface_file("wavy glass")
    surface = surface_of(loaded)
    chart = surface_chart(surface, loaded.radial)
    assert loaded.radial is not None and surface.coarse is not None
    (points,) = of_look(chart, 0, "published")
    assert points.x == tuple(loaded.radial.q_1_m) and points.y == tuple(loaded.radial.power_m4)
    coarse, fine = of_look(chart, 0, "limit")
    assert coarse.label == "coarse, found: 7.98 mm" and fine.label.startswith("fine, found: ")
    assert coarse.x == pytest.approx([2.0 * np.pi / surface.coarse.wavelength_m] * 2)
    assert chart.note == "rms height 1 um, rms slope 0.0015"


def test_a_surface_of_waves_alone_has_nothing_to_draw() -> None:
    with pytest.raises(ValueError, match="road has two waves and no spectrum"):
        surface_chart(LIBRARY.surface("road"), None)


def test_the_four_rubbers_of_grosch_are_drawn_with_curves_of_their_own() -> None:
    tan = [np.array(compound_chart(LIBRARY.rubber(name), (), 20.0).panels[1].series[0].y)
           for name in ("SBR", "ABR", "INR", "butyl")]  # fmt: skip
    heights = sorted(float(np.max(one)) for one in tan)
    assert heights == pytest.approx([1.14, 1.24, 1.47, 1.77], abs=0.01)
