"""`tester rig init`, `tester rig show`, `tester rig keys` and `tester rig upgrade`."""

from __future__ import annotations

from pathlib import Path

import click

from tester.cli.options import ReportedGroup, RigChoice, json_option, print_json, rig_options
from tester.kinds import DEFAULT


@click.group(cls=ReportedGroup)
def rig() -> None:
    """Write, show or complete a rig file."""


@rig.command()
@click.argument("file", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--force", is_flag=True, help="Replace the file if there is one.")
@click.option("--kind", default=DEFAULT, show_default=True, metavar="KIND", help="Kind of rig.")
@click.option("--like", default="", metavar="RIG", help="Packaged rig of that kind; else its first.")
def init(file: Path, force: bool, kind: str, like: str) -> None:
    """Write a commented rig file for a real machine to FILE, to be completed there."""
    from tester.kinds import UnknownKindError, find, hardware_text

    try:
        text = hardware_text(kind, like)
    except UnknownKindError as error:
        raise click.UsageError(str(error)) from error
    except KeyError as error:
        known = ", ".join(find(kind).rigs)
        raise click.UsageError(f"no packaged rig of the kind {kind} is called {like} (expected {known})") from error
    try:
        with file.open("w" if force else "x", encoding="utf-8", newline="\n") as stream:
            stream.write(text)
    except FileExistsError as error:
        raise click.UsageError(f"{file} exists already; --force replaces it") from error
    except OSError as error:
        from tester.base.trouble import in_words

        raise click.UsageError(f"the rig file cannot be written: {in_words(error)}") from error
    click.echo(str(file))


@rig.command()
@rig_options
@json_option
def show(rig: RigChoice, as_json: bool) -> None:
    """Check a rig file and print it with everything resolved."""
    from tester.kinds import load_rig

    config = load_rig(*rig)
    if as_json:
        print_json(config.tree)
    else:
        click.echo(config.text, nl=False)
    rig.remark(config)


@rig.command()
@click.option("--kind", default=DEFAULT, show_default=True, metavar="KIND", help="Kind of rig.")
def keys(kind: str) -> None:
    """Print every key of a kind's rig file with its class: bounded, held against another, or free.

    With the reason, or what contradicts a wrong value.
    """
    from tester.inputs.rig.key_table import classed, in_words
    from tester.kinds import UnknownKindError, find

    try:
        rig_class = find(kind).rig()
    except UnknownKindError as error:
        raise click.UsageError(str(error)) from error
    for names, key_class in classed(rig_class):
        text, because = in_words(key_class)
        click.echo(f"{', '.join(names)}: {text}; {because}")


@rig.command()
@click.argument("file", type=click.Path(dir_okay=False, path_type=Path))
def upgrade(file: Path) -> None:
    """Write the keys that FILE lacks into it, with the packaged values and their comments.

    Nothing else of the file changes.
    """
    from tester.kinds import upgrade as complete

    try:
        keys = complete(file)
    except OSError as error:
        raise click.UsageError(f"{file} cannot be written: {error.strerror}") from error
    click.echo(f"{file}: written: {', '.join(keys)}" if keys else f"{file}: has every key")
