"""`tester new`: write a recipe by five questions; each answer is checked against the rig at once."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import click

from tester.cli.options import rig_option

if TYPE_CHECKING:
    from tester.base.axes import Axis
    from tester.base.source import Problem
    from tester.cli.new_recipe import Draft

Answer = TypeVar("Answer")
_TRIES = 100
"""Refused answers after which the command gives up, so that a script that feeds it nonsense ends."""


@click.command()
@rig_option
@click.option("--compound", "compounds", multiple=True, metavar="NAME", help="A compound; may be given again.")
@click.option(
    "--axis",
    "axes",
    multiple=True,
    metavar="NAME=VALUES",
    help='Values of an axis, e.g. --axis "load=100 N, 200 N". May be given again.',
)
@click.option("--repeats", default="", metavar="N", help="Repeats of each condition.")
@click.option("--name", default="", metavar="TEXT", help="Name of the recipe.")
@click.option(
    "-o",
    "--output",
    type=click.Path(dir_okay=False, path_type=Path),
    default=None,
    metavar="FILE",
    help="File to write (default: from the name).",
)
@click.option("--yes", is_flag=True, help="Ask nothing: take options, and defaults for the rest.")
@click.pass_context
def new(
    ctx: click.Context, rig_name: str, compounds: tuple[str, ...], axes: tuple[str, ...], repeats: str, name: str,
    output: Path | None, yes: bool,
) -> None:  # fmt: skip
    """Write a recipe by five questions: rig, compounds, values of each axis, repeats, name.

    An option answers its question. Each answer is checked against the rig at once. The file passes `tester check`;
    its path is printed. An existing file is never replaced.
    """
    from tester.cli.new_recipe import Draft

    source = ctx.get_parameter_source("rig_name")
    typed = "" if source is click.core.ParameterSource.DEFAULT else rig_name
    ask = _Questions(yes)
    draft = ask("1. Rig: sim, another packaged rig, or a file", "--rig", typed, rig_name, Draft.on)
    values = _by_name(axes, draft)
    ask("2. Compounds, separated by commas", "--compound", ", ".join(compounds), "", draft.with_compounds)
    click.echo("3. Values of each axis, separated by commas", err=True)
    for axis in draft.axes:
        if axis.default == "" and axis.name not in values:
            continue  # a name that recipes may leave out, as of a surface
        _ask_axis(ask, draft, axis, values.get(axis.name, ""))
    ask("4. Repeats of each condition", "--repeats", repeats, "3", draft.with_repeats)
    ask("5. Name of the recipe", "--name", name, draft.suggested_name(), draft.with_name)
    path = output or Path(f"{_slug(draft.name)}.yaml")
    _write(path, draft)


def _ask_axis(ask: _Questions, draft: Draft, axis: Axis, typed: str) -> None:
    default = draft.default_of(axis)
    ask(f"   {draft.hint(axis)}", f"--axis {axis.name}=...", typed, default, lambda text: draft.with_axis(axis, text))


class _Questions:
    """Asks on the terminal, or takes an option's answer. A wrong answer is asked again, a wrong option ends it."""

    def __init__(self, yes: bool) -> None:
        self.yes = yes

    def __call__(self, question: str, option: str, typed: str, default: str, take: Callable[[str], Answer]) -> Answer:
        """Return the result of ``take`` for the answer; ``take`` raises InvalidSource or ValueError for a wrong one."""
        if typed or self.yes:
            if not (typed or default):
                raise click.UsageError(f"{option}: this has no default, so --yes needs it")
            return self._taken(typed or default, take, option)
        for _ in range(_TRIES):
            text = click.prompt(question, default=default or None, err=True)
            try:
                return self._taken(str(text), take, "")
            except click.UsageError as error:
                click.echo(f"   {error.message}", err=True)
        raise click.Abort

    def _taken(self, text: str, take: Callable[[str], Answer], option: str) -> Answer:
        from tester.base.source import InvalidSource

        try:
            return take(text)
        except InvalidSource as error:
            raise click.UsageError(_sentence(option, error.problems)) from error
        except ValueError as error:
            raise click.UsageError(f"{option}: {error}" if option else str(error)) from error


def _sentence(option: str, problems: Sequence[Problem]) -> str:
    messages = "; ".join(dict.fromkeys(problem.message for problem in problems))
    return f"{option}: {messages}" if option else messages


def _by_name(axes: tuple[str, ...], draft: Draft) -> dict[str, str]:
    """Return the values of --axis by name; a name that is no axis of the rig is a usage error."""
    known = [axis.name for axis in draft.axes]
    found: dict[str, str] = {}
    for text in axes:
        name, _, values = text.partition("=")
        if name.strip() not in known or not values.strip():
            raise click.UsageError(f"--axis: expected NAME=VALUES with one of {', '.join(known)}, got {text!r}")
        found[name.strip()] = values
    return found


def _slug(name: str) -> str:
    return re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-") or "recipe"


def _write(path: Path, draft: Draft) -> None:
    from tester.base.trouble import in_words

    doubts = draft.checked()
    try:
        with path.open("x", encoding="utf-8", newline="\n") as stream:
            stream.write(draft.text())
    except FileExistsError as error:
        raise click.UsageError(f"{path} exists already; choose another with -o FILE") from error
    except OSError as error:
        raise click.UsageError(f"the recipe cannot be written: {in_words(error)}") from error
    for doubt in doubts:
        click.echo(f"warning: {doubt.message}", err=True)
    on = "" if draft.source == "sim" else f" --rig {shlex.quote(draft.source)}"
    click.echo(f"next: tester plan {path}{on}, then tester run {path}{on}", err=True)
    click.echo(str(path))
