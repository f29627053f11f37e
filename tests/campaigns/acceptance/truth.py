"""The quickstart's coefficients against the model at the means measured in each window."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import fmean

from sim.physics.parameters import SimParameters
from tests.campaigns.acceptance.bench import Bench, Run, RunSpec
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.acceptance.model import coefficient
from tests.campaigns.acceptance.sigma import stated_sigma
from tests.campaigns.acceptance.topic import Topic

CONDITIONS = 2
RECIPE = "quickstart"
SEEDS = (0, 1, 2, 3, 4)
"""Results are judged over all seeds, even in the short form: a single lucky seed proves nothing."""
QUIET = ("sim.noise=0", "sim.scatter=0")
NOISY = ("sim.scatter=0",)

SHARED = RunSpec(RECIPE, SEEDS[0], bus_log=True)
"""The run with everything on; also the one whose buses are examined."""


def exact_runs(bench: Bench) -> list[RunSpec]:
    """Name the runs with neither noise nor scatter: nothing is random in them, so one seed is enough."""
    return [RunSpec(RECIPE, seed, QUIET) for seed in (SEEDS if bench.full else SEEDS[:1])]


def noisy_runs(bench: Bench) -> list[RunSpec]:
    """Name the runs with noise and no scatter."""
    return [RunSpec(RECIPE, seed, NOISY) for seed in SEEDS]


def scattered_runs(bench: Bench) -> list[RunSpec]:
    """Name the runs with noise and scatter."""
    return [SHARED, *(RunSpec(RECIPE, seed) for seed in SEEDS[1:])]


def all_runs(bench: Bench) -> list[RunSpec]:
    """Name every run."""
    return [*exact_runs(bench), *noisy_runs(bench), *scattered_runs(bench)]


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    for spec in exact_runs(bench):
        yield from _within(bench.run(spec), f"noise 0, scatter 0, seed {spec.seed}", 1.0)
    for spec in noisy_runs(bench):
        yield from _within(bench.run(spec), f"noise 1, scatter 0, seed {spec.seed}", 4.0)
    for spec in scattered_runs(bench):
        yield from _within_sigmas(bench.run(spec), f"noise 1, scatter 1, seed {spec.seed}")


def _measured(run: Run) -> Iterator[tuple[dict[str, str], float]]:
    """Yield each condition with its error in per cent of the model's value; NaN without a coefficient."""
    for row in run.rows("conditions.csv"):
        surface, load, slip = _means(row)
        expected = coefficient(row["compound"], surface, load, slip / 1000.0)
        yield row, 100.0 * (float(row["mu_as_measured"] or "nan") / expected - 1.0)


def _means(row: dict[str, str]) -> tuple[float, float, float]:
    """Return the measured means: surface in degC, load in N, slip in mm/s; NaN if missing."""
    surface, load, slip = (row[f"measured_{key}"] for key in ("surface_c", "force_z_n", "slip_mm_s"))
    return float(surface or "nan"), float(load or "nan"), float(slip or "nan")


def _name(row: dict[str, str], kind: str) -> str:
    return f"{kind}: {row['load_n']} N"


def _trusted(kind: str, measured: list[tuple[dict[str, str], float]]) -> Figure:
    """Return whether each condition has a coefficient that the product itself considers valid."""
    without = [f"{row['load_n']} N: {row['status']}: {row['reason']}" for row, _ in measured if row["status"] != "ok"]
    return equal(f"{kind}: conditions without a coefficient in the table", "; ".join(without) or "none", "none")


def _within(run: Run, kind: str, limit_percent: float) -> Iterator[Figure]:
    measured = list(_measured(run))
    yield equal(f"{kind}: conditions", len(measured), CONDITIONS)
    yield _trusted(kind, measured)
    for row, error in measured:
        surface, load, slip = _means(row)
        at = f"{surface:.2f} degC, {load:.2f} N, {slip:.2f} mm/s"
        name = f"{_name(row, kind)}: {row['mu_as_measured']} at {at}: error"
        yield holds(name, abs(error) <= limit_percent, f"{error:+.3f} %", f"within {limit_percent:g} %")


def _within_sigmas(run: Run, kind: str) -> Iterator[Figure]:
    measured = list(_measured(run))
    yield equal(f"{kind}: conditions", len(measured), CONDITIONS)
    yield _trusted(kind, measured)
    repeats = run.rows("repeats.csv")
    for row, error in measured:
        windows = [float(r["window_s"]) for r in repeats if r["condition"] == row["condition"] and r["in_mean"] == "1"]
        if not windows:
            yield holds(f"{_name(row, kind)}: repeats in the mean", False, "none", "some")
            continue
        sigma = 100.0 * stated_sigma(SimParameters(), row["compound"], len(windows), fmean(windows))
        name = f"{_name(row, kind)}: {row['mu_as_measured']} is {error:+.2f} % off, stated sigma {sigma:.2f} %"
        yield at_most(name, abs(error) / sigma, 3.0, "sigma", 2)


TOPIC = Topic("truth", "the quickstart's coefficients against the model at what was measured", figures, all_runs)
