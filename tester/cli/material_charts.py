"""Charts of materials, as data: the moduli of a compound over the frequency, the spectrum of a surface.

Points are those of the file, beside the curve that a law takes of them: a wrong import is seen.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import log10
from typing import Final

import numpy as np

from sim.physics.materials import Rubber, Surface, length_text
from sim.physics.moduli import TabulatedModulus
from tester.base.arrays import Array
from tester.inputs.materials.measured_moduli import ModuliRow
from tester.inputs.materials.radial import RadialSpectrum
from tester.report.chart import Chart, ChartPanel, Look, Series

PLACES: Final = 300
"""Points of a drawn curve."""
FORMULA_HZ: Final = (1e-4, 1e14)
"""Frequencies over which a formula is drawn."""
POINTS: Final[Look] = "published"
"""Look of the file's points: hollow, for the curve to be seen through them."""
STORAGE, LOSS = 0, 1
"""Styles of E' and E''."""


def compound_chart(rubber: Rubber, rows: Sequence[ModuliRow], reference_c: float) -> Chart:
    """Return E', E'' and tan delta of a compound over the frequency at a temperature, degC.

    ``rows``: measured points, shifted as the compound's file states. Raises PoleError for a temperature without shift.
    """
    modulus = rubber.modulus
    x: list[float] = []
    span = FORMULA_HZ
    if isinstance(modulus, TabulatedModulus):
        span = modulus.limits_hz(reference_c)
        x = [modulus.reduced_hz(row.frequency_hz, row.temperature_c, reference_c) for row in rows]
    low, high = log10(span[0]), log10(span[1])
    inset = 1e-9 * (high - low)
    hertz: Array = np.logspace(low + inset, high - inset, PLACES)
    curve = 2.0 * (1.0 + rubber.poisson) * modulus.complex_pa(2.0 * np.pi * hertz, reference_c)
    note = "points: the file's, shifted; lines: what laws take" if x else "a formula, without points"
    return _moduli_chart(
        rubber.name, f"frequency /Hz at {reference_c:g} °C", note, rows if x else (), x,
        (hertz, curve.real, curve.imag), log_x=True,
    )  # fmt: skip


def unshifted_chart(name: str, rows: Sequence[ModuliRow], reason: str) -> Chart:
    """Return the chart of points over their temperature, where the reason prevents a shift."""
    x = [row.temperature_c for row in rows]
    return _moduli_chart(name, "temperature /°C", f"not shifted: {reason}", rows, x, None, log_x=False)


def _moduli_chart(
    name: str,
    x_label: str,
    note: str,
    rows: Sequence[ModuliRow],
    x: Sequence[float],
    curve: tuple[Array, Array, Array] | None,
    log_x: bool,
) -> Chart:
    """Return the chart of points at ``x``, and of a curve: x, E' and E'' in Pa."""

    def series(label: str, style: int, of: Callable[[float, float], float]) -> list[Series]:
        found: list[Series] = []
        if rows:
            y = tuple(of(row.storage_pa, row.loss_pa) for row in rows)
            found.append(Series(label, tuple(x), y, POINTS, style))
        if curve is not None:
            at, storage, loss = (values.tolist() for values in curve)
            y = tuple(of(a, b) for a, b in zip(storage, loss, strict=True))
            found.append(Series("" if rows else label, tuple(at), y, "law", style))
        return found

    moduli = [*series("E'", STORAGE, lambda a, _: a / 1e6), *series("E''", LOSS, lambda _, b: b / 1e6)]
    tan = series("", STORAGE, lambda a, b: b / a)
    return Chart(
        name="moduli",
        title=name,
        x_label=x_label,
        y_label="modulus /MPa",
        panels=(
            ChartPanel("", tuple(moduli), joined=False, log_y=True),
            ChartPanel("", tuple(tan), y_label="tan δ", joined=False),
        ),
        note=note,
        from_zero=False,
        log_x=log_x,
        stacked=True,
    )


def surface_chart(surface: Surface, table: RadialSpectrum | None) -> Chart:
    """Return C(q) of a surface, with its two waves as vertical lines; ``table``: the points of its file or scan.

    Raises ValueError for a surface without a spectrum.
    """
    spectrum = surface.spectrum
    if spectrum is None:
        raise ValueError(f"surface {surface.name} has two waves and no spectrum: there is nothing to draw")
    q = np.geomspace(*spectrum.band_1_m, PLACES)
    q = np.clip(q, *spectrum.band_1_m)
    power = spectrum.power_m4(q)
    series = [Series("C(q)", tuple(q.tolist()), tuple(power.tolist()), "law", 0)]
    if table is not None:
        series.insert(0, Series("points", tuple(table.q_1_m.tolist()), tuple(table.power_m4.tolist()), POINTS, 0))
    ends = (float(power.min()), float(power.max()))
    found = "found" if surface.split_m is not None else "stated"
    for style, (label, wave) in enumerate((("coarse", surface.coarse), ("fine", surface.fine)), start=1):
        if wave is not None:
            at = 2.0 * np.pi / wave.wavelength_m
            words = f"{label}, {found}: {length_text(wave.wavelength_m)}"
            series.append(Series(words, (at, at), ends, "limit", style))
    return Chart(
        name="spectrum",
        title=surface.name,
        x_label="wave number q /m⁻¹",
        y_label="C /m⁴",
        panels=(ChartPanel("", tuple(series), joined=False, log_y=True),),
        note=roughness_words(surface),
        from_zero=False,
        log_x=True,
    )


def roughness_words(surface: Surface) -> str:
    """Return rms height and rms slope of a surface with a spectrum."""
    assert surface.spectrum is not None
    return f"rms height {length_text(surface.spectrum.rms_height_m)}, rms slope {surface.spectrum.rms_slope:.3g}"
