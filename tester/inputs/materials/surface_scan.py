"""Reads heights of a surface from a file: a matrix as text, read here; formats of instruments by SurfaceTopography.

A matrix has a row of heights in each line, cells separated by a comma, a semicolon, a tab or spaces; lines that begin
with # are skipped. A hole (an empty cell, nan) is refused: its height was not measured.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any, Final, cast

import numpy as np

from tester.base.arrays import Array
from tester.base.plugins import MissingExtraError, needs
from tester.base.source import InvalidSource, Problem
from tester.inputs.materials.files import Findings, decoded
from tester.inputs.materials.radial import Detrend, RadialSpectrum, detrended, radial_spectrum

MAX_BYTES = 512 * 1024 * 1024
TEXT_SUFFIXES = frozenset({"", ".csv", ".txt", ".tsv", ".dat", ".asc"})
"""Suffixes of files read as a matrix of text; others are an instrument's."""
UNITS_M: Final = {"nm": 1e-9, "um": 1e-6, "µm": 1e-6, "μm": 1e-6, "mm": 1e-3, "m": 1.0}
BLUNT_SHARE = 0.05
"""The table is doubted if its <h^2> differs from that of the heights by more than this share [A]."""

_HOLES = frozenset({"", "nan", "-", "--", "***", "bad", "na"})
_DECIMAL_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+([eE][+-]?[0-9]+)?")


@dataclass(frozen=True, slots=True)
class ScanOptions:
    """A person's options for a scan, beside its content."""

    pixel_m: float | None = None
    unit: str | None = None
    detrend: Detrend = "plane"
    ask_pixel: str = "--pixel 1um"
    ask_unit: str = "--unit um"


@dataclass(frozen=True, slots=True)
class HeightMap:
    """Heights in m, (rows, columns), and the distance from row to row and from column to column, m."""

    heights_m: Array
    pixel_m: tuple[float, float]


def read_scan(path: Path, content: bytes, options: ScanOptions, findings: Findings) -> HeightMap:
    """Return the heights of a file. Raises InvalidSource with every problem, MissingExtraError."""
    if path.suffix.casefold() in TEXT_SUFFIXES:
        matrix, pixel, unit = _matrix(decoded(content), findings), None, None
    else:
        matrix, pixel, unit = _instrument(path, findings)
    if options.unit is not None:
        if unit is not None and unit != options.unit:
            findings.doubt((1, 1), f"the file has heights in {unit}; taken in {options.unit}, as asked", lasting=True)
        unit = options.unit
    if unit is None:
        findings.refuse((1, 1), f"the heights have no unit (expected nm, um, mm or m; {options.ask_unit})")
    if options.pixel_m is not None:
        if pixel is not None and not np.allclose(pixel, options.pixel_m, rtol=1e-3):
            hint = f"the file states points {pixel[0]:.4g} m apart; taken {options.pixel_m:.4g} m, as asked"
            findings.doubt((1, 1), hint, lasting=True)
        pixel = (options.pixel_m, options.pixel_m)
    if pixel is None:
        findings.refuse((1, 1), f"the distance from point to point is missing (expected such as {options.ask_pixel})")
    holes = np.argwhere(~np.isfinite(matrix))
    if len(holes):
        row, column = holes[0] + 1
        hint = f"{len(holes)} of {matrix.size} heights are holes, the first in row {row}, column {column}"
        findings.refuse((1, 1), f"{hint}: fill them where the scan was made, or cut a piece without any")
    findings.end()
    assert unit is not None and pixel is not None
    return HeightMap(matrix * UNITS_M[unit], pixel)


def spectrum_of(scan: HeightMap, detrend: Detrend, findings: Findings) -> RadialSpectrum:
    """Return a scan's spectrum; notes the detrending. Raises InvalidSource."""
    flat = detrended(scan.heights_m, scan.pixel_m, detrend)
    try:
        spectrum = radial_spectrum(flat, scan.pixel_m)
    except ValueError as error:
        raise InvalidSource([Problem(findings.file, 1, 1, str(error))]) from error
    rows, columns = flat.shape
    rms = float(np.sqrt(np.mean(flat**2)))
    what = "their mean" if detrend == "mean" else "the plane of least squares"
    findings.notes.append(
        f"{rows} x {columns} heights, {scan.pixel_m[0] * 1e6:.4g} x {scan.pixel_m[1] * 1e6:.4g} um apart, "
        f"without {what}; rms {rms * 1e6:.4g} um"
    )
    findings.notes.append("radial average of the transform under a Hann window, <h^2> = 2 pi int q C dq")
    share = (spectrum.rms_height_m / rms) ** 2 - 1.0
    if abs(share) > BLUNT_SHARE:
        difference = f"the spectrum's <h^2> is {100.0 * share:+.0f} % off that of the heights"
        findings.doubt(
            (1, 1), f"{difference}: the map has waves as long as itself, or is not alike in all places", lasting=True
        )
    return spectrum


def _matrix(text: str, findings: Findings) -> Array:
    """Return the heights of a text; holes are nan. Refuses lines of unequal length, and cells that are no number."""
    lines = [
        (number, line)
        for number, line in enumerate(text.splitlines(), start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not lines:
        findings.refuse_now((1, 1), "no heights (expected a matrix, a row of numbers in each line)")
    delimiter = next((mark for mark in ("\t", ";") if mark in lines[0][1]), "," if "," in lines[0][1] else None)
    rows: list[Array] = []
    width = len(_cells(lines[0][1], delimiter))
    for number, line in lines:
        cells = _cells(line, delimiter)
        if len(cells) != width:
            findings.refuse((number, 1), f"{len(cells)} heights (expected {width}, as in the first row)")
            continue
        try:
            rows.append(np.array([_number(cell, delimiter) for cell in cells]))
        except ValueError as error:
            findings.refuse((number, 1), str(error))
    findings.end()
    return np.array(rows)


def _cells(line: str, delimiter: str | None) -> Sequence[str]:
    cells = [cell.strip() for cell in line.split(delimiter)]
    # Many programs end a row with its delimiter.
    return cells[:-1] if delimiter is not None and len(cells) > 1 and not cells[-1] else cells


def _number(cell: str, delimiter: str | None) -> float:
    if cell.casefold() in _HOLES:
        return float("nan")
    if delimiter != "," and _DECIMAL_COMMA.fullmatch(cell):
        cell = cell.replace(",", ".")
    try:
        if "_" not in cell:  # Python's digit groups are not valid in such a file
            return float(cell)
    except ValueError:
        pass
    raise ValueError(f'"{cell[:40]}" is not a height (expected a number)')


def _instrument(path: Path, findings: Findings) -> tuple[Array, tuple[float, float] | None, str | None]:
    """Return heights, distances in m and unit from an instrument's format. Raises MissingExtraError."""
    try:
        library = import_module("SurfaceTopography")
    except ImportError as error:
        raise MissingExtraError(needs(f"a scan {path.suffix}", "SurfaceTopography", "topography")) from error
    reading = cast("Any", library)
    try:
        topography = reading.read_topography(str(path))
        heights = np.ma.asarray(topography.heights())
        sizes, unit = topography.physical_sizes, topography.unit
    except Exception as error:  # each of its readers raises its own error
        findings.refuse((1, 1), f"SurfaceTopography cannot read it: {type(error).__name__}: {error}")
        raise InvalidSource(findings.problems) from error
    if heights.ndim != 2:
        findings.refuse_now((1, 1), f"a line of {heights.size} heights (expected a map)")
    values = np.asarray(heights.filled(np.nan), dtype=np.float64)
    known = unit if unit in UNITS_M else None
    if unit and known is None:
        findings.doubt((1, 1), f'the file has heights in "{unit}", which is not known here', lasting=True)
    if sizes is None or known is None:
        return values, None, known
    pixel = tuple(float(size) / points * UNITS_M[known] for size, points in zip(sizes, values.shape, strict=True))
    return values, (pixel[0], pixel[1]), known
