"""Records of runs as input of a fit, drawn condition by condition: a law, and all errors of a run.

Hundreds of whole runs of `grosch`, and of the 40 conditions of `table2` without an angle, would take days. A record has
the design of the recipe, the truth of a twin's law at the surface's own temperature, a factor of the piece, scatter of
the setting and of repeats, and the errors that a run's conditions share, from the kind's own budget; the fit receives
what ``run_points`` would return. ``tests.campaigns.fit.whole`` adds some whole runs.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, log
from typing import Final

import numpy as np

from sim.physics import laws
from sim.physics.wlf import WlfBellParameters
from tester.analysis.fit.fit_law import Common, FitPoint, Law, Source
from tester.analysis.left_out import REPEATABILITY
from tester.analysis.terms import Acts
from tester.kinds.specimen_on_track.budget import TERMS as TRACK_TERMS
from tester.kinds.specimen_on_track.fit.fits import FITS as TRACK
from tester.kinds.specimen_on_track.fit.laws import WLF_BELL
from tester.kinds.specimen_on_track.fit.run_data import TEMPERATURE as TRACK_TEMPERATURE
from tester.kinds.wheel_on_belt.budget import TERMS as WHEEL_TERMS
from tester.kinds.wheel_on_belt.fit.laws import TEMPERATURE, V2_LAW
from tester.kinds.wheel_on_belt.fit.run_data import BETWEEN_CONDITIONS
from tester.results.fit_points import standard_of
from tests.campaigns.fit.synthetic import DESIGN

TEMPERATURES_C: Final = tuple(-40.0 + 10.0 * i for i in range(11))
SPEEDS_M_S: Final = tuple(10.0 ** (-6.0 + 0.5 * i) for i in range(9))
LOAD_N: Final = 20.0
"""Of the recipe grosch."""
REPEATS: Final = 5
"""Of the recipe table2."""
COMPOUNDS: Final = ("1#", "2#", "3#")
A_WHEEL: Final = 20
"""Approximate life of a wheel in table2, in conditions: 2 mm of diameter."""
FACTOR: Final = 0.01
"""Standard uncertainty of calibration and alignment, which all conditions share: about the value of both budgets
[A]."""


@dataclass(frozen=True, slots=True)
class Record:
    """The fitted data, and the law of the fit."""

    law: Law
    cells: tuple[int, ...]
    points: tuple[FitPoint, ...]
    free_of_error: tuple[float, ...]
    """ln mu of the twin's law at the true temperature."""


def on_track(make: laws.PlainMaker, seed: int) -> Record:
    """Return a record of grosch: 99 conditions, one repeat each, on one specimen."""
    law, random = make("SBR", {}), np.random.default_rng([seed, 1])
    piece, thermometer = (standard_of(TRACK_TERMS, one) for one in (Acts.PIECE, Acts.TEMPERATURE))
    source = _source("grosch", piece, thermometer, TRACK_TEMPERATURE, 1)
    off_k, common = thermometer * random.standard_normal(), np.exp(_gain(random, piece))
    design = [(v, t, LOAD_N) for t in TEMPERATURES_C for v in SPEEDS_M_S]
    exact = [law.mu(t - off_k, load, v) for v, t, load in design]
    errors = REPEATABILITY * random.standard_normal(len(design))
    points = [
        FitPoint("", "SBR", at, at, float(mu * common * (1.0 + e)), source, REPEATABILITY, inf, piece=1)
        for at, mu, e in zip(design, exact, errors, strict=True)
    ]
    return Record(TRACK.bound(WLF_BELL, "SBR, dry", "", {}), TRACK.cells, tuple(points), tuple(map(log, exact)))


def on_wheel(make: laws.PlainMaker, seed: int) -> Record:
    """Return a record of one compound of table2, in turns: 40 conditions without an angle, five repeats, two wheels."""
    compound = COMPOUNDS[seed % len(COMPOUNDS)]
    law, random = make(compound, {}), np.random.default_rng([seed, 2])
    piece, thermometer = (standard_of(WHEEL_TERMS, one) for one in (Acts.PIECE, Acts.TEMPERATURE))
    source = _source("table2", piece, thermometer, TEMPERATURE, 2)
    between, own = BETWEEN_CONDITIONS[compound].standard, REPEATABILITY / REPEATS**0.5
    off_k, gain = thermometer * random.standard_normal(), FACTOR * random.standard_normal()
    wheels = piece * random.standard_normal(2)
    exact = [law.mu(t - off_k, load, v) for t, load, v in DESIGN]
    errors = random.standard_normal((2, len(DESIGN)))
    points: list[FitPoint] = []
    for i, ((t, load, v), mu) in enumerate(zip(DESIGN, exact, strict=True)):
        at, wheel = (t, load, v), i // A_WHEEL
        factors = np.exp(gain + wheels[wheel]) * (1.0 + between * errors[0, i]) * (1.0 + own * errors[1, i])
        points.append(FitPoint("", compound, at, at, float(mu * factors), source, own,
                               float((REPEATS - 1) * len(DESIGN)), between=between, piece=wheel + 1))  # fmt: skip
    return Record(V2_LAW, (1, 2), tuple(points), tuple(map(log, exact)))


def _source(name: str, piece: float, thermometer: float, variable: int, pieces: int) -> Source:
    shared = Common("calibration and alignment", FACTOR), Common("thermometer", thermometer, variable)
    return Source(name, (*shared, *(Common("piece", piece, piece=i + 1) for i in range(pieces))))


def _gain(random: np.random.Generator, piece: float) -> float:
    """Return ln of a factor of all conditions: calibration, and the one piece."""
    return float(FACTOR * random.standard_normal() + piece * random.standard_normal())


def truth_on_track(record: Record) -> tuple[float, ...]:
    """Return the parameters of the right law on the track."""
    right = WlfBellParameters()
    return right.mu_0, right.mu_max, right.width, right.v_ref, right.t_ref


def truth_on_wheel(record: Record) -> tuple[float, ...]:
    """Return the parameters of v2 of a record's compound."""
    return V2_LAW.published[record.points[0].group]
