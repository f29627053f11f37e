"""`tester check`, `tester plan`, `tester schema`: recipes before anything moves."""

from __future__ import annotations

import gc
import sys
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

import recipes
from tester.base.processes import EXIT_INVALID
from tester.cli.options import (
    QuantityType,
    json_option,
    print_json,
    rig_option,
    risk_option,
    say_other_settings,
    say_packaged_keys,
    set_option,
)

if TYPE_CHECKING:
    from tester.analysis.uncertainty import Pool
    from tester.base.source import Problem
    from tester.inputs.materials.material_schema import CompoundModel
    from tester.inputs.recipe.foreseen import Foreseen
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.recipe.recipe_schema import Recipe
    from tester.inputs.rig import Rig
    from tester.run.run_materials import UsedMaterials


def recipe_file(name_or_path: str) -> tuple[Path, str]:
    """Return a recipe's file and what messages call it; a usage error where there is no such recipe."""
    try:
        path = recipes.find(name_or_path)
    except recipes.UnknownRecipe as error:
        raise click.UsageError(str(error)) from error
    packaged = path.parent == recipes.FOLDER and Path(name_or_path) != path
    return path, f"recipes/{path.name}" if packaged else name_or_path


@click.command()
@click.argument("recipe")
@rig_option
@set_option
@risk_option
@json_option
@click.option("--verbose", is_flag=True, help="Also say which files its compounds and its surface are described by.")
def check(
    recipe: str, rig_name: str, overrides: tuple[str, ...], accept_risk: str, as_json: bool, verbose: bool
) -> int:
    """Validate RECIPE (a file, or the name of a packaged recipe) against the schema and the rig.

    Every problem at once, as file:line:col: message, and exit code 3. What is doubtful in the files of its compounds
    and its surface, or is not expected to end well on the rig, is a warning.
    """
    from tester.base.source import InvalidSource
    from tester.inputs.recipe.conditions import conditions_of, merged_of
    from tester.inputs.recipe.reference_section import REFERENCE, ReferenceSection
    from tester.run.kind_lookup import checked_recipe, load_rig, recipe_part
    from tester.run.run_materials import used_materials

    path, name = recipe_file(recipe)
    rig = load_rig(rig_name, overrides, accept_risk)
    part = recipe_part(rig)
    try:
        loaded = checked_recipe(path, rig, name)
        used = used_materials(loaded.recipe, path)
    except InvalidSource as error:
        if not as_json:
            raise
        print_json({"valid": False, "problems": [_fields(problem) for problem in error.problems]})
        return EXIT_INVALID
    valid, doubts = loaded.recipe, [*used.doubts, *map(str, loaded.doubts)]
    count = len(conditions_of(valid, part.settings)) * len(valid.specimens) * valid.replicates
    merged = list(merged_of(valid))
    if as_json:
        shared = [one.as_data() for one in merged]
        print_json({"valid": True, "problems": [], "conditions": count, "merged": shared, "doubts": doubts})
    else:
        for doubt in doubts:
            click.echo(f"warning: {doubt}", err=True)
        for line in _materials(used) if verbose else ():
            click.echo(line, err=True)
        watched = isinstance(section := getattr(valid, REFERENCE, None), ReferenceSection)
        every = f", a reference condition after every {section.every}" if watched else ""
        click.echo(f'{name}: valid on rig "{rig.name}", {count} conditions{every}')
        for one in merged:
            click.echo(one.sentence())
    say_packaged_keys(rig_name, overrides)
    say_other_settings(rig_name, rig)
    return 0


def _materials(used: UsedMaterials) -> Iterator[str]:
    for one in used.files:
        yield f"{one.role} {one.name}: {one.path}, sha256 {one.sha256}"
    for role, what in used.bare:
        yield f"{role} {what}: no file describes it, its name alone is recorded"


@click.command()
@click.argument("recipe")
@rig_option
@set_option
@risk_option
@json_option
@click.option(
    "--precision",
    type=QuantityType("%"),
    metavar="PERCENT",
    help="What this expanded repeatability (type A, 95 %) takes, e.g. 2%, by what is stored of the compounds.",
)
@click.option(
    "--total",
    type=QuantityType("%"),
    metavar="PERCENT",
    help="What this total uncertainty (95 %) takes, e.g. 4%; refused where the instruments alone have more.",
)
@click.option(
    "--out", type=click.Path(file_okay=False, path_type=Path), default=None, help="Folder of the stored runs (runs)."
)
def plan(
    recipe: str,
    rig_name: str,
    overrides: tuple[str, ...],
    accept_risk: str,
    as_json: bool,
    precision: float | None,
    total: float | None,
    out: Path | None,
) -> None:
    """List the steps of RECIPE (a file, or the name of a packaged recipe) with durations and totals."""
    from tester.inputs.recipe.conditions import merged_of
    from tester.inputs.recipe.foreseen import foreseen, foreseen_fields, foreseen_lines, known_slopes
    from tester.inputs.recipe.plan_json import json_chunks
    from tester.inputs.recipe.plan_text import lines
    from tester.inputs.recipe.precision import (
        PrecisionError,
        precision_lines,
        s_percents,
        until_for_total,
        with_precision,
    )
    from tester.inputs.recipe.time_estimate import estimate
    from tester.run.kind_lookup import checked_recipe, load_rig, recipe_part
    from tester.run.run_materials import described_compounds

    if precision is not None and total is not None:
        raise click.UsageError("--precision and --total exclude each other")
    for option, percent in (("--precision", precision), ("--total", total)):
        if percent is not None and not 0.1 <= percent <= 50.0:
            raise click.BadParameter(f"{percent:g} % is not within 0.1 % to 50 %", param_hint=option)
    path, name = recipe_file(recipe)
    rig = load_rig(rig_name, overrides, accept_risk)
    part = recipe_part(rig)
    wanted = checked_recipe(path, rig, name).recipe
    described = described_compounds(wanted, path, rig)
    if total is not None:
        try:
            precision = until_for_total(total, _foreseen(wanted, rig, part, described))
        except PrecisionError as error:
            raise click.UsageError(str(error)) from error
    if precision is not None:
        wanted = with_precision(wanted, precision)
    pools: dict[str, Pool] = {}
    if _asks_precision(wanted):
        from tester.cli.history import repeatability
        from tester.store.run_folders import RUNS

        compounds = dict.fromkeys(one.compound for one in wanted.specimens)
        pools = repeatability(out or RUNS, compounds, simulated=rig.simulated)
    estimator = part.estimator(rig, s_percents(pools))
    with _nothing_collected():
        steps = part.expand(wanted, rig, estimator)
        figures = estimate(steps, estimator)
        merged = list(merged_of(wanted))
        found = foreseen(steps, figures.steps, estimator, known_slopes(steps, described))
        terms = part.terms(rig)
        if as_json:
            uncertainty = foreseen_fields(found, estimator, terms)
            sys.stdout.writelines(json_chunks(steps, figures, part, merged, uncertainty))
            return
        sys.stdout.writelines(f"{line}\n" for line in lines(steps, figures, part))
        sys.stdout.writelines(f"{one.sentence()}\n" for one in merged)
        sys.stdout.writelines(f"{line}\n" for line in foreseen_lines(found, estimator, terms))
        sys.stdout.writelines(f"{line}\n" for line in precision_lines(steps, figures, estimator, pools, found))


def _foreseen(recipe: Recipe, rig: Rig, part: RecipePart, described: Mapping[str, CompoundModel]) -> list[Foreseen]:
    """Return what is foreseen of the uncertainty of a recipe's conditions."""
    from tester.inputs.recipe.foreseen import foreseen, known_slopes

    plan, estimator = part.expand(recipe, rig), part.estimator(rig)
    return foreseen(plan, estimator.walk(plan), estimator, known_slopes(plan, described))


def _asks_precision(recipe: Recipe) -> bool:
    """Tell whether a recipe repeats until a repeatability is reached."""
    asked = [grid.until for grid in recipe.grids]
    return any(asked) or (recipe.measure is not None and recipe.measure.until is not None)


@contextmanager
def _nothing_collected() -> Generator[None, None, None]:
    """Keep the garbage collector from looking through a plan, all of which lives on: a third of the time."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


@click.command()
@click.option(
    "--of",
    "what",
    type=click.Choice(["recipe", "compound", "surface"]),
    default="recipe",
    show_default=True,
    help="Which files it is of.",
)
def schema(what: str) -> None:
    """Print the JSON Schema of recipes, or of compounds or surfaces, for editors and other programs."""
    if what != "recipe":
        from tester.base.section import editor_text
        from tester.inputs.materials.material_schema import CompoundModel, SurfaceModel

        click.echo(editor_text(CompoundModel if what == "compound" else SurfaceModel), nl=False)
        return
    from tester import kinds
    from tester.inputs.recipe.recipe_schema import schema_text

    part = kinds.find(kinds.DEFAULT).recipe
    assert part is not None
    click.echo(schema_text(part()), nl=False)


def _fields(problem: Problem) -> dict[str, object]:
    return {
        "file": problem.file,
        "line": problem.line,
        "column": problem.column,
        "message": problem.message,
    }
