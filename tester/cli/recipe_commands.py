"""`tester check` and `tester schema`: recipes before anything moves."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

import recipes
from tester.base.processes import EXIT_INVALID
from tester.cli.options import RigChoice, command, json_option, print_json, rig_options

if TYPE_CHECKING:
    from tester.run.run_materials import UsedMaterials


def recipe_file(name_or_path: str) -> tuple[Path, str]:
    """Return a recipe's file and its name in messages; an unknown recipe is a usage error."""
    try:
        path = recipes.find(name_or_path)
    except recipes.UnknownRecipe as error:
        raise click.UsageError(str(error)) from error
    packaged = path.parent == recipes.FOLDER and Path(name_or_path) != path
    return path, f"recipes/{path.name}" if packaged else name_or_path


@command()
@click.argument("recipe")
@rig_options
@json_option
@click.option("--verbose", is_flag=True, help="Also list the files that describe its compounds and its surface.")
def check(recipe: str, rig: RigChoice, as_json: bool, verbose: bool) -> int:
    """Validate RECIPE (a file, or the name of a packaged recipe) against the schema and the rig.

    Every problem at once, as file:line:col: message, and exit code 3. Doubts about the files of its compounds and its
    surface, or about its success on the rig, are warnings.
    """
    from tester.base.source import InvalidSource
    from tester.inputs.recipe.conditions import conditions_of, merged_of
    from tester.inputs.recipe.reference_section import REFERENCE, ReferenceSection
    from tester.run.kind_lookup import checked_recipe, load_rig, recipe_part
    from tester.run.run_materials import used_materials

    path, name = recipe_file(recipe)
    loaded_rig = load_rig(*rig)
    part = recipe_part(loaded_rig)
    try:
        loaded = checked_recipe(path, loaded_rig, name)
        used = used_materials(loaded.recipe, path)
    except InvalidSource as error:
        if not as_json:
            raise
        print_json({"valid": False, "problems": [asdict(problem) for problem in error.problems]})
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
        click.echo(f'{name}: valid on rig "{loaded_rig.name}", {count} conditions{every}')
        for one in merged:
            click.echo(one.sentence())
    rig.remark(loaded_rig)
    return 0


def _materials(used: UsedMaterials) -> Iterator[str]:
    for one in used.files:
        yield f"{one.role} {one.name}: {one.path}, sha256 {one.sha256}"
    for role, what in used.bare:
        yield f"{role} {what}: no file describes it, its name alone is recorded"


@command()
@click.option(
    "--of",
    "what",
    type=click.Choice(["recipe", "compound", "surface", "law"]),
    default="recipe",
    show_default=True,
    help="Files to describe.",
)
def schema(what: str) -> None:
    """Print the JSON Schema of recipes, compounds, surfaces or kept laws, for editors and other programs."""
    from tester.base.validation import editor_text

    if what == "law":
        from tester.inputs.kept_laws.law_schema import KeptLawModel

        click.echo(editor_text(KeptLawModel), nl=False)
        return
    if what != "recipe":
        from tester.inputs.materials.material_schema import CompoundModel, SurfaceModel

        click.echo(editor_text(CompoundModel if what == "compound" else SurfaceModel), nl=False)
        return
    from tester import kinds

    part = kinds.find(kinds.DEFAULT).recipe
    assert part is not None
    click.echo(editor_text(part().model()), nl=False)
