"""Tables of slow laws (``sim.physics.lookup``): made once of a law's values, and kept in a folder from run to run.

A table begins with 40 speeds, 20 temperatures and 5 loads. If it is not accurate enough, the number of points on the
worst axis is doubled, up to a limit. The file's name is made of the contents of its table: the law and its
version, its figures, the materials' content, the span. Different content has another file; a file that is damaged, or
cannot be read, is made anew.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Final

import numpy as np

from sim.physics import laws
from sim.physics.lookup import BELOW_C, SplineTable, TableSpan, TabulatedLaw, load_scale, scale

if TYPE_CHECKING:
    from sim.physics.laws import LawOfParts
    from sim.physics.materials import Array

Points = tuple[int, int, int]

POINTS: Final[Points] = (40, 20, 5)
"""Points on the axes: speeds, temperatures, loads."""
ALLOWED: Final = 0.005
"""Greatest allowed relative error of a table."""
ROUNDS: Final = 6
"""Greatest number of times that an axis is given twice the points."""
FORMAT: Final = "table 4"
"""Version of the making and writing of tables."""
_SAMPLES: Final = 200
"""Number of places midway between points, which show a coarse table and its worst axis."""
_EVERYWHERE: Final = 4000
"""Number of places anywhere: where adhesion saturates a law has a bend, and few midway places are on it."""
_MARGIN: Final = 0.6
"""Samples do not find the worst place: their error must be at most this share of the allowed error."""
_LEAST_MU: Final = 1e-12


def tabulated(
    name: str,
    compound: str,
    figures: Mapping[str, float],
    setting: laws.LawSetting,
    span: TableSpan,
) -> TabulatedLaw:
    """Return the table of a law from the setting's folder; a missing table is made and put there.

    Raises the exceptions of ``laws.make``, NoPartsError for a law that does not know its parts, and the law's
    exceptions if the span exceeds the law's range.
    """
    slow = laws.with_parts(name, laws.make(name, compound, figures, setting))
    file = None
    if setting.tables is not None:
        key = _key(name, compound, figures, setting, span)
        file = setting.tables / f"{key}.table" if key else None
    kept = _read(file) if file is not None else None
    if kept is not None:
        error, total, adhesion = kept
        return _law(slow, span, total, adhesion, error)
    made, total, adhesion = build(slow, span)
    if file is not None:
        _write(file, made, total, adhesion)
    return made


def build(slow: LawOfParts, span: TableSpan, rounds: int = ROUNDS) -> tuple[TabulatedLaw, Array, Array]:
    """Return a table of a law, with its splines' coefficients over (loads, temperatures, speeds): ln mu, adhesion."""
    points: Points = POINTS
    while True:
        law, total, adhesion = build_at(slow, span, points)
        if law.error < _MARGIN * ALLOWED or rounds == 0:
            return law, total, adhesion
        rounds -= 1
        errors = [_error(law, slow, points, (axis,)) for axis in range(3)]
        worst = errors.index(max(errors))
        speeds, temperatures, loads = (2 * n if axis == worst else n for axis, n in enumerate(points))
        points = speeds, temperatures, loads


def build_at(slow: LawOfParts, span: TableSpan, points: Points) -> tuple[TabulatedLaw, Array, Array]:
    """Return a table with these numbers of points, and its splines' coefficients as ``build``."""
    speeds, temperatures, loads = _axes(span, points)
    parts = np.array([[[slow.components(t, n, v) for v in speeds] for t in temperatures] for n in loads])
    mu = np.maximum(parts.sum(axis=-1), _LEAST_MU)
    total, adhesion = _coefficients(np.log(mu)), _coefficients(parts[..., 0] / mu)
    law = _law(slow, span, total, adhesion, 0.0)
    law.error = _error(law, slow, points, (0, 1, 2))
    if law.error < _MARGIN * ALLOWED:
        law.error = max(law.error, _error_anywhere(law, slow))
    return law, total, adhesion


def _axes(span: TableSpan, points: Points) -> tuple[list[float], list[float], list[float]]:
    speeds = np.geomspace(*span.speeds_m_s, points[0])
    low, high = (scale(end) for end in span.temperatures_c)
    temperatures = -1.0 / np.linspace(low, high, points[1]) - BELOW_C
    temperatures[0], temperatures[-1] = span.temperatures_c
    light, heavy = (load_scale(end) for end in span.loads_n)
    return speeds.tolist(), temperatures.tolist(), (np.linspace(light, heavy, points[2]) ** 2).tolist()


def _law(slow: LawOfParts, span: TableSpan, total: Array, adhesion: Array, error: float) -> TabulatedLaw:
    loads, temperatures, speeds = (n - 2 for n in total.shape)
    return TabulatedLaw(slow, span, (speeds, temperatures, loads), _spline(total), _spline(adhesion), error)


def _spline(coefficients: Array) -> SplineTable:
    return SplineTable([row for plane in coefficients.tolist() for row in plane], coefficients.shape[1])


def _coefficients(values: Array) -> Array:
    """Return the coefficients of the B-spline through values at (loads, temperatures, speeds)."""
    for axis in range(3):
        values = np.moveaxis(_along_first(np.moveaxis(values, axis, 0)), 0, axis)
    return values


def _along_first(values: Array) -> Array:
    """Return coefficients along the first axis, two more than values: through each, and one cubic over two end steps.

    At a point the spline is (c[i-1] + 4 c[i] + c[i+1]) / 6; its third derivative is continuous where the fourth
    difference of the coefficients is 0.
    """
    n = len(values)
    matrix = np.zeros((n + 2, n + 2))
    matrix[0, :5] = matrix[-1, -5:] = (1.0, -4.0, 6.0, -4.0, 1.0)
    for i in range(n):
        matrix[i + 1, i : i + 3] = (1.0 / 6.0, 4.0 / 6.0, 1.0 / 6.0)
    flat = np.zeros((n + 2, int(np.prod(values.shape[1:]))))
    flat[1:-1] = values.reshape(n, -1)
    solved = np.linalg.solve(matrix, flat).astype(np.float64, copy=False)
    return solved.reshape(n + 2, *values.shape[1:])


def _error(law: TabulatedLaw, slow: LawOfParts, points: Points, across: tuple[int, ...]) -> float:
    """Return the greatest relative error at random places: midway between two points along these axes, on points
    along the others."""
    random = np.random.default_rng(1)
    low, high = (np.array(ends) for ends in zip(*_ends(law.span), strict=True))
    worst = 0.0
    for _ in range(_SAMPLES):
        steps = np.array([random.integers(n - (axis in across)) for axis, n in enumerate(points)], dtype=float)
        steps[list(across)] += 0.5
        speed, place, load = low + (high - low) * steps / (np.array(points) - 1)
        worst = max(worst, _off(law, slow, float(-1.0 / place - BELOW_C), float(load**2), float(np.exp(speed))))
    law.outside = 0  # rounding may have left the span
    return worst


def _error_anywhere(law: TabulatedLaw, slow: LawOfParts) -> float:
    """Return the greatest relative error at random places; loads and speeds are spread evenly in their logarithms."""
    random = np.random.default_rng(1)
    span = law.span
    (light, heavy), (slowest, fastest) = span.loads_n, span.speeds_m_s
    worst = 0.0
    for _ in range(_EVERYWHERE):
        load_n = light * (heavy / light) ** random.random()
        slip_m_s = slowest * (fastest / slowest) ** random.random()
        worst = max(worst, _off(law, slow, random.uniform(*span.temperatures_c), load_n, slip_m_s))
    law.outside = 0
    return worst


def _off(law: TabulatedLaw, slow: LawOfParts, temperature_c: float, load_n: float, slip_m_s: float) -> float:
    expected = max(slow.mu(temperature_c, load_n, slip_m_s), _LEAST_MU)
    return abs(law.mu(temperature_c, load_n, slip_m_s) / expected - 1.0)


def _ends(span: TableSpan) -> list[tuple[float, float]]:
    (slow, fast), (cold, warm), (light, heavy) = span.speeds_m_s, span.temperatures_c, span.loads_n
    return [
        (float(np.log(slow)), float(np.log(fast))), (scale(cold), scale(warm)), (load_scale(light), load_scale(heavy)),
    ]  # fmt: skip


def _key(
    name: str, compound: str, figures: Mapping[str, float], setting: laws.LawSetting, span: TableSpan
) -> str | None:
    """Return the name of a table's file: SHA-256 of all its inputs; None if the content of an input is unknown."""
    assert setting.materials is not None  # the law was made of them
    maker = laws.find(name)
    version = maker.version if isinstance(maker, laws.OfMaterials) else 0
    content = repr((
        FORMAT, name, version, sorted(figures.items()), setting.area_mm2, span, POINTS, ROUNDS,
        setting.materials.rubber(compound), setting.materials.surface(setting.surface),
    ))  # fmt: skip
    if " object at 0x" in content:
        return None  # an address in memory is no content
    return hashlib.sha256(content.encode()).hexdigest()


def _write(file: Path, law: TabulatedLaw, total: Array, adhesion: Array) -> None:
    """Write a table to its file in one step; if that fails, the next run makes it again."""
    body = np.concatenate([[*total.shape, law.error], total.ravel(), adhesion.ravel()]).astype("<f8").tobytes()
    with contextlib.suppress(OSError):
        file.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=file.parent, suffix=".part")
        try:
            with os.fdopen(handle, "wb") as part:
                part.write(hashlib.sha256(body).digest() + body)
            Path(name).replace(file)
        finally:
            Path(name).unlink(missing_ok=True)


def _read(file: Path) -> tuple[float, Array, Array] | None:
    """Return a table's error and coefficients from its file; None if there is no complete file."""
    try:
        content = file.read_bytes()
    except OSError:
        return None
    digest, body = content[:32], content[32:]
    if hashlib.sha256(body).digest() != digest:
        return None
    numbers = np.frombuffer(body, dtype="<f8").astype(np.float64)
    total, adhesion = numbers[4:].reshape(2, *numbers[:3].astype(int))
    return float(numbers[3]), total, adhesion
