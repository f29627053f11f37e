"""`tester plan`: the steps of a recipe with their durations, and the uncertainty to expect."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.cli.options import QuantityType, RigChoice, command, json_option, rig_options
from tester.cli.recipe_commands import recipe_file

if TYPE_CHECKING:
    from tester.analysis.uncertainty import Pool
    from tester.inputs.materials.material_schema import CompoundModel
    from tester.inputs.recipe.foreseen import Foreseen
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.recipe.recipe_schema import Recipe
    from tester.inputs.rig import Rig


class PercentType(QuantityType):
    """An uncertainty of 0.1 % to 50 %."""

    def __init__(self) -> None:
        super().__init__("%")

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        percent = super().convert(value, param, ctx)
        if not 0.1 <= percent <= 50.0:
            self.fail(f"{percent:g} % is not within 0.1 % to 50 %", param, ctx)
        return percent


@command()
@click.argument("recipe")
@rig_options
@json_option
@click.option(
    "--precision", type=PercentType(), metavar="PERCENT",
    help="What this expanded repeatability (type A, 95 %) takes, e.g. 2%, by what is stored of the compounds.",
)
@click.option(
    "--total", type=PercentType(), metavar="PERCENT",
    help="What this total uncertainty (95 %) takes, e.g. 4%; refused where the instruments alone have more.",
)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=None, help="Folder of the stored runs (runs)."
)
def plan(
    recipe: str, rig: RigChoice, as_json: bool, precision: float | None, total: float | None, out: Path | None
) -> None:
    """List the steps of RECIPE (a file, or the name of a packaged recipe) with durations and totals."""
    from tester.inputs.recipe.precision import until_for_total, with_precision
    from tester.run.kind_lookup import checked_recipe, load_rig, recipe_part
    from tester.run.run_materials import described_compounds
    from tester.store.run_folders import RUNS

    if precision is not None and total is not None:
        raise click.UsageError("--precision and --total exclude each other")
    path, name = recipe_file(recipe)
    loaded_rig = load_rig(*rig)
    part = recipe_part(loaded_rig)
    wanted = checked_recipe(path, loaded_rig, name).recipe
    described = described_compounds(wanted, path, loaded_rig)
    if total is not None:
        precision = until_for_total(total, _foreseen(wanted, loaded_rig, part, described))
    if precision is not None:
        wanted = with_precision(wanted, precision)
    compounds = dict.fromkeys(specimen.compound for specimen in wanted.specimens if _asks_precision(wanted))
    pools = repeatability(out or RUNS, compounds, simulated=loaded_rig.simulated)
    # A plan for a precision has other repeats than the recipe, which a run carries out.
    dry = _dry_run(recipe, rig) if loaded_rig.simulated and precision is None else ""
    sys.stdout.writelines(_texts(wanted, loaded_rig, part, described, pools, as_json, dry, out or RUNS))


def _dry_run(recipe: str, rig: RigChoice) -> str:
    """Return the command that runs a recipe on the rig of a plan without questions."""
    choice = [] if rig.name == "sim" else ["--rig", rig.name]
    choice += [word for key in rig.overrides for word in ("--set", key)]
    return shlex.join(["tester", "run", recipe, *choice, "--yes"])


def _texts(
    wanted: Recipe,
    rig: Rig,
    part: RecipePart,
    described: Mapping[str, CompoundModel],
    pools: Mapping[str, Pool],
    as_json: bool,
    dry: str,
    under: Path,
) -> Iterator[str]:
    """Yield the plan of a recipe as text: lines, or chunks of JSON. ``dry``: the command of a dry run, "" for none;
    ``under``: the folder of the runs that show its pace.
    """
    from tester.base.words import about
    from tester.inputs.recipe.conditions import merged_of
    from tester.inputs.recipe.foreseen import foreseen, foreseen_fields, foreseen_lines, known_slopes
    from tester.inputs.recipe.plan_text import json_chunks, lines
    from tester.inputs.recipe.precision import precision_lines, s_percents
    from tester.inputs.recipe.time_estimate import estimate
    from tester.run.wall_time import price_s

    estimator = part.estimator(rig, s_percents(pools))
    steps = part.expand(wanted, rig, estimator)
    figures = estimate(steps, estimator)
    merged = list(merged_of(wanted))
    predictions = foreseen(steps, figures.steps, estimator, known_slopes(steps, described))
    terms = part.terms(rig)
    if as_json:
        yield from json_chunks(steps, figures, part, merged, foreseen_fields(predictions, estimator, terms))
        return
    shown = [
        lines(steps, figures, part),
        [f"a dry run takes   {about(price_s(figures, rig.kind, under))}: {dry}"] if dry else [],
        (one.sentence() for one in merged),
        foreseen_lines(predictions, estimator, terms),
        precision_lines(steps, figures, estimator, pools, predictions),
    ]
    yield from (f"{line}\n" for each in shown for line in each)


def _foreseen(recipe: Recipe, rig: Rig, part: RecipePart, described: Mapping[str, CompoundModel]) -> list[Foreseen]:
    """Return the predicted uncertainty of a recipe's conditions."""
    from tester.inputs.recipe.foreseen import foreseen, known_slopes

    steps, estimator = part.expand(recipe, rig), part.estimator(rig)
    return foreseen(steps, estimator.walk(steps), estimator, known_slopes(steps, described))


def _asks_precision(recipe: Recipe) -> bool:
    """Return whether a recipe repeats until a repeatability is reached."""
    return any(grid.until for grid in recipe.grids) or (recipe.measure is not None and recipe.measure.until is not None)


def repeatability(under: Path, compounds: Iterable[str], *, simulated: bool) -> dict[str, Pool]:
    """Return the deviations between repeats pooled over the stored runs, by compound, where there are any.

    Runs of the simulated rig count for it alone, and those of a machine for machines. Raises CatalogueError.
    """
    from tester.analysis.uncertainty import Pool
    from tester.results.catalogue import open_catalogue
    from tester.results.catalogue.entries import WantedRuns, refresh

    pools: dict[str, Pool] = {}
    if not compounds or not under.is_dir():
        return pools
    with closing(open_catalogue(under)) as catalogue:
        refresh(catalogue, under)
        for compound in compounds:
            runs = [run for run in catalogue.runs(WantedRuns(compound)) if run.simulated == simulated]
            pool = Pool()
            for one in (condition for run in runs for condition in catalogue.conditions(run)):
                if one.compound == compound and one.status == "ok" and one.mu and one.s and one.n_valid > 1:
                    df = one.n_valid - 1
                    pool = Pool(pool.squares + df * (one.s / one.mu) ** 2, pool.df + df)
            if pool.df:
                pools[compound] = pool
    return pools
