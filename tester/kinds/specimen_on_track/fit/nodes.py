"""A table of an expensive function: computed at grid nodes when first needed, interpolated linearly between them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import product
from typing import NamedTuple

import numpy as np

from tester.base.arrays import Array, Places


class GridAxis(NamedTuple):
    """Evenly spaced nodes of a coordinate; values beyond an end take that end's node."""

    first: float
    last: float
    step: float

    @property
    def nodes(self) -> int:
        """Return how many nodes there are."""
        return round((self.last - self.first) / self.step) + 1

    def place(self, values: Array) -> tuple[Places, Array]:
        """Return the node below each value, and the value's place from it to the next, 0 to 1."""
        at = np.clip((values - self.first) / self.step, 0.0, self.nodes - 1.000001)
        below = np.floor(at)
        return below.astype(np.intp), np.asarray(at - below, dtype=np.float64)


class GridNodes:
    """Values of a function, each a row of numbers, at nodes of some axes."""

    def __init__(self, axes: Sequence[GridAxis], work_out: Callable[[Sequence[float]], Array]) -> None:
        """``work_out``: returns the row of a node's coordinates; its exceptions reach the caller of ``corners``."""
        self._axes, self._work_out = tuple(axes), work_out
        self._row_of = np.full([axis.nodes for axis in self._axes], -1, dtype=np.int32)
        self._rows: list[Array] = []
        self._values: Array = np.empty((0, 0))

    @property
    def values(self) -> Array:
        """Return the computed rows, shape (rows, m)."""
        if len(self._values) != len(self._rows):
            self._values = np.array(self._rows)
        return self._values

    def corners(self, *coordinates: Array) -> Iterator[tuple[Places, Array]]:
        """Yield the row in ``values`` and the weight of each corner of the points' cells, both in the points' shape.

        All rows are computed before the first corner is yielded.
        """
        placed = [axis.place(one) for axis, one in zip(self._axes, np.broadcast_arrays(*coordinates), strict=True)]
        found: list[tuple[Places, Array]] = []
        for corner in product((0, 1), repeat=len(placed)):
            at = tuple(below + up for (below, _), up in zip(placed, corner, strict=True))
            self._fill(at)
            weight: Array = np.ones(placed[0][1].shape)
            for (_, on), up in zip(placed, corner, strict=True):
                weight = weight * (on if up else 1.0 - on)
            found.append((np.asarray(self._row_of[at], dtype=np.intp), weight))
        yield from found

    def _fill(self, at: tuple[Places, ...]) -> None:
        missing = self._row_of[at] < 0
        if not missing.any():
            return
        for node in sorted({*zip(*(one[missing].tolist() for one in at), strict=True)}):
            point = [axis.first + axis.step * place for axis, place in zip(self._axes, node, strict=True)]
            self._rows.append(self._work_out(point))
            self._row_of[node] = len(self._rows) - 1
