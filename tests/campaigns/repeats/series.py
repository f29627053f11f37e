"""Synthetic block series over the times and temperatures of real repeats of the simulated rig.

The pattern is what matters: at 100 N few long bursts, in which temperature rises with time; of 3# at 55 degC many short
ones. Bursts, durations and temperatures come from a run, the coefficient is synthetic: AR(1) noise of 1 % and 0.3 s,
the compound's sensitivity to temperature, 2 % between repeats, and the drift under test.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, islice
from math import exp
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from tester.analysis.blocks import Block, blocks_from_samples
from tester.analysis.flags import CARRY_OVER, NOT_SHOWN, flags_in
from tester.analysis.judge import judge
from tester.analysis.left_out import counting
from tester.analysis.reduce import counted, reduce_repeat
from tester.analysis.results import NOT_JUDGED, Judgement, RepeatResult
from tester.analysis.stability import Window
from tester.base.quantities import Means
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.store.run_reader import RunReader
from tests.tester.analysis.series import correlated

WINDOW = 30
LEAST, MOST = 3, 6
RUNS = 2
"""A pattern has the repeats of so many runs, each with a seed of its own: one run is one thermometer."""
MU, BETWEEN = 0.8, 0.02

RECIPE = """recipe: patterns
specimens: [{{compound: "{compound}"}}]
measure: {{wheel_speed: 0.8 m/s, repeats: 6, window: 45 rev, temperature_band: 2 degC}}
grids:
  - {{name: pattern, slip_velocity: 300 mm/s, load: {load} N, temperature: {temperature} degC}}
"""
"""A window of 45: a repeat then has revolutions to spare for a transient that is left out. A wheel that is not ground
in differs only in its coefficients, which are not used."""

Drift = Callable[[int, int], float]
"""Share of the coefficient by repeat (from 0) and block of it (from 0)."""


@dataclass(frozen=True, slots=True)
class Pattern:
    """Repeats as on the rig, and the compound's sensitivity, 1/K."""

    name: str
    repeats: tuple[tuple[Block, ...], ...]
    per_kelvin: float


@dataclass(frozen=True, slots=True)
class Case:
    """The result of one condition."""

    results: tuple[RepeatResult, ...]
    judgement: Judgement

    @property
    def stable(self) -> bool:
        """Return whether enough repeats are valid and the drift is demonstrably small."""
        return len(counting(self.results)) >= LEAST and NOT_SHOWN not in flags_in(self.judgement.flags)

    @property
    def carries(self) -> bool:
        """Return whether the condition has the flag of a run-in."""
        return CARRY_OVER in flags_in(self.judgement.flags)

    def refused(self, position: int) -> bool:
        """Return whether a repeat was made and refused."""
        return position < len(self.results) and not self.results[position].valid


def pattern(name: str, compound: str, load_n: int, temperature_c: int, per_kelvin: float, run: Callable[..., Path]
            ) -> Pattern:  # fmt: skip
    """Return the pattern of a condition; ``run`` runs a recipe (text, seed, folder) and returns its folder."""
    with TemporaryDirectory() as name_:
        text = RECIPE.format(compound=compound, load=load_n, temperature=temperature_c)
        folders = [run(text, seed, Path(name_)) for seed in range(RUNS)]
        repeats = tuple(chain.from_iterable(map(_repeats, folders)))
    return Pattern(name, repeats, per_kelvin)


def _repeats(folder: Path) -> Iterator[tuple[Block, ...]]:
    """Yield the blocks of a run's repeats."""
    with RunReader(folder) as reader:
        for one in reader.repeats():
            if one.result.revolutions:
                samples = reader.samples(one.condition, one.repeat, one.attempt)
                yield tuple(blocks_from_samples(samples, reader.quantities()))


def settling(size: float, blocks: float) -> Drift:
    """Return a run-in: an excess, gone to 1/e after so many blocks of sliding, a third of which lie between repeats."""
    return lambda repeat, block: size * exp(-(1.5 * 45 * repeat + block) / blocks)


def steady(drift: float, only: int | None = None) -> Drift:
    """Return a drift per window in all repeats, or in one of them."""
    return lambda repeat, block: drift * (block - 22) / WINDOW if only in (None, repeat) else 0.0


def _made(of: Pattern, random: Random, repeat: int, drift: Drift) -> Sequence[Block]:
    """Return a repeat's blocks: the rig's collection, with extra blocks for a transient."""
    base = of.repeats[random.randrange(len(of.repeats))]
    level, middle = 1.0 + random.gauss(0.0, BETWEEN), sum(b.means.temperature for b in base) / len(base)
    noise = islice(correlated(random), len(base))
    blocks: list[Block] = []
    for i, (one, e) in enumerate(zip(base, noise, strict=True)):
        mu = MU * level * (1.0 + e + drift(repeat, i) + of.per_kelvin * (one.means.temperature - middle))
        along, across = QUANTITIES.roles.friction
        means = dict(one.means) | {along: mu * one.means.normal, across: 0.0}
        blocks.append(replace(one, mu=mu, means=Means(one.means.table, means.values())))
    transient = len(blocks) - len(counted(blocks, Window(WINDOW)))
    return blocks[: int(1.5 * WINDOW) + transient]


def condition(of: Pattern, seed: int, drift: Drift) -> Case:
    """Measure a condition of 3 repeats, at most 6, as the engine does, through the product's own rule."""
    random = Random(f"{of.name} {seed}")
    results: list[RepeatResult] = []
    blocks: list[Sequence[Block]] = []
    judgement = NOT_JUDGED
    for repeat in range(MOST):
        made = _made(of, random, repeat, drift)
        results.append(reduce_repeat(made, Window(WINDOW)))
        blocks.append(counted(made, Window(WINDOW)))
        if sum(result.valid for result in results) >= LEAST:
            results, judgement = judge(results, blocks, LEAST, Window(WINDOW))
            if Case(tuple(results), judgement).stable:
                return Case(tuple(results), judgement)
    results, judgement = judge(results, blocks, LEAST, Window(WINDOW))
    return Case(tuple(results), judgement)
