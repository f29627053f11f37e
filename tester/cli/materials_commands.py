"""`tester materials`: compounds and surfaces as files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click

from tester.cli.material_words import lines_of, summary_of
from tester.cli.options import QuantityType, json_option, print_json

if TYPE_CHECKING:
    from tester.base.source import Problem
    from tester.inputs.materials.compound import LoadedCompound
    from tester.inputs.materials.files import DataFile, Findings, Role
    from tester.inputs.materials.library import Library
    from tester.inputs.materials.surface_file import LoadedSurface

    Loaded = LoadedCompound | LoadedSurface

ROLES: tuple[Role, ...] = ("compound", "surface")
recipe_option = click.option(
    "--recipe",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    default=None,
    help="Look beside this recipe first; by default in this folder.",
)
out_option = click.option(
    "-o", "out", type=click.Path(dir_okay=False, path_type=Path), required=True, help="The file to write."
)
force_option = click.option("--force", is_flag=True, help="Replace an existing file.")


@click.group()
def materials() -> None:
    """Compounds and surfaces as files: list, show, draw and check them, or import an instrument's file."""


def _library(recipe: Path | None) -> Library:
    from tester.inputs.materials.library import Library

    return Library.beside(recipe if recipe is not None else Path("recipe.yaml"))


@materials.command("list")
@recipe_option
@json_option
def list_(recipe: Path | None, as_json: bool) -> None:
    """List compounds and surfaces by name, the nearest file first."""
    from tester.inputs.materials.library import nameless

    library = _library(recipe)
    entries = [entry for role in ROLES for entry in library.entries(role)]
    if as_json:
        print_json([{"role": e.role, "name": e.name, "file": str(e.path), "hidden": e.hidden} for e in entries])
    else:
        for entry in entries:
            nearest = library.path(entry.role, entry.name)
            hidden = f" (not used: {nearest} is nearer)" if entry.hidden else ""
            click.echo(f"{entry.role:9} {entry.name:18} {entry.path}{hidden}")
    for path in nameless(library):
        click.echo(f"{path}: has no name, so no recipe can name it", err=True)


@materials.command()
@click.argument("name")
@recipe_option
@json_option
def show(name: str, recipe: Path | None, as_json: bool) -> None:
    """Show the content of the file of the compound or the surface NAME, its hash, and its doubts."""
    loaded = _loaded(name, recipe)
    if as_json:
        print_json([summary_of(material) for material in loaded])
        return
    for material in loaded:
        for line in lines_of(material):
            click.echo(line)


def _loaded(name: str, recipe: Path | None) -> list[Loaded]:
    """Return the compound, the surface, or both of a name; none is a usage error."""
    from difflib import get_close_matches

    library = _library(recipe)
    read = {"compound": library.compound, "surface": library.surface_file}
    loaded: list[Loaded] = [read[role](name) for role in ROLES if library.path(role, name) is not None]
    if not loaded:
        near = get_close_matches(name, [entry.name for role in ROLES for entry in library.entries(role)], 1)
        meant = f', did you mean "{near[0]}"?' if near else ""
        raise click.UsageError(f'no compound and no surface has the name "{name}"{meant}')
    return loaded


@materials.command("draw")
@click.argument("name")
@click.option(
    "-o", "--out", type=click.Path(dir_okay=False, path_type=Path), required=True, help="The figure: .png, .svg, .pdf."
)
@click.option("--temperature", type=QuantityType("degC"), default="20 degC", show_default=True, help="Of a compound.")
@recipe_option
def draw_(name: str, out: Path, temperature: float, recipe: Path | None) -> None:
    """Draw the compound NAME (E', E'', tan delta over the frequency) or the surface NAME (its spectrum), with the
    points of its file.
    """
    from tester.base.plugins import MissingExtraError
    from tester.base.trouble import in_words
    from tester.cli.material_words import lines_of, material_chart
    from tester.report.draw import draw

    loaded = _loaded(name, recipe)
    if len(loaded) > 1:
        raise click.UsageError(f'"{name}" is a compound and a surface; a figure shows one of them')
    try:
        draw(material_chart(loaded[0], temperature), out)
    except (MissingExtraError, ValueError) as error:
        raise click.ClickException(str(error)) from error
    except OSError as error:
        raise click.UsageError(f"{out} cannot be written: {in_words(error)}") from error
    for line in lines_of(loaded[0]):
        if line.startswith(("rough", "waves", "coarse", "fine", "tan peak", "doubt")):
            click.echo(line, err=True)
    click.echo(str(out))


@materials.command()
@click.argument("file", type=click.Path(path_type=Path))
@json_option
def check(file: Path, as_json: bool) -> int | None:
    """Validate FILE, a compound's or a surface's: every problem at once, and every doubt.

    Its folder (compounds, surfaces), else its keys, decide which of the two it is.
    """
    from tester.base.processes import EXIT_INVALID
    from tester.base.source import InvalidSource

    try:
        loaded = _load(file)
    except InvalidSource as error:
        if not as_json:
            raise
        print_json({"valid": False, "problems": [str(problem) for problem in error.problems], "doubts": []})
        return EXIT_INVALID
    if as_json:
        doubts = [str(doubt) for doubt in loaded.file.doubts]
        print_json({"valid": True, "problems": [], "doubts": doubts, "sha256": loaded.file.sha256})
        return None
    _echo(doubts=loaded.file.doubts)
    click.echo(f"{file}: valid, {loaded.file.role} {loaded.file.name}: {loaded.holds()}")
    return None


def _load(file: Path) -> Loaded:
    from tester.base.source import read_tree
    from tester.inputs.materials.compound import load_compound
    from tester.inputs.materials.material_schema import CompoundModel, SurfaceModel
    from tester.inputs.materials.surface_file import load_surface

    of_surface = file.parent.name == "surfaces"
    if not of_surface and file.parent.name != "compounds":
        data = read_tree(file)[0].data
        surface_keys = {*SurfaceModel.model_fields} - {*CompoundModel.model_fields}
        of_surface = isinstance(data, dict) and not surface_keys.isdisjoint(data)
    return load_surface(file) if of_surface else load_compound(file)


@materials.group("import")
def import_() -> None:
    """Make a compound's or a surface's file from an instrument's."""


@import_.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--name", required=True, help="The compound's name in recipes.")
@out_option
@click.option(
    "--columns",
    multiple=True,
    metavar="QUANTITY=HEADING",
    help="A column's heading, e.g. \"E'=Modulus 1\". Quantities: temperature, frequency, omega, E', E'', G', G'', tan. "
    "Repeatable.",
)
@click.option(
    "--unit", "units", multiple=True, metavar="HEADING=UNIT", help="A column's unit, e.g. \"Storage Modulus=MPa\"."
)
@click.option("--frequency", type=QuantityType("Hz"), default=None, help="Of every point, if no column has it.")
@click.option("--temperature", type=QuantityType("degC"), default=None, help="Of every point, if no column has it.")
@click.option("--strain", type=QuantityType("%"), default=None, help="Amplitude, if no column has it, e.g. 0.1%.")
@click.option("--poisson", type=click.FloatRange(0.3, 0.5), default=0.5, show_default=True, help="Converts G to E.")
@force_option
def dma(
    file: Path, name: str, out: Path, columns: Sequence[str], units: Sequence[str], frequency: float | None,
    temperature: float | None, strain: float | None, poisson: float, force: bool,
) -> None:  # fmt: skip
    """Make a compound of FILE, a table of moduli (dynamic mechanical analysis) with headings and units.

    Conversions and doubts are printed, and stored in the new file.
    """
    from tester.inputs.materials.dma import MAX_BYTES, read_dma
    from tester.inputs.materials.files import Findings, decoded
    from tester.inputs.materials.headings import DmaOptions
    from tester.inputs.materials.sweep_facts import fact_words, sweep_facts
    from tester.inputs.materials.written import compound_text

    options = DmaOptions(_named(columns), dict(_pairs(units, "--unit")), frequency, temperature, poisson, strain)
    findings = Findings(str(file))
    data = _read(file, MAX_BYTES)
    table = read_dma(decoded(data.content), options, findings)
    facts = "".join(f"\n{label:9} {words}" for label, words in fact_words(sweep_facts(table)))
    _write(out, compound_text(name, table, data, findings), findings, force, table.describe() + facts)


def _named(columns: Sequence[str]) -> dict[str, str]:
    """Return the headings of --columns by quantity."""
    from tester.inputs.materials.headings import QUANTITIES, quantity_named

    headings: dict[str, str] = {}
    for quantity, heading in _pairs(columns, "--columns"):
        if not quantity_named(quantity):
            raise click.BadParameter(f'"{quantity}" is none of {", ".join(QUANTITIES)}', param_hint="--columns")
        headings[quantity_named(quantity)] = heading
    return headings


@import_.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--name", default="", help="The surface's name in recipes (default: the file's).")
@out_option
@click.option("--pixel", type=QuantityType("m"), default=None, help="Distance from point to point, e.g. 1um.")
@click.option("--unit", type=click.Choice(["nm", "um", "mm", "m"]), default=None, help="Of the heights.")
@click.option("--detrend", type=click.Choice(["plane", "mean"]), default="plane", show_default=True,
              help="Subtracted first.")  # fmt: skip
@force_option
def scan(
    file: Path, name: str, out: Path, pixel: float | None, unit: str | None, detrend: str, force: bool
) -> None:
    """Make a surface of FILE, a map of heights: a matrix as text, or a format of instruments (extra `topography`)."""
    from tester.base.plugins import MissingExtraError
    from tester.inputs.materials.files import Findings
    from tester.inputs.materials.radial import Detrend
    from tester.inputs.materials.surface_scan import MAX_BYTES, ScanOptions, read_scan, spectrum_of
    from tester.inputs.materials.written import surface_text

    way = cast("Detrend", detrend)
    findings = Findings(str(file))
    data = _read(file, MAX_BYTES)
    try:
        heights = read_scan(file, data.content, ScanOptions(pixel, unit, way), findings)
    except MissingExtraError as error:
        raise click.ClickException(str(error)) from error
    spectrum = spectrum_of(heights, way, findings)
    _write(out, surface_text(name or file.stem, spectrum, data, findings), findings, force)


def _read(file: Path, at_most: int) -> DataFile:
    from tester.inputs.materials.files import DataFileError, read_beside

    try:
        return read_beside(file, file.name, at_most)
    except DataFileError as error:
        raise click.UsageError(str(error)) from error


def _pairs(texts: Sequence[str], option: str) -> Iterable[tuple[str, str]]:
    for text in texts:
        left, equals, right = text.rpartition("=") if option == "--unit" else text.partition("=")
        if not equals or not left.strip() or not right.strip():
            raise click.BadParameter(f'"{text}" (expected such as "E\'=Storage Modulus")', param_hint=option)
        yield left.strip(), right.strip()


def _echo(notes: Iterable[str] = (), doubts: Iterable[Problem] = ()) -> None:
    for label, texts in (("noted", notes), ("doubt", doubts)):
        for text in texts:
            click.echo(f"{label}: {text}", err=True)


def _write(out: Path, text: str, findings: Findings, force: bool, summary: str = "") -> None:
    """Write the new file with its conversions and doubts on the screen, and read it back for further doubts."""
    from tester.base.source import MAX_BYTES
    from tester.base.trouble import in_words

    _echo(findings.notes, findings.doubts)
    if len(text.encode()) > MAX_BYTES:
        refusal = f"{out} would be larger than {MAX_BYTES // 1024} kB: keep the table in its file beside the compound's"
        raise click.UsageError(f"{refusal} (moduli: {{file: {{name: ...}}}})")
    try:
        with out.open("w" if force else "x", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
    except FileExistsError as error:
        raise click.UsageError(f"{out} exists already; --force replaces it") from error
    except OSError as error:
        raise click.UsageError(f"{out} cannot be written: {in_words(error)}") from error
    if summary:
        click.echo(summary, err=True)
    _echo(doubts=_load(out).file.doubts)
    click.echo(str(out))
