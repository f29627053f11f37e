"""`tester materials`: compounds and surfaces as files."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, cast

import click

from tester.cli.options import QuantityType, json_option, print_json

if TYPE_CHECKING:
    from tester.inputs.materials.compound import LoadedCompound
    from tester.inputs.materials.files import DataFile, Findings, Role
    from tester.inputs.materials.library import Library, LibraryEntry
    from tester.inputs.materials.surface_file import LoadedSurface

    Loaded = LoadedCompound | LoadedSurface

recipe_option = click.option(
    "--recipe",
    type=click.Path(exists=True, dir_okay=False, path_type=Path),
    default=None,
    help="As this recipe sees them; else as one in this folder would.",
)
out_option = click.option(
    "-o", "out", type=click.Path(dir_okay=False, path_type=Path), required=True, help="The file to be written."
)
force_option = click.option("--force", is_flag=True, help="Replace the file if there is one.")


@click.group()
def materials() -> None:
    """Compounds and surfaces as files: what there is, what is in it, and from what instruments write."""


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
    roles: tuple[Role, ...] = ("compound", "surface")
    found = [one for role in roles for one in library.entries(role)]
    if as_json:
        print_json([_entry(one) for one in found])
    else:
        for one in found:
            nearest = library.path(one.role, one.name)
            hidden = f" (not used: {nearest} is nearer)" if one.hidden else ""
            click.echo(f"{one.role:9} {one.name:18} {one.path}{hidden}")
    for path in nameless(library):
        click.echo(f"{path}: has no name, so no recipe can mean it", err=True)


def _entry(one: LibraryEntry) -> dict[str, object]:
    return {"role": one.role, "name": one.name, "file": str(one.path), "hidden": one.hidden}


@materials.command()
@click.argument("name")
@recipe_option
@json_option
def show(name: str, recipe: Path | None, as_json: bool) -> None:
    """Show what the file of the compound or the surface NAME holds, its hash, and what is doubtful in it."""
    library = _library(recipe)
    found: list[Loaded] = []
    if library.path("compound", name) is not None:
        found.append(library.compound(name))
    if library.path("surface", name) is not None:
        found.append(library.surface_file(name))
    if not found:
        raise click.UsageError(_unknown(name, library))
    if as_json:
        print_json([_summary(one) for one in found])
        return
    for one in found:
        for line in _lines(one):
            click.echo(line)


def _unknown(name: str, library: Library) -> str:
    from difflib import get_close_matches

    roles: tuple[Role, ...] = ("compound", "surface")
    known = [one.name for role in roles for one in library.entries(role)]
    near = get_close_matches(name, known, 1)
    return f'no compound and no surface is called "{name}"' + (f', did you mean "{near[0]}"?' if near else "")


def _summary(one: Loaded) -> dict[str, object]:
    return {
        "role": one.file.role,
        "name": one.file.name,
        "file": str(one.file.path),
        "sha256": one.file.sha256,
        "data": {data.name: data.sha256 for data in one.file.data},
        "holds": one.holds(),
        "notes": list(one.notes),
        "doubts": [str(doubt) for doubt in one.file.doubts],
        "content": one.model.model_dump(mode="json", by_alias=True, exclude_none=True, exclude={"moduli", "radial"}),
    }


def _lines(one: Loaded) -> Iterable[str]:
    from tester.inputs.materials.compound import LoadedCompound

    yield f"{one.file.name}: {one.file.role}, {one.file.path}"
    yield f"sha256   {one.file.sha256}"
    for data in one.file.data:
        yield f"data     {data.name}, sha256 {data.sha256}"
    yield f"holds    {one.holds()}"
    model = one.model
    for what, text in (("note", model.note), ("source", model.source)):
        if text:
            yield f"{what:8} {text}"
    if isinstance(one, LoadedCompound):
        yield from _of_compound(one)
    for note in one.notes:
        yield f"noted    {note}"
    for doubt in one.file.doubts:
        yield f"doubt    {doubt}"


def _of_compound(one: LoadedCompound) -> Iterable[str]:
    model = one.model
    if model.formulation:
        yield "made of  " + ", ".join(f"{name} {phr:g} phr" for name, phr in model.formulation.items())
    if model.Tg is not None:
        yield f"Tg       {model.Tg:g} degC"
    if model.shear is not None:
        s = model.shear
        yield f"shear    tau_s0 {s.tau_s0 / 1e3:g} kPa, v_c {s.v_c:g} m/s, n {s.n:g}, ratio {s.ratio:g}"
    if model.over_temperature is not None:
        t = model.over_temperature
        law = f"alpha {t.alpha:g}, beta {t.beta:g} 1/K2, gamma {t.gamma:g}, Tm {t.Tm:g} degC"
        yield f"over temperature  {law}; {t.least:g} to {t.most:g} degC"


@materials.command()
@click.argument("file", type=click.Path(path_type=Path))
@json_option
def check(file: Path, as_json: bool) -> int | None:
    """Validate FILE, a compound's or a surface's: every problem at once, and every doubt.

    Which of the two it is, its folder (compounds, surfaces) says, else its keys.
    """
    from tester.base.processes import EXIT_INVALID
    from tester.base.source import InvalidSource

    try:
        found = _load(file)
    except InvalidSource as error:
        if not as_json:
            raise
        print_json({"valid": False, "problems": [str(one) for one in error.problems], "doubts": []})
        return EXIT_INVALID
    if as_json:
        doubts = [str(one) for one in found.file.doubts]
        print_json({"valid": True, "problems": [], "doubts": doubts, "sha256": found.file.sha256})
        return None
    for doubt in found.file.doubts:
        click.echo(f"doubt: {doubt}", err=True)
    click.echo(f"{file}: valid, {found.file.role} {found.file.name}: {found.holds()}")
    return None


def _load(file: Path) -> Loaded:
    from tester.base.source import read_tree
    from tester.inputs.materials.compound import load_compound
    from tester.inputs.materials.material_schema import CompoundModel, SurfaceModel
    from tester.inputs.materials.surface_file import load_surface

    if file.parent.name in ("compounds", "surfaces"):
        return load_surface(file) if file.parent.name == "surfaces" else load_compound(file)
    data = read_tree(file)[0].data
    own = set(SurfaceModel.model_fields) - set(CompoundModel.model_fields)
    return load_surface(file) if isinstance(data, dict) and own & set(data) else load_compound(file)


@materials.group("import")
def import_() -> None:
    """Make a file of ours from what an instrument wrote."""


@import_.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--name", required=True, help="The compound's name in recipes.")
@out_option
@click.option(
    "--columns",
    multiple=True,
    metavar="QUANTITY=HEADING",
    help="Which column is which, e.g. \"E'=Modulus 1\". Quantities: temperature, frequency, omega, E', E'', G', G'', "
    "tan. May be given again.",
)
@click.option(
    "--unit", "units", multiple=True, metavar="HEADING=UNIT", help="A column's unit, e.g. \"Storage Modulus=MPa\"."
)
@click.option("--frequency", type=QuantityType("Hz"), default=None, help="Of every point, where no column says it.")
@click.option("--temperature", type=QuantityType("degC"), default=None, help="Of every point, where no column says it.")
@click.option("--poisson", type=click.FloatRange(0.3, 0.5), default=0.5, show_default=True, help="Makes E of G.")
@force_option
def dma(
    file: Path,
    name: str,
    out: Path,
    columns: Sequence[str],
    units: Sequence[str],
    frequency: float | None,
    temperature: float | None,
    poisson: float,
    force: bool,
) -> None:
    """Make a compound of FILE, a table of moduli (dynamic mechanical analysis) with headings and units.

    What is converted and what is doubtful is said, and stands in the new file.
    """
    from tester.inputs.materials.dma import MAX_BYTES, read_dma
    from tester.inputs.materials.files import Findings, decoded
    from tester.inputs.materials.headings import QUANTITIES, DmaOptions, quantity_named
    from tester.inputs.materials.written import compound_text

    named: dict[str, str] = {}
    for quantity, heading in _pairs(columns, "--columns"):
        if not quantity_named(quantity):
            raise click.BadParameter(f'"{quantity}" is none of {", ".join(QUANTITIES)}', param_hint="--columns")
        named[quantity_named(quantity)] = heading
    options = DmaOptions(named, dict(_pairs(units, "--unit")), frequency, temperature, poisson)
    found = Findings(str(file))
    data = _read(file, MAX_BYTES)
    table = read_dma(decoded(data.content), options, found)
    _tell(found)
    _write(out, compound_text(name, table, data, found), force)
    click.echo(f"{table.describe()}", err=True)
    _check_written(out)


@import_.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--name", default="", help="The surface's name in recipes (default: the file's).")
@out_option
@click.option("--pixel", type=QuantityType("m"), default=None, help="Distance from point to point, e.g. 1um.")
@click.option("--unit", type=click.Choice(["nm", "um", "mm", "m"]), default=None, help="Of the heights.")
@click.option("--detrend", type=click.Choice(["plane", "mean"]), default="plane", show_default=True,
              help="What is taken off first.")  # fmt: skip
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
    found = Findings(str(file))
    data = _read(file, MAX_BYTES)
    try:
        heights = read_scan(file, data.content, ScanOptions(pixel, unit, way), found)
    except MissingExtraError as error:
        raise click.ClickException(str(error)) from error
    spectrum = spectrum_of(heights, way, found)
    _tell(found)
    _write(out, surface_text(name or file.stem, spectrum, data, found), force)
    _check_written(out)


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


def _tell(found: Findings) -> None:
    for note in found.notes:
        click.echo(f"noted: {note}", err=True)
    for doubt in found.doubts:
        click.echo(f"doubt: {doubt}", err=True)


def _write(out: Path, text: str, force: bool) -> None:
    from tester.base.source import MAX_BYTES
    from tester.base.trouble import in_words

    if len(text.encode()) > MAX_BYTES:
        told = f"{out} would be larger than {MAX_BYTES // 1024} kB: keep the table in its file beside the compound's"
        raise click.UsageError(f"{told} (moduli: {{file: {{name: ...}}}})")
    try:
        with out.open("w" if force else "x", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
    except FileExistsError as error:
        raise click.UsageError(f"{out} exists already; --force replaces it") from error
    except OSError as error:
        raise click.UsageError(f"{out} cannot be written: {in_words(error)}") from error


def _check_written(out: Path) -> None:
    """Read the new file as everybody will, and say what is doubtful in it."""
    for doubt in _load(out).file.doubts:
        click.echo(f"doubt: {doubt}", err=True)
    click.echo(str(out))
