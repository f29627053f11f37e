"""How far a load deforms the rubber, how that depends on temperature, and how the rubber relaxes.

A touch shows where the rubber is, and the depth after it how far the load presses it in. With F the load, p R the load
that relaxed rubber lacks (R: what it remembers) and T its mean temperature (0: at the touch), the depth beyond the
touch is

    d = A(T) (F + p R)^(1/n) - A(T0) (F0 + p R0)^(1/n) + e - g (T - T0) + w E,   A(T) = A exp(s (T - TREF_C) / n)

A Hertz line has n of about 1.3. s is the softening: the share of the load at a depth that is lost per kelvin. p is the
relaxation: the share of the load lost at a held depth in each decade of time (quasi-linear viscoelasticity; a held load
sinks in instead). Growth by heat g, wear w (E: load times distance since the touch) and the common error e of a
touch's place are fitted as well, from priors. The deformation includes that of press and frame.

All contacts with one compound are fitted together. A contact counts as one observation, however long it is; what
contacts differ by, the runout at their touches above all, is estimated from their scatter (sandwich covariance by
contact), with Student's t for as many contacts as exceed the parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import hypot, isfinite, log, log10, sqrt
from typing import TYPE_CHECKING, Final, NamedTuple

from tester.analysis.contacts import Averages, PressedContact
from tester.analysis.quantiles import t_quantile
from tester.analysis.results import NAN

if TYPE_CHECKING:
    from tester.base.arrays import Array, Places

TREF_C: Final = 25.0
STEPS: Final = 15
"""Most steps of the fit (Gauss-Newton)."""
SAME: Final = 1e-3
"""It ends once no parameter changes by more than this share of its prior's uncertainty."""
TOUCH_U_MM: Final = 0.02
"""Standard uncertainty of a touch's place before any is seen, mm [A]: the runout, 0.05 mm peak to peak."""
LEAST_U_MM: Final = 0.005
"""Least scatter of contacts that is believed, mm [A]: a hundredth of the depth of a light load."""
LEAST_CONTACTS: Final = 10
"""Least contacts of a compound for a fit of its seven parameters."""
LEAST_SPAN_K: Final = 10.0
"""Least range of the rubber's temperature for a softening, K [A]: the depth changes by 3 % then."""
LEAST_DECADES: Final = 1.0
"""Least time under load for a relaxation, decades of seconds between the first average and the last."""


class _Prior(NamedTuple):
    """A parameter before any contact is seen: its value and its standard uncertainty."""

    value: float
    u: float


_PRIORS: Final = (
    _Prior(log(0.03), 5.0),  # ln A, A in mm/N^(1/n): unknown
    _Prior(0.0, 0.02),  # s, 1/K: rubber loses some 0.4 % of its stiffness per kelvin [A]
    _Prior(0.02, 0.05),  # p: 0.02 to 0.05 for filled rubber [A]
    _Prior(1.3, 0.1),  # n: stiffness grows with F^0.23, as measured on rollers pressed on a plane
    _Prior(0.003, 0.002),  # g, mm/K of the radius: 8 mm of rubber at 0.0004 1/K [A]
    _Prior(0.0, 1e-4),  # w, mm/(N m): 1 mm3/(N m), more than any compound wears
    _Prior(0.0, 0.03),  # e, mm: half a scan of the press at 2 mm/s and the cell's delay [A]
)
_LN_A, _SOFTENING, _RELAXATION, _EXPONENT, _GROWTH, _WEAR, _TOUCH = range(len(_PRIORS))


class WithU(NamedTuple):
    """A value with its expanded uncertainty (95 %)."""

    value: float = NAN
    expanded: float = NAN


class PressedPart(NamedTuple):
    """Some averages of a contact: their places."""

    contact: PressedContact
    places: Places


@dataclass(frozen=True, slots=True)
class Deformation:
    """The deformation at the load of a condition: loads in N, lengths in mm, with expanded uncertainties (95 %)."""

    contacts: int
    load_n: float
    body_c: float
    depth_mm: WithU

    @property
    def stiffness_n_mm(self) -> WithU:
        """Return load over depth."""
        depth, u = self.depth_mm
        return WithU(self.load_n / depth, self.load_n * u / depth**2) if depth > 0.0 else WithU()


@dataclass(frozen=True, slots=True)
class RubberStiffness:
    """What all contacts with a compound show. ``softening_per_k``, ``relaxation`` (a decade) and the exponent."""

    contacts: int
    softening_per_k: WithU
    relaxation: WithU
    exponent: WithU
    parameters: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    """Of the parameters."""
    scatter_mm: float
    """Standard deviation of the contacts about the fit."""
    coverage: float

    def at(self, parts: Sequence[PressedPart]) -> Deformation:
        """Return the deformation at the averages of a condition, contact by contact.

        Load, temperature and depth are means over the same averages: a contact of which only a moment lies in the
        condition, such as that in which the wheel lifts, counts for no more than that moment.
        """
        import numpy as np

        x = np.array(self.parameters)
        inside = [contact.loaded.at(places) for contact, places in parts]
        rows = _Rows.of(inside, [contact for contact, _ in parts])
        depth_mm = float(np.mean(rows.deeper_mm - rows.depth(x) + rows.pressed(x)))
        slope = np.mean(_slopes(rows.pressed, x) - _slopes(rows.depth, x), axis=0)
        own_mm = sqrt(float(slope @ np.array(self.covariance) @ slope))
        shares = np.bincount(rows.contact) / len(rows.contact)
        u_mm = hypot(own_mm, self.scatter_mm * sqrt(float(shares @ shares)))
        load_n, body_c = float(np.mean(rows.force_n)), TREF_C + float(np.mean(rows.body_k))
        return Deformation(len(parts), load_n, body_c, WithU(depth_mm, self.coverage * u_mm))


@dataclass(frozen=True, slots=True)
class _Rows:
    """Averages as arrays, and their touches (``0``)."""

    contact: Places
    """Number of the contact."""
    force_n: Array
    deeper_mm: Array
    body_k: Array
    once_n: Array
    twice_n: Array
    slid_n_m: Array
    touch_n: Array
    touch_k: Array
    touch_once_n: Array
    touch_twice_n: Array

    @classmethod
    def of(cls, loaded: Sequence[Averages], contacts: Sequence[PressedContact]) -> _Rows:
        import numpy as np

        counts = [len(averages.since_s) for averages in loaded]
        joined = Averages(*(np.concatenate(values) for values in zip(*loaded, strict=True)))
        touches = [(one.touch_n, one.body_c - TREF_C, *one.remembered) for one in contacts]
        return cls(
            np.repeat(np.arange(len(contacts)), counts), joined.force_n, joined.deeper_mm, joined.body_c - TREF_C,
            joined.once_n, joined.twice_n, joined.slid_n_m, *np.repeat(np.array(touches), counts, axis=0).T,
        )  # fmt: skip

    def pressed(self, x: Array) -> Array:
        """Return the whole depth at each average, mm: from rubber without a load, now or ever."""
        return self._depth(x, self.body_k, self.force_n, self.once_n, self.twice_n)

    def depth(self, x: Array) -> Array:
        """Return the depth beyond the touch at each average, mm."""
        touched = self._depth(x, self.touch_k, self.touch_n, self.touch_once_n, self.touch_twice_n)
        moved = x[_TOUCH] - x[_GROWTH] * (self.body_k - self.touch_k) + x[_WEAR] * self.slid_n_m
        return self.pressed(x) - touched + moved

    @staticmethod
    def _depth(x: Array, body_k: Array, force_n: Array, once_n: Array, twice_n: Array) -> Array:
        import numpy as np

        share = x[_RELAXATION]
        elastic_n = np.maximum(force_n + share * (once_n + share * twice_n), 1e-3)
        return np.exp(x[_LN_A] + x[_SOFTENING] * body_k / x[_EXPONENT]) * elastic_n ** (1.0 / x[_EXPONENT])


def _slopes(of: Callable[[Array], Array], x: Array) -> Array:
    """Return how depths change with each parameter, a column each."""
    import numpy as np

    columns: list[Array] = []
    for place, prior in enumerate(_PRIORS):
        step = np.zeros(len(x))
        step[place] = 1e-3 * prior.u
        columns.append((of(x + step) - of(x - step)) / (2e-3 * prior.u))
    return np.stack(columns, axis=1)


class _CompoundFit:
    """The parameters of one compound, found by least squares with priors (Gauss-Newton)."""

    def __init__(self, contacts: Sequence[PressedContact]) -> None:
        import numpy as np

        self.loaded = [contact.thinned() for contact in contacts]
        self.rows = _Rows.of(self.loaded, contacts)
        self.number = self.rows.contact
        counts: Array = np.bincount(self.number).astype(np.float64)
        self.weights: Array = 1.0 / np.sqrt(counts[self.number])
        self.values: Array = np.array([prior.value for prior in _PRIORS])
        self.spreads: Array = np.array([prior.u for prior in _PRIORS])
        self.known: Array = np.diag(self.spreads**-2.0)
        self.x: Array = self.values.copy()
        self.scatter_mm = TOUCH_U_MM
        self.free = max(len(contacts) - len(_PRIORS), 1)
        """Contacts beyond the number of parameters."""

    def solve(self) -> Array:
        """Find the parameters; return their covariance."""
        import numpy as np

        for _ in range(STEPS):
            slopes, off, hessian = self._system()
            pull = slopes.T @ off + self.known @ (self.values - self.x)
            step = np.linalg.solve(hessian, pull).astype(np.float64)
            self.x = self.x + step
            means = self.scatter_mm * np.bincount(self.number, off * self.weights)
            spread = float(np.sqrt(np.sum(means**2) / self.free))
            self.scatter_mm = max(spread, LEAST_U_MM)
            if float(np.max(np.abs(step) / self.spreads)) < SAME:
                break
        slopes, off, hessian = self._system()
        by_contact = np.stack([np.bincount(self.number, off * column) for column in slopes.T], axis=1)
        inverse = np.linalg.inv(hessian)
        scattered = by_contact.T @ by_contact * (len(self.loaded) / self.free)
        return inverse @ (scattered + self.known) @ inverse

    def _system(self) -> tuple[Array, Array, Array]:
        """Return slopes, differences from the fit, and curvature, all in units of their uncertainty."""
        weights = self.weights / self.scatter_mm
        slopes = _slopes(self.rows.depth, self.x) * weights[:, None]
        off = (self.rows.deeper_mm - self.rows.depth(self.x)) * weights
        return slopes, off, slopes.T @ slopes + self.known


def stiffness_of(contacts: Sequence[PressedContact]) -> RubberStiffness | None:
    """Return what the contacts with one compound show; None where they are fewer than ``LEAST_CONTACTS``."""
    import numpy as np

    if len(contacts) < LEAST_CONTACTS:
        return None
    fit = _CompoundFit(contacts)
    covariance = fit.solve()
    coverage = t_quantile(0.975, fit.free)
    spread = coverage * np.sqrt(np.diag(covariance))
    found = [WithU(float(value), float(own)) for value, own in zip(fit.x, spread, strict=True)]
    if not all(isfinite(one.value) and isfinite(one.expanded) for one in found):
        return None
    span_k = float(np.ptp(fit.rows.body_k))
    decades = max(log10(averages.since_s[-1] / averages.since_s[0]) for averages in fit.loaded)
    return RubberStiffness(
        len(contacts),
        found[_SOFTENING] if span_k >= LEAST_SPAN_K else WithU(),
        found[_RELAXATION] if decades >= LEAST_DECADES else WithU(),
        found[_EXPONENT],
        tuple(fit.x.tolist()),
        tuple(tuple(row) for row in covariance.tolist()),
        fit.scatter_mm,
        coverage,
    )


def by_condition(contacts: Sequence[PressedContact], condition_of: Mapping[int, int]) -> dict[int, list[PressedPart]]:
    """Return the averages inside repeats, contact by contact, by condition; ``condition_of``: by the repeat's key."""
    import numpy as np

    found: dict[int, list[PressedPart]] = {}
    for contact in contacts:
        places: dict[int, list[int]] = {}
        for place, key in enumerate(contact.loaded.repeat_key.tolist()):
            if key in condition_of:
                places.setdefault(condition_of[key], []).append(place)
        for condition, inside in places.items():
            found.setdefault(condition, []).append(PressedPart(contact, np.array(inside)))
    return found
