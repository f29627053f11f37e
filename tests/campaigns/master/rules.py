"""Grosch's experiments on the simulated track: its maxima and his two rules, found from the rows alone.

The seeds take each of his four rubbers in turn. In every other seed the surfaces' lengths are not 6 nm and 150 um: a
rule fails, and the test of the rules must find which one. In each seed the twin's rubber differs from the beliefs of
its file and the analysis in Ts, the constants of the shift, heights and widths. Rows are drawn from the law with the
scatter of specimens and repeats and the biases of air sensor and session, or come from whole runs of all three tracks.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, fields, replace
from math import log10, nan
from multiprocessing import get_context
from pathlib import Path
from typing import Final, get_type_hints

import numpy as np

import recipes
from sim.physics.laws import LawSetting
from sim.physics.track import TWO_BELLS, TrackParameters
from sim.physics.track_bells import RUBBERS, SURFACES, TrackRubber, TrackSurface, bells
from sim.physics.two_bells import TwoBells
from sim.physics.wlf import log10_shift
from tester.analysis.master_curve.fitted_curve import Master, master_of
from tester.analysis.master_curve.points import MasterPoint, MasterSource
from tester.analysis.master_curve.rules import Mechanism, RuleVerdict
from tester.inputs.materials.library import Library
from tester.kinds.specimen_on_track.axes import held_by
from tester.machine.run import Outcome
from tests.campaigns.master.synthetic import arrhenius, synthetic
from tests.campaigns.master.twin import PLAIN, points_of
from tests.tester.kinds.specimen_on_track.bench import FOUR_RUBBERS, TrackBench, temperatures_of, with_rubber

SEEDS, SAMPLE_SEEDS, RUNS = 20, 2, 8
REFERENCE_C: Final = 20.0
NEAR_DECADES: Final = 0.3
HELD: Final = 0.9
"""Required share of seeds: 18 of 20."""
BROKEN_DECADES: Final = (0.8, 1.2)
"""Change of a length in decades where a rule fails."""
OFF_K, OFF_SHIFT, OFF_HEIGHT, OFF_WIDTH = 1.0, 0.02, 0.15, 0.1
"""Maximum difference of the twin's rubber from its file: Ts; constants of the shift, heights and widths as shares
[A]."""
SPEEDS_M_S: Final = tuple(10.0 ** (-6.0 + 0.5 * i) for i in range(9))
"""Of the recipe grosch."""
PIECE, REPEAT, AIR_K = 0.03, 0.02, 1.0
"""Scatter of the twin's specimens and repeats, and the greatest bias of its air sensor."""
TRACKS: Final = ("wavy glass", "silicon carbide", "silicon carbide, talc")
GLASS, CLOTH, TALC = TRACKS
MECHANISM: Final = {GLASS: Mechanism.ADHESION, CLOTH: None, TALC: Mechanism.DEFORMATION}
"""Name of a track's only maximum in `tester master`."""
MUCH: Final = 0.7
"""At the slower maximum talc leaves less than this share of what it leaves at the faster one [A]: a much stronger
reduction."""
ROWS: Final = 99
Figure = tuple[str, bool]


@dataclass(frozen=True, slots=True)
class Place:
    """A maximum: its truth and the result, as log10 of the speed at the reference temperature."""

    truth: float
    found: float
    interval: tuple[float, float]

    @property
    def met(self) -> bool:
        """Return whether it is near the truth, and its interval contains the truth."""
        low, high = self.interval
        return abs(self.found - self.truth) <= NEAR_DECADES and low <= self.truth <= high


@dataclass(frozen=True, slots=True)
class Trial:
    """One seed: rows and number of maxima by track, the places of those found on the clean ones, the rules' truth and
    verdicts there, and the comparison of the tracks."""

    name: str
    rows: tuple[int, ...]
    maxima: tuple[int, ...]
    places: tuple[Place, ...] = ()
    rules: tuple[tuple[bool, RuleVerdict], ...] = ()
    shift: str = ""
    glass_over_cloth: float = nan
    """Friction at the maximum on glass over that at the slower one on silicon carbide."""
    talc_left: tuple[float, float] = (nan, nan)
    """Share of friction that talc leaves at the slower and at the faster maximum of silicon carbide."""

    @property
    def complete(self) -> bool:
        """Return whether no track lacks a row."""
        return self.rows == (ROWS,) * len(TRACKS)

    @property
    def told_from_glass(self) -> bool:
        """Return whether glass has the higher adhesion, and talc lowers the slower maximum much more than the other."""
        slow, fast = self.talc_left
        return self.glass_over_cloth > 1.0 and slow < MUCH * fast and fast < 1.0


def surfaces_of(seed: int) -> dict[str, TrackSurface]:
    """Return the tracks of a seed; in odd ones one length, or both, differ: adhesion slower, deformation faster."""
    random = np.random.default_rng([seed, 7])
    jump, grit = (10.0 ** float(random.uniform(*BROKEN_DECADES)) for _ in range(2))
    which = int(random.integers(3)) if seed % 2 else 3
    jump, grit = jump if which in (0, 2) else 1.0, grit if which in (1, 2) else 1.0
    return {
        name: replace(SURFACES[name], jump=SURFACES[name].jump / jump, grit=SURFACES[name].grit * grit)
        for name in (GLASS, CLOTH)
    }


def rubber_of(seed: int, compound: str) -> TrackRubber:
    """Return the twin's rubber in a seed: it differs from the beliefs of its file and the analysis."""
    draw, own = np.random.default_rng([seed, 9]), RUBBERS[compound]

    def off(value: float, share: float) -> float:
        return value * (1.0 + share * float(draw.uniform(-1.0, 1.0)))

    return replace(
        own,
        t_ref=own.t_ref + OFF_K * float(draw.uniform(-1.0, 1.0)),
        c1=off(own.c1, OFF_SHIFT),
        c2=off(own.c2, OFF_SHIFT),
        adhesion=off(own.adhesion, OFF_HEIGHT),
        hysteresis=off(own.hysteresis, OFF_HEIGHT),
        adhesion_width=off(own.adhesion_width, OFF_WIDTH),
        hysteresis_width=off(own.hysteresis_width, OFF_WIDTH),
    )


def drawn(seed: int, compound: str, own: TrackRubber, tracks: dict[str, TrackSurface]) -> dict[str, list[MasterPoint]]:
    """Return 99 rows of the law on each track."""
    bias_k = AIR_K * float(np.random.default_rng([seed, 8]).uniform(-1.0, 1.0))
    twin = TrackParameters(law=TWO_BELLS, surfaces=tracks, rubbers={compound: own})
    source = MasterSource("drawn", 0.0, AIR_K / 3.0**0.5)
    found: dict[str, list[MasterPoint]] = {}
    for i, track in enumerate(TRACKS):
        random = np.random.default_rng([seed, i])
        surface, _, interface = track.partition(", ")
        law = twin.contact.through(
            twin.law_of(compound, LawSetting(surface=surface)), interface or "dry"  # type: ignore[arg-type]
        )  # fmt: skip
        piece = 1.0 + PIECE * float(random.standard_normal())
        held = {"surface": surface, "interface": interface or "dry", "load": "20 N"}
        found[track] = [
            MasterPoint("", compound, v, at + bias_k, at,
                        law.mu(at, 20.0, v) * piece * (1.0 + REPEAT * float(random.standard_normal())), source, held)
            for at in temperatures_of(compound) for v in SPEEDS_M_S
        ]  # fmt: skip
    return found


def run_of(seed: int, compound: str, own: TrackRubber, tracks: dict[str, TrackSurface]) -> dict[str, list[MasterPoint]]:
    """Return the rows of a whole run by track; none if it did not end as planned."""
    text = with_rubber(Path(recipes.find("grosch")).read_text(encoding="utf-8"), compound)
    keys = [*_keys(f"sim.rubbers.{compound}", own, RUBBERS[compound])]
    keys += [key for name, one in tracks.items() for key in _keys(f"sim.surfaces.{name}", one, SURFACES[name])]
    bench = TrackBench("grosch", text, (*PLAIN, *keys), seed).leaping().to_the_end()
    found: dict[str, list[MasterPoint]] = {track: [] for track in TRACKS}
    if bench.run.outcome is Outcome.DONE and not bench.kept.trips:
        steps = {step.condition: held_by(step.setpoint) for step in bench.plan.conditions()}
        for point in points_of(bench):
            held = steps[int(point.label)]
            found[held.surface if held.interface == "dry" else f"{held.surface}, {held.interface}"].append(point)
    return found


def _keys(path: str, group: TrackRubber | TrackSurface, packaged: TrackRubber | TrackSurface) -> Iterator[str]:
    """Yield the keys in which a rubber or a surface differs from the packaged one."""
    units = get_type_hints(type(group), include_extras=True)
    for item in fields(group):
        unit, value = units[item.name].__metadata__[0], getattr(group, item.name)
        if value != getattr(packaged, item.name):
            yield f"{path}.{item.name}={value:.9g}{'' if unit == '1' else f' {unit}'}"


def trial(which: tuple[int, bool]) -> Trial:
    """Return the result of a seed; ``which``: the seed, and whether by a whole run."""
    seed, whole = which
    compound, tracks = FOUR_RUBBERS[seed // 2 % len(FOUR_RUBBERS)], surfaces_of(seed)
    rubber, own = Library.beside().rubber(compound), rubber_of(seed, compound)
    rows = (run_of if whole else drawn)(seed, compound, own, tracks)
    name = f"seed {seed}, {compound}{', a whole run' if whole else ''}"
    counts = tuple(len(rows[track]) for track in TRACKS)
    if counts != (ROWS,) * len(TRACKS):
        return Trial(name, counts, ())
    found = {track: master_of(rows[track], REFERENCE_C, None, rubber, only=MECHANISM[track]) for track in TRACKS}
    maxima = tuple(len(one.peaks) for one in found.values())
    clean = {track: found[track] for track in (GLASS, CLOTH)}
    places = [place for track, one in clean.items() for place in _places(one, own, tracks[track])]
    lengths, stated = tracks[CLOTH], SURFACES[CLOTH]
    holds = {Mechanism.ADHESION: lengths.jump == stated.jump, Mechanism.DEFORMATION: lengths.grit == stated.grit}
    rules = [(holds[rule.mechanism], rule.verdict) for one in clean.values() for rule in one.rules if rule.assigned]
    shift = {one.choice.likelier for one in clean.values() if one.choice is not None}
    over, left = nan, (nan, nan)
    if maxima[:2] == (1, 2):
        slow, fast = (log10(peak.speed_m_s) for peak in found[CLOTH].peaks)
        over = found[GLASS].peaks[0].mu / found[CLOTH].peaks[0].mu
        left = _mu(found[TALC], slow) / _mu(found[CLOTH], slow), _mu(found[TALC], fast) / _mu(found[CLOTH], fast)
    return Trial(name, counts, maxima, tuple(places), tuple(rules), ", ".join(sorted(shift)), over, left)


def _mu(one: Master, x: float) -> float:
    """Return friction on a master curve at log10 of a speed at the reference temperature."""
    return float(np.exp(one.collapse.curve.at(np.array([x + one.back]))[0]))


def _places(one: Master, rubber: TrackRubber, surface: TrackSurface) -> Iterator[Place]:
    p = bells(rubber, surface)
    law, back = TwoBells(p), log10_shift(REFERENCE_C, p.t_ref, p.c1, p.c2)
    near = [log10(p.v_adhesion) - back, *([log10(p.v_hysteresis) - back] if p.hysteresis > 0.0 else [])]
    for at, peak in zip(near, one.peaks, strict=False):
        truth = max((at + 0.005 * i for i in range(-60, 61)), key=lambda x: law.mu(REFERENCE_C, 20.0, 10.0**x))
        low, high = (log10(end) for end in peak.interval_m_s)
        yield Place(truth, log10(peak.speed_m_s), (low, high))


def _judged(trials: Sequence[Trial], what: str) -> Iterator[Figure]:
    n = len(trials)
    least = -int(-HELD * n // 1)
    full = sum(entry.complete for entry in trials)
    yield f"{what}: {ROWS} rows on each of {len(TRACKS)} tracks: {full} of {n} (asked: all)", full == n
    one = sum(entry.maxima[:1] == (1,) for entry in trials)
    yield f"{what}: no second maximum on glass: {one} of {n} (asked: {least})", one >= least
    one = sum(entry.maxima[:2] == (1, 2) for entry in trials)
    yield f"{what}: one maximum on glass, two on silicon carbide: {one} of {n} (asked: {least})", one >= least
    for i, name in enumerate(("adhesion on glass", "adhesion on silicon carbide", "deformation")):
        met = sum(entry.maxima[:2] == (1, 2) and entry.places[i].met for entry in trials)
        off = [abs(entry.places[i].found - entry.places[i].truth) for entry in trials if entry.maxima[:2] == (1, 2)]
        text = f"{what}: {name} within {NEAR_DECADES:g} decades and in its interval: {met} of {n}"
        yield f"{text}, worst {max(off, default=float('inf')):.2f} decades (asked: {least})", met >= least
    verdicts = [entry for one in trials for entry in one.rules]
    right = sum(verdict is (RuleVerdict.HOLDS if holds else RuleVerdict.DOES_NOT) for holds, verdict in verdicts)
    wrong = sum(verdict is (RuleVerdict.DOES_NOT if holds else RuleVerdict.HOLDS) for holds, verdict in verdicts)
    asked = -int(-HELD * 3 * n // 1)
    broken = sum(not holds for holds, _ in verdicts)
    text = f"{what}: rules told, {broken} of {len(verdicts)} broken: {right} right, {wrong} wrong"
    yield f"{text} (asked: {asked} right, none wrong)", right >= asked and wrong == 0
    apart = sum(entry.told_from_glass for entry in trials)
    worst = max((entry.talc_left[0] / entry.talc_left[1] for entry in trials), default=nan)
    text = f"{what}: glass has the higher adhesion, talc lowers the slower maximum much more: {apart} of {n}"
    yield f"{text}, worst {worst:.2f} of the faster one's share (asked: {least}, below {MUCH:g})", apart >= least
    wlf = sum(entry.shift == "WLF" for entry in trials)
    yield f"{what}: WLF likelier than Arrhenius: {wlf} of {n} (asked: all)", wlf == n


def figures(seeds: int, runs: int, jobs: int) -> Iterator[Figure]:
    """Yield the figures of drawn rows, and of whole runs."""
    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        for count, whole, what in ((seeds, False, "drawn rows"), (runs, True, "whole runs")):
            if not count:
                continue
            trials: list[Trial] = []
            for entry in pool.map(trial, [(seed, whole) for seed in range(count)]):
                trials.append(entry)
                off = ", ".join(f"{place.found - place.truth:+.2f}" for place in entry.places)
                text = ", ".join(f"{verdict.value} ({'true' if holds else 'broken'})" for holds, verdict in entry.rules)
                print(f"     {entry.name}: rows {entry.rows}, maxima {entry.maxima}, off {off} decades; {text}; talc"
                      f" leaves {entry.talc_left[0]:.2f} and {entry.talc_left[1]:.2f}", flush=True)
            yield from _judged(trials, what)
    likelier = sum(
        choice is not None and choice.likelier == "Arrhenius"
        for choice in (master_of(synthetic(seed, REPEAT, shift=arrhenius), REFERENCE_C).choice for seed in range(seeds))
    )
    yield f"Arrhenius likelier where it is the truth: {likelier} of {seeds} (asked: all)", likelier == seeds
