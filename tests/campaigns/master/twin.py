"""The simulated slow track end to end: silicon carbide of the packaged recipe, run in process, on a master curve.

The rig is ticked without a record, and with half the scans while drives are enabled (10 Hz instead of 20: most of the
time goes into soaking and into the slowest speed): 20 s of processor time a run instead of 60.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot, nan
from pathlib import Path
from typing import Final

import recipes
from sim.physics.track_bells import RUBBERS
from tester.analysis.master_curve.fitted_curve import master_of
from tester.analysis.master_curve.points import MasterPoint, MasterSource
from tester.analysis.terms import Acts
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.budget import TERMS
from tester.machine.run import Outcome
from tests.tester.kinds.specimen_on_track.bench import TrackBench, one_track

TRUTH_C: Final = RUBBERS["SBR"].t_ref
PLAIN: Final = ("scan.enabled=10 Hz",)
UNBIASED: Final = (*PLAIN, "sim.sensors.air_bias=0")


LEFT_OUT: Final = (", 30 degC, 40 degC, 50 degC, 60 degC", "1e-6 m/s, ")
"""Of the recipe for a sample: four temperatures, and the slowest speed, which takes longest."""


@dataclass(frozen=True, slots=True)
class Found:
    """The result of a run."""

    seed: int
    unbiased: bool
    ts_c: float
    low_c: float
    high_c: float
    verdict: str
    rows: int

    @property
    def off_k(self) -> float:
        """Return the error of Ts, K."""
        return self.ts_c - TRUTH_C

    @property
    def inside(self) -> bool:
        """Return whether the interval contains the truth."""
        return self.low_c <= TRUTH_C <= self.high_c


def points_of(bench: TrackBench) -> list[MasterPoint]:
    """Return the rows of a finished run, with the thermometer's uncertainty from the machine's budget."""
    thermometer = hypot(*(one.standard for one in TERMS if one.acts is Acts.TEMPERATURE))
    source = MasterSource("twin", 0.0, thermometer)
    steps = {step.condition: step for step in bench.plan.conditions()}
    points: list[MasterPoint] = []
    for condition, result in bench.kept.results:
        held = held_by(steps[condition].setpoint)
        means = result.means
        if result.valid:
            points.append(
                MasterPoint(
                    f"{condition}", steps[condition].setpoint.compound, abs(means["sliding_m_s"]), means["contact_c"],
                    held.temperature_c, result.mu_resultant, source,
                )
            )  # fmt: skip
    return points


def measured(which: tuple[int, bool, bool]) -> Found:
    """Return the result of a run: by seed, with or without a correct thermometer, and with all or fewer rows."""
    seed, unbiased, sample = which
    text = one_track(Path(recipes.find("grosch")).read_text(encoding="utf-8"))
    for left_out in LEFT_OUT if sample else ():
        assert left_out in text
        text = text.replace(left_out, "")
    bench = TrackBench("grosch", text, UNBIASED if unbiased else PLAIN, seed).to_the_end()
    if bench.run.outcome is not Outcome.DONE or bench.kept.trips:
        return Found(seed, unbiased, nan, nan, nan, f"{bench.run.outcome.value}: {bench.run.reason}", 0)
    points = points_of(bench)
    one = master_of(points, 20.0)
    low, high = one.collapse.interval
    return Found(seed, unbiased, one.collapse.ts_c, low, high, one.judged.verdict.value, len(points))
