"""Grosch's experiments on the simulated track: its maxima and his two rules, found from the rows alone.

In every other seed the surfaces' lengths are others than 6 nm and 150 um: the rules do not hold, and the test of the
rules has to find out which one. Rows are drawn from the law with the scatter of specimens and repeats and the biases of
air sensor and session, or come from whole runs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from math import log10
from multiprocessing import get_context
from pathlib import Path
from typing import Final

import numpy as np

import recipes
from sim.physics.laws import LawSetting
from sim.physics.track import TWO_BELLS, TrackParameters
from sim.physics.track_bells import RUBBERS, SURFACES, TrackSurface, bells
from sim.physics.two_bells import TwoBells
from sim.physics.wlf import log10_shift
from tester.analysis.master_curve.fitted_curve import Master, master_of
from tester.analysis.master_curve.points import MasterPoint, MasterSource
from tester.analysis.master_curve.rules import Mechanism, RuleVerdict
from tester.inputs.materials.library import Library
from tester.machine.run import Outcome
from tests.campaigns.master.synthetic import arrhenius, synthetic
from tests.campaigns.master.twin import PLAIN, points_of
from tests.tester.kinds.specimen_on_track.bench import TrackBench, one_track

SEEDS, SAMPLE_SEEDS, RUNS = 20, 2, 4
COMPOUNDS: Final = ("SBR", "INR", "butyl")
REFERENCE_C: Final = 20.0
NEAR_DECADES: Final = 0.3
HELD: Final = 0.9
"""Share of seeds that is asked: 18 of 20."""
BROKEN_DECADES: Final = (0.8, 1.2)
"""By how much a length is off, where a rule does not hold."""
TEMPERATURES_C: Final = tuple(-40.0 + 10.0 * i for i in range(11))
SPEEDS_M_S: Final = tuple(10.0 ** (-6.0 + 0.5 * i) for i in range(9))
"""Of the recipe grosch."""
PIECE, REPEAT, AIR_K = 0.03, 0.02, 1.0
"""Scatter of the twin's specimens and repeats, and the greatest bias of its air sensor."""
TRACKS: Final = ("wavy glass", "silicon carbide")
Figure = tuple[str, bool]


@dataclass(frozen=True, slots=True)
class Place:
    """A maximum: its truth, and what was found, as log10 of the speed at the reference temperature."""

    truth: float
    found: float
    interval: tuple[float, float]

    @property
    def met(self) -> bool:
        """Return whether it is near the truth, and its interval holds that."""
        low, high = self.interval
        return abs(self.found - self.truth) <= NEAR_DECADES and low <= self.truth <= high


@dataclass(frozen=True, slots=True)
class Trial:
    """One seed: the number of maxima by track, the places of those found, and the rules' truth and verdicts."""

    name: str
    maxima: tuple[int, int]
    places: tuple[Place, ...]
    rules: tuple[tuple[bool, RuleVerdict], ...]
    shift: str


def surfaces_of(seed: int) -> dict[str, TrackSurface]:
    """Return the tracks of a seed; in odd ones a length, or both, is another: adhesion slower, deformation faster."""
    random = np.random.default_rng([seed, 7])
    jump, grit = (10.0 ** float(random.uniform(*BROKEN_DECADES)) for _ in range(2))
    which = int(random.integers(3)) if seed % 2 else 3
    jump, grit = jump if which in (0, 2) else 1.0, grit if which in (1, 2) else 1.0
    return {
        name: replace(SURFACES[name], jump=SURFACES[name].jump / jump, grit=SURFACES[name].grit * grit)
        for name in TRACKS
    }


def drawn(seed: int, compound: str, surface: str, tracks: dict[str, TrackSurface]) -> list[MasterPoint]:
    """Return 99 rows of the law on a track."""
    random = np.random.default_rng([seed, TRACKS.index(surface)])
    bias_k = AIR_K * float(np.random.default_rng([seed, 8]).uniform(-1.0, 1.0))
    law = TrackParameters(law=TWO_BELLS, surfaces=tracks).law_of(compound, LawSetting(surface=surface))
    piece = 1.0 + PIECE * float(random.standard_normal())
    source = MasterSource("drawn", 0.0, AIR_K / 3.0**0.5)
    held = {"surface": surface, "interface": "dry", "load": "20 N"}
    points: list[MasterPoint] = []
    for celsius in TEMPERATURES_C:
        for speed in SPEEDS_M_S:
            mu = law.mu(celsius, 20.0, speed) * piece * (1.0 + REPEAT * float(random.standard_normal()))
            points.append(MasterPoint("", compound, speed, celsius + bias_k, celsius, mu, source, held))
    return points


def run_of(seed: int, compound: str, surface: str, tracks: dict[str, TrackSurface]) -> list[MasterPoint]:
    """Return the rows of a whole run on a track; none if it did not end as planned."""
    text = one_track(Path(recipes.find("grosch")).read_text(encoding="utf-8"), surface)
    text = text.replace("compound: SBR", f"compound: {compound}")
    lengths = [f"sim.surfaces.{name}.jump={one.jump:g} um" for name, one in tracks.items()]
    lengths += [f"sim.surfaces.{name}.grit={one.grit:g} um" for name, one in tracks.items()]
    bench = TrackBench("grosch", text, (*PLAIN, *lengths), seed).leaping().to_the_end()
    done = bench.run.outcome is Outcome.DONE and not bench.kept.trips
    return points_of(bench) if done else []


def trial(which: tuple[int, bool]) -> Trial:
    """Return what a seed shows; ``which``: the seed, and whether by whole runs."""
    seed, whole = which
    compound, tracks = COMPOUNDS[seed // 2 % len(COMPOUNDS)], surfaces_of(seed)
    rubber = Library.beside().rubber(compound)
    rows = {name: (run_of if whole else drawn)(seed, compound, name, tracks) for name in TRACKS}
    name = f"seed {seed}, {compound}{', whole runs' if whole else ''}"
    if any(len(own) != len(TEMPERATURES_C) * len(SPEEDS_M_S) for own in rows.values()):
        return Trial(f"{name}: rows missing", (0, 0), (), (), "")
    glass, cloth = (
        master_of(rows[track], REFERENCE_C, None, rubber, only=only)
        for track, only in zip(TRACKS, (Mechanism.ADHESION, None), strict=True)
    )
    places = (*_places(glass, compound, tracks["wavy glass"]), *_places(cloth, compound, tracks["silicon carbide"]))
    rules = [
        (tracks["silicon carbide"].jump == SURFACES["silicon carbide"].jump
         if rule.mechanism is Mechanism.ADHESION
         else tracks["silicon carbide"].grit == SURFACES["silicon carbide"].grit, rule.verdict)
        for one in (glass, cloth) for rule in one.rules if rule.assigned
    ]  # fmt: skip
    shift = {one.choice.likelier for one in (glass, cloth) if one.choice is not None}
    return Trial(name, (len(glass.peaks), len(cloth.peaks)), places, tuple(rules), ", ".join(sorted(shift)))


def _places(one: Master, compound: str, surface: TrackSurface) -> Iterator[Place]:
    p = bells(RUBBERS[compound], surface)
    law, back = TwoBells(p), log10_shift(REFERENCE_C, p.t_ref, p.c1, p.c2)
    near = [log10(p.v_adhesion) - back, *([log10(p.v_hysteresis) - back] if p.hysteresis > 0.0 else [])]
    for at, peak in zip(near, one.peaks, strict=False):
        truth = max((at + 0.005 * i for i in range(-60, 61)), key=lambda x: law.mu(REFERENCE_C, 20.0, 10.0**x))
        low, high = (log10(end) for end in peak.interval_m_s)
        yield Place(truth, log10(peak.speed_m_s), (low, high))


def _judged(trials: Sequence[Trial], what: str) -> Iterator[Figure]:
    n = len(trials)
    least = -int(-HELD * n // 1)
    one = sum(entry.maxima == (1, 2) for entry in trials)
    yield f"{what}: one maximum on glass, two on silicon carbide: {one} of {n} (asked: {least})", one >= least
    for i, name in enumerate(("adhesion on glass", "adhesion on silicon carbide", "deformation")):
        met = sum(entry.maxima == (1, 2) and entry.places[i].met for entry in trials)
        off = [abs(entry.places[i].found - entry.places[i].truth) for entry in trials if entry.maxima == (1, 2)]
        text = f"{what}: {name} within {NEAR_DECADES:g} decades and in its interval: {met} of {n}"
        yield f"{text}, worst {max(off, default=float('inf')):.2f} decades (asked: {least})", met >= least
    verdicts = [entry for one in trials for entry in one.rules]
    right = sum(verdict is (RuleVerdict.HOLDS if holds else RuleVerdict.DOES_NOT) for holds, verdict in verdicts)
    wrong = sum(verdict is (RuleVerdict.DOES_NOT if holds else RuleVerdict.HOLDS) for holds, verdict in verdicts)
    asked = -int(-HELD * 3 * n // 1)
    broken = sum(not holds for holds, _ in verdicts)
    text = f"{what}: rules told, {broken} of {len(verdicts)} broken: {right} right, {wrong} wrong"
    yield f"{text} (asked: {asked} right, none wrong)", right >= asked and wrong == 0
    wlf = sum(entry.shift == "WLF" for entry in trials)
    yield f"{what}: WLF likelier than Arrhenius: {wlf} of {n} (asked: all)", wlf == n


def figures(seeds: int, runs: int, jobs: int) -> Iterator[Figure]:
    """Yield the figures of drawn rows, and of whole runs."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for count, whole, what in ((seeds, False, "drawn rows"), (runs, True, "whole runs")):
            if not count:
                continue
            trials = [*pool.map(trial, [(seed, whole) for seed in range(count)])]
            for entry in trials:
                off = ", ".join(f"{place.found - place.truth:+.2f}" for place in entry.places)
                told = ", ".join(f"{verdict.value} ({'true' if holds else 'broken'})" for holds, verdict in entry.rules)
                print(f"     {entry.name}: maxima {entry.maxima}, off {off} decades; {told}", flush=True)
            yield from _judged(trials, what)
    arrhenius_told = sum(
        choice is not None and choice.likelier == "Arrhenius"
        for choice in (master_of(synthetic(seed, REPEAT, shift=arrhenius), REFERENCE_C).choice for seed in range(seeds))
    )
    yield f"Arrhenius likelier where it is the truth: {arrhenius_told} of {seeds} (asked: all)", arrhenius_told == seeds
