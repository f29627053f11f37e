"""The figures: their runs, their limits, and the number of seeds of the short and the long form."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median

from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal, holds
from tests.campaigns.seeds import heat, recipes
from tests.campaigns.seeds.rubber import REAL_RUBBER, WEAR_RATES, worn_at
from tests.campaigns.seeds.sweeps import Sweeps, SweepSpec, Swept

BELIEFS = ("wear.rate=0.24", "observer.friction_heat_fraction=0.078", "sim.wheel.outer_diameter=89.5")
"""The rig file's wrong beliefs about the twin: wear three times as fast, 30 % more friction heat, and a wheel that is
half a millimetre smaller than believed."""

STABILITY_WORDS = ("drift", "stabil", "transient", "fluctuat")
"""Words in a reason that mean that the coefficient was not steady."""


@dataclass(frozen=True, slots=True)
class Topic:
    """One group of figures."""

    name: str
    title: str
    figures: Callable[[Sweeps], Iterator[Figure]]


def _complete(name: str, swept: Swept, seeds: int, rows: int) -> Iterator[Figure]:
    """Yield whether every seed ends with exit code 0 and every row, and the exceptions."""
    wanted = {"exit_code": "0", "missing_rows": "0", "rows": str(rows)}
    good = [run for run in swept.runs if wanted.items() <= run.items()]
    bad = sorted(int(run["seed"]) for run in swept.runs if run not in good)
    yield equal(f"{name}: seeds with exit code 0 and all {rows} rows", len(good), seeds)
    if bad:
        yield holds(f"{name}: seeds that are not", False, " ".join(map(str, bad)), "none")
    yield equal(f"{name}: exit code of the sweep", swept.code, 0)


def _quickstart(sweeps: Sweeps) -> Iterator[Figure]:
    seeds = 100 if sweeps.full else 10
    yield from _complete("quickstart", sweeps.sweep(SweepSpec("quickstart", seeds, REAL_RUBBER)), seeds, 2)
    few = 20 if sweeps.full else 3
    spec = SweepSpec("quickstart", few, (*REAL_RUBBER, *BELIEFS))
    yield from _complete("quickstart with wrong beliefs", sweeps.sweep(spec), few, 2)


def _loads(sweeps: Sweeps) -> Iterator[Figure]:
    seeds = 40 if sweeps.full else 1
    swept = sweeps.sweep(SweepSpec(recipes.LOADS, seeds, REAL_RUBBER))
    yield from _lost("loads", swept, 24 * seeds, 1.0)


def _lost(name: str, swept: Swept, expected: int, percent: float) -> Iterator[Figure]:
    """Yield the share of conditions without a value, and each of them."""
    yield equal(f"{name}: conditions", len(swept.conditions), expected)
    lost = [row for row in swept.conditions if row["status"] != "ok"]
    yield at_most(f"{name}: conditions lost", 100.0 * len(lost) / max(expected, 1), percent, "%", 2)
    for row in lost:
        where = f"{row['compound']}, {row['load_n']} N, {row['temperature_c']} degC"
        yield holds(f"{name}: seed {row['seed']}", True, f"{where}: {row['status']}", "counted above")


def _table2(sweeps: Sweeps) -> Iterator[Figure]:
    conditions: list[dict[str, str]] = []
    for spec in _table2_specs(sweeps.full):
        swept = sweeps.sweep(spec)
        rubber = spec.overrides[-1].removeprefix("sim.")
        ended = sum(run["outcome"] == "done" for run in swept.runs)
        yield equal(f"table2, {rubber}: seeds that came to their end, without a trip", ended, spec.seeds)
        planned = int(str(sweeps.plan(spec)["conditions"])) - int(str(sweeps.plan(spec).get("references", 0)))
        yield equal(f"table2, {rubber}: rows, with or without a value", len(swept.conditions), planned * spec.seeds)
        conditions += swept.conditions
    lost = [row for row in conditions if row["status"] != "ok"]
    unnamed = [row for row in lost if not row["reason"]]
    yield equal("table2: conditions without a value and without a reason", len(unnamed), 0)
    unstable = [row for row in lost if any(word in row["reason"].lower() for word in STABILITY_WORDS)]
    share = 100.0 * len(unstable) / max(len(conditions), 1)
    yield at_most("table2: rows without a value for lack of stability", share, 0.1, "%", 2)
    for row in lost:
        where = f"{row['compound']}, {row['slip_velocity_mm_s']} mm/s, {row['load_n']} N, {row['sideslip_deg']} deg"
        text = f"{where}, {row['temperature_c']} degC: {row['status']}: {row['reason']}"
        yield holds(f"table2: seed {row['seed']}", True, text, "named")


def _table2_specs(full: bool) -> list[SweepSpec]:
    """Return Table 2 with 20 seeds shared among the wear rates, or its short form with one."""
    if not full:
        return [SweepSpec(recipes.table2_short(), 1, REAL_RUBBER)]
    least, middle, most = (worn_at(rate) for rate in WEAR_RATES)
    return [SweepSpec("table2", 7, least), SweepSpec("table2", 7, middle, 7), SweepSpec("table2", 6, most, 14)]


def _rubber(sweeps: Sweeps) -> Iterator[Figure]:
    """Yield, for every wear rate, how many seeds finished: any trip here is a false one."""
    seeds = 10 if sweeps.full else 1
    for rate in WEAR_RATES:
        runs = sweeps.sweep(SweepSpec(recipes.RUBBER, seeds, worn_at(rate))).runs
        ended = sum(run["outcome"] == "done" for run in runs)
        yield equal(f"real rubber, wear {rate:g} mm3/(N m): seeds that came to their end, without a trip", ended, seeds)


SEEDS_OF_A_MEDIAN = 20
"""Minimum number of seeds for the median of the rig time."""

ESTIMATED = {
    "quickstart": "quickstart",
    "four conditions": recipes.FOUR,
    "much friction": recipes.STICKY,
    "angles": recipes.ANGLES,
    "rolling and sliding": recipes.ROLLING,
}


def _estimate(sweeps: Sweeps) -> Iterator[Figure]:
    seeds = 20 if sweeps.full else 1
    within = total = 0
    for name, text in ESTIMATED.items():
        spec = SweepSpec(text, 100 if sweeps.full and name == "quickstart" else seeds)
        plan = sweeps.plan(spec)
        planned_s, low, high = (float(str(plan[key])) for key in ("rig_seconds", "rig_seconds_low", "rig_seconds_high"))
        took = [float(run["rig_seconds"]) for run in sweeps.sweep(spec).runs[:seeds] if run["outcome"] == "done"]
        middle = median(took) if took else float("nan")
        inside = sum(low <= seconds <= high for seconds in took)
        within, total = within + inside, total + seeds
        off = 100.0 * (middle / planned_s - 1.0)
        words = f"{middle:.0f} s against {planned_s:.0f} s ({low:.0f} to {high:.0f}): {off:+.1f} %"
        # The thermometer's bias of a session moves a run by a third: the median of a few seeds means nothing.
        judged = seeds >= SEEDS_OF_A_MEDIAN
        limit = "within 5 %" if judged else "not judged: too few seeds"
        yield holds(f"estimate, {name}: median of {len(took)} seeds", not judged or abs(off) <= 5.0, words, limit)
        yield holds(f"estimate, {name}: runs inside the range", True, f"{inside} of {len(took)}", "counted below")
    yield at_least("estimate: runs inside the stated 95 % range", 100.0 * within / total, 90.0, "%", 1)


TOPICS = {
    topic.name: topic
    for topic in (
        Topic("quickstart", "every seed of the quickstart gives its two rows", _quickstart),
        Topic("loads", "four loads, three compounds, two temperatures: conditions that are lost", _loads),
        Topic("table2", "the paper's 165 conditions: every one is a row or named with its reason", _table2),
        Topic("rubber", "rubber that relaxes, softens, grows and wears, up to 400 N and 85 degC: no trip", _rubber),
        Topic("heat", "heat unlike the beliefs, three successive runs of a rig: no trip", heat.figures),
        Topic("estimate", "rig time against what the plan says, five recipes", _estimate),
    )
}
