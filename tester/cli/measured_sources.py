"""The sources of a fit or a master curve: stored runs and packaged tables, all of one kind of rig."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from tester.cli.options import kind_in, run_folder
from tester.cli.text_table import shown

if TYPE_CHECKING:
    from tester.kinds.kind import Kind

Read = TypeVar("Read")


def of_one_kind(
    names: Sequence[str], packaged: Callable[[Kind, str], Read], stored: Callable[[Kind, Path], Read]
) -> tuple[Kind, list[Read]]:
    """Return the kind of the sources of these names, and what the readers of packaged tables and runs make of each.

    A name that is given twice, or sources of different kinds, are a usage error; a run that cannot be read a
    ClickException.
    """
    from tester.base.source import InvalidSource
    from tester.kinds import packaged_conditions

    if doubled := sorted({name for name in names if names.count(name) > 1}):
        raise click.UsageError(f"{', '.join(doubled)}: named twice, and its conditions would count twice")
    kinds: dict[str, Kind] = {}
    read: list[Read] = []
    for name in names:
        kind = packaged_conditions().get(name)
        try:
            if kind is not None:
                read.append(packaged(kind, name))
            else:
                folder = run_folder(name)
                kind = kind_in(folder)
                read.append(stored(kind, folder))
        except InvalidSource as error:
            raise click.ClickException(f"{name}: {error}") from error
        kinds[kind.name] = kind
    if len(kinds) > 1:
        raise click.UsageError(f"conditions of different kinds of rigs: {', '.join(sorted(kinds))}")
    return next(iter(kinds.values())), read


def print_left_out(left_out: Iterable[tuple[str, str]]) -> None:
    """Print on stderr the conditions that are left out, a line for each reason."""
    reasons: dict[str, list[str]] = {}
    for label, reason in left_out:
        reasons.setdefault(reason, []).append(label)
    for reason, labels in reasons.items():
        click.echo(f"left out ({shown(reason)}): {shown(', '.join(labels))}", err=True)
