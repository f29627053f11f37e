"""Runs of the recipe `greta` on simulated discs that differ from the beliefs about them.

A seed has its own disc: errors of weights, cell, its axis and thermometers reach what the budget allows, the specimen
wears at 0.3 to 3 times the packaged rate, warms and cools at 0.7 to 1.3 times it, is of another area, and the tape is
rougher and has other wave lengths than the recipe's file. Speed comes from the disc's drive: no diameter matters. Water
leaves no adhesion, as `tester components` assumes.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, log
from pathlib import Path
from random import Random
from statistics import fmean
from tempfile import TemporaryDirectory

import recipes
from sim.machines.specimen_on_track.plant import SPECIMEN_SIGMA
from sim.noise import normal, uniforms
from sim.physics.greta import Greta, greta
from sim.physics.materials import Sinusoid, Surface
from sim.physics.track import TrackHeat, TrackSensors
from tester.analysis.components import PartValue
from tester.inputs.materials.library import VARIABLE, Library
from tester.kinds.specimen_on_track.budget import TERMS
from tester.results.components_table import FilmPair, film_pairs, means_of
from tester.results.run_results import results_of
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.run_reader import RunReader
from tests.campaigns.compiled.worker import Silent
from tests.campaigns.greta.direct import NAME

BASE, COLD, ROUGH = "base", "cold", "rough"
COLD_C, WARM_C = 10.0, 40.0
"""Air of the cold runs and of the recipe, degC: 30 K apart, as in the paper's statement."""
ROUGHER = 1.7
"""Ra of the rough tape over that of the seed's own."""
TAPE = "tape of the disc"
TEXT = recipes.find("greta").read_text(encoding="utf-8")
SECOND = "  - compound: tread soft\n"
SURFACE = """\
name: {name}
source: drawn
waves:
  coarse: {{wavelength: {coarse.wavelength_m:.6g} m, Ra: {coarse.ra_m:.6g} m}}
  fine: {{wavelength: {fine.wavelength_m:.6g} m, Ra: {fine.ra_m:.6g} m}}
"""


@dataclass(frozen=True)
class Disc:
    """The disc of a seed."""

    seed: int
    area_mm2: float
    wear_mm_m: float
    heat: TrackHeat
    ra: float
    length: float
    """Ra and wave lengths of its tape over those of the file."""

    @classmethod
    def of(cls, seed: int) -> Disc:
        """Draw it."""
        random, own = Random(f"greta {seed}"), TrackHeat()
        area_mm2 = 50.0 * random.uniform(0.8, 1.25)
        wear = exp(random.uniform(log(0.3), log(3.0)))
        exit_rise, rise, time = (random.uniform(0.7, 1.3) for _ in range(3))
        heat = replace(
            own, exit_rise=own.exit_rise * exit_rise, specimen_rise=own.specimen_rise * rise,
            specimen_time=own.specimen_time * time,
        )  # fmt: skip
        return cls(seed, area_mm2, 0.0005 * wear, heat, random.uniform(0.9, 1.6), random.uniform(0.8, 1.25))

    def tape(self, rougher: float = 1.0) -> Surface:
        """Return its tape; ``rougher``: its Ra over the seed's."""
        believed = Library.beside().surface("anti-slip tape")
        assert believed.coarse is not None and believed.fine is not None
        coarse, fine = (
            Sinusoid(self.length * one.wavelength_m, rougher * self.ra * one.ra_m)
            for one in (believed.coarse, believed.fine)
        )
        return replace(believed, name=TAPE, coarse=coarse, fine=fine)

    @property
    def pyrometer_bias_k(self) -> float:
        """Error of its pyrometer, K."""
        return TrackSensors().pyrometer_bias * uniforms(4, self.seed, "session track")[0]

    def overrides(self, ambient_c: float) -> tuple[str, ...]:
        """Return its keys of the rig file."""
        bounds = {term.name: term.bound for term in TERMS}
        return (
            f"sim.law={NAME}", f"sim.ambient={ambient_c:g}", f"sim.surface={TAPE}",
            f"sim.contact.area={self.area_mm2:.4f}", f"sim.contact.wear={self.wear_mm_m:.6f}",
            f"sim.contact.weights={bounds['weights']:g}",
            f"sim.sensors.force_linearity={bounds['cell linearity']:g}",
            f"sim.sensors.misalignment={bounds['axis misalignment']:g}",
            f"sim.heat.exit_rise={self.heat.exit_rise:.4f}", f"sim.heat.specimen_rise={self.heat.specimen_rise:.4f}",
            f"sim.heat.specimen_time={self.heat.specimen_time:.2f}",
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class Part:
    """A run's adhesion, hysteresis or share, and the truth."""

    name: str
    value: float
    expanded: float
    truth: float

    @property
    def held(self) -> bool:
        """Return whether the interval contains the truth."""
        return abs(self.value - self.truth) <= self.expanded


@dataclass(frozen=True, slots=True)
class Row:
    """A condition measured dry and wet; ``warmer_k``: dry contact over the wet one, as read."""

    compound: str
    load_n: float
    speed_m_s: float
    dry: float
    wet: float
    warmer_k: float
    parts: tuple[Part, ...]


@dataclass(frozen=True, slots=True)
class DiscRun:
    """A run; ``means``: the mean share of each compound, the truth the plain mean over its conditions."""

    seed: int
    name: str
    rows: tuple[Row, ...]
    means: tuple[Part, ...]


class Judge:
    """Knows the truth of a disc's runs."""

    def __init__(self, disc: Disc, tape: Surface) -> None:
        """Store the disc and its tape."""
        self._disc, self._tape = disc, tape

    @cached_property
    def _laws(self) -> dict[str, Greta]:
        library = Library.beside()
        figures = {"area": self._disc.area_mm2}
        return {name: greta(library.rubber(name), self._tape, figures) for name in ("tread", "tread soft")}

    def row(self, pair: FilmPair) -> Row:
        """Compare a pair with the law at the true temperature of the dry specimen."""
        info, dry = pair.dry.info, pair.dry.result
        compound, held = info.setpoint.compound, info.setpoint
        load_n, speed_m_s = held.number("load"), held.number("track_speed")
        power_w = dry.measured["friction_n"] * speed_m_s
        rubber_c = dry.measured["contact_c"] - self._disc.pyrometer_bias_k - self._disc.heat.exit_rise * power_w
        specimen = 1.0 + SPECIMEN_SIGMA * normal(self._disc.seed, "specimen", info.specimen)
        law = self._laws[compound].components(rubber_c, load_n, speed_m_s)
        true = {"adhesion": specimen * law.adhesion, "hysteresis": specimen * law.hysteresis,
                "share": law.hysteresis / sum(law)}  # fmt: skip
        parts = tuple(_part(name, getattr(pair.parts, name), truth) for name, truth in true.items())
        film = pair.film.result
        return Row(compound, load_n, speed_m_s, dry.mu_resultant, film.mu_resultant, pair.parts.warmer_k, parts)


def _part(name: str, value: PartValue, truth: float) -> Part:
    return Part(name, value.value, value.expanded, truth)


def carry_out(seed: int, name: str, *, sample: bool = False) -> DiscRun:
    """Run the recipe on the disc of a seed; a sample has its first compound. Raises RuntimeError if it ends early or
    lacks a pair."""
    disc = Disc.of(seed)
    tape = disc.tape(ROUGHER if name == ROUGH else 1.0)
    air_c = COLD_C if name == COLD else WARM_C
    text = TEXT.replace(f"temperature: {WARM_C:g} degC", f"temperature: {air_c:g} degC")
    text = text.replace(SECOND, "") if sample else text
    with TemporaryDirectory(prefix="greta-") as place:
        recipe = Path(place) / "recipe.yaml"
        recipe.write_text(text, encoding="utf-8")
        surface = Path(place) / "laboratory" / "surfaces" / "tape.yaml"
        surface.parent.mkdir(parents=True)
        surface.write_text(SURFACE.format(name=TAPE, coarse=tape.coarse, fine=tape.fine), encoding="utf-8")
        screen = Silent()
        options = SessionOptions(
            str(recipe), "pin-on-disc", disc.overrides(air_c), out=Path(place) / "runs", seed=seed, samples=False
        )
        session = Session(options, screen)
        # The recipe does not name this surface, so the run has no copy of it: it is in the laboratory's folder.
        os.environ[VARIABLE] = str(Path(place) / "laboratory")
        try:
            code = session.run()
        finally:
            del os.environ[VARIABLE]
        if session.folder is None or code:
            raise RuntimeError(f"seed {seed}, {name}: exit code {code}: {' '.join(screen.messages)[-800:]}")
        with RunReader(session.folder) as reader:
            pairs = [*film_pairs(results_of(reader))]
        judge = Judge(disc, tape)
        rows = tuple(map(judge.row, pairs))
    if len(rows) != (8 if sample else 16):
        raise RuntimeError(f"seed {seed}, {name}: {len(rows)} pairs of dry and wet")
    return DiscRun(seed, name, rows, tuple(_means(pairs, rows)))


def one_run(case: tuple[int, str, bool]) -> DiscRun:
    """Carry out a run; ``case``: seed, name, whether it is a sample."""
    seed, name, sample = case
    return carry_out(seed, name, sample=sample)


def _means(pairs: list[FilmPair], rows: tuple[Row, ...]) -> Iterator[Part]:
    for mean in means_of(pairs):
        parts = [part for row in rows if row.compound == mean.compound for part in row.parts]
        yield _part(mean.compound, mean.share, fmean(part.truth for part in parts if part.name == "share"))
