"""The least of a law: a straight line in one variable, and made-up conditions for it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from tester.analysis.fit.fit_law import NAN, FitPoint, Law, LawParameter, Source, Variable

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

TABLE = Source("a table")


def _line(p: Array, x: Array) -> Array:
    return p[..., 0, None] + p[..., 1, None] * x[..., 0]


LINE = Law(
    name="line",
    title="a straight line",
    formula="mu = m + s x",
    variables=(Variable("x", "mm", 1e3), Variable("y", "degC", ratio=False)),
    parameters=(
        LawParameter("m", "", 1.0, 0.1, positive=True),
        LawParameter("s", "1/m", 0.1, 0.1, levels=("x", 2)),
    ),
    value=_line,
    published={"one": (1.0, 0.5)},
)


def point(
    x: float, value: float, *, group: str = "one", source: Source = TABLE, type_a: float = NAN, df: float = 0.0
) -> FitPoint:
    return FitPoint(f"{group} {x:g}", group, (x, 20.0), (x, 20.0), value, source, type_a, df)


def line(xs: Sequence[float], m: float = 1.0, s: float = 0.5, **given: float) -> list[FitPoint]:
    return [point(x, m + s * x, **given) for x in xs]  # type: ignore[arg-type]
