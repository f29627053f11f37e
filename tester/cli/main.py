"""The `tester` command.

The root group reads the table of commands (tester.cli.command_table) and imports a command's module only when that
command is called: `tester --help` loads nothing but click (docs/decisions/0009).
"""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import click

from tester import __version__
from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_INTERRUPTED, EXIT_INVALID, EXIT_READER_GONE
from tester.cli.command_table import SECTIONS, CommandGroup, Listed


class ReaderGoneError(Exception):
    """The reader of a command's output has closed it."""


class LazyGroup(click.Group):
    """A click group whose commands are imported when they are called."""

    def __init__(
        self,
        name: str | None = None,
        *,
        sections: Mapping[str, Mapping[str, Listed]] = SECTIONS,
        **settings: Any,
    ) -> None:
        """``sections``: its commands by the headings of its help page; ``settings`` are those of click.Group."""
        super().__init__(name, **settings)
        self.sections = sections
        self.entries = {name: entry for listed in sections.values() for name, entry in listed.items()}

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the command names in the order of the help page."""
        return list(self.entries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return a command; None if there is no such name."""
        entry = self.entries.get(cmd_name)
        if entry is None:
            return None
        if isinstance(entry, CommandGroup):
            return LazyGroup(cmd_name, sections={"Commands": entry.commands}, help=entry.help)
        command: object = getattr(import_module(f"tester.cli.{entry.module}"), entry.attribute)
        if not isinstance(command, click.Command):
            raise TypeError(f"{entry.module}.{entry.attribute} is not a click command")
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the named command; an unknown name is a usage error that suggests the nearest."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            near = nearest(args[0], self.entries)
            meant = f" Did you mean {near}?" if near else ""
            raise click.UsageError(f"{error.message}{meant}", ctx) from error

    def invoke(self, ctx: click.Context) -> object:
        """Carry out the command; a reader that is gone is reported here: click would end with 1."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            raise ReaderGoneError from error

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands' help lines without importing the commands."""
        widest = max(map(len, self.entries))
        for title, listed in self.sections.items():
            with formatter.section(title):
                formatter.write_dl([(name.ljust(widest), entry.help) for name, entry in listed.items()])


def nearest(typed: str, entries: Mapping[str, Listed]) -> str:
    """Return the command that a mistyped word probably means, also one inside a group; "" if none is near."""
    from difflib import get_close_matches

    inside = {
        name: f"{group} {name}"
        for group, entry in entries.items()
        if isinstance(entry, CommandGroup)
        for name in entry.commands
    }
    near = get_close_matches(typed, [*entries, *inside], 1)
    return inside.get(near[0], near[0]) if near else ""


@click.group(
    cls=LazyGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="stdout is data, stderr is messages. Exit codes: 0 done, 1 run failed, 2 usage, 3 invalid recipe or rig "
    "file, 4 rig unreachable, 5 tripped or stopped, 6 incomplete, 130 interrupted, "
    "141 the reader of the output is gone.",
)
@click.version_option(__version__, message="%(prog)s %(version)s")
@click.pass_context
def root(ctx: click.Context) -> None:
    """Run friction tests of rubber from recipes, on a rig or on its digital twin.

    Without a command: what you can do next in this folder.
    """
    if ctx.invoked_subcommand is None:
        from tester.cli.next_steps import lines

        click.echo("\n".join(lines(Path())))


def _invalid_source() -> type[Exception]:
    """Return the exception of an invalid recipe or rig file.

    An `except` clause evaluates its class only once something was raised, so a run of a command that reads no file
    never imports the loader.
    """
    from tester.base.source import InvalidSource

    return InvalidSource


def _prepare_streams() -> None:
    """Let the standard streams write every character, whatever the locale.

    A redirected stream is UTF-8; a terminal that does not know a character (LANG=C) shows a question mark. A closed
    stream is replaced by the null device: otherwise the next opened file would take its descriptor.
    """
    for name in ("stdin", "stdout", "stderr"):
        stream: object = getattr(sys, name)
        if stream is None:
            setattr(sys, name, open(os.devnull, "r" if name == "stdin" else "w", encoding="utf-8"))  # noqa: SIM115, PTH123
        elif isinstance(stream, io.TextIOWrapper) and name != "stdin":
            if stream.isatty():
                stream.reconfigure(errors="replace")
            else:
                stream.reconfigure(encoding="utf-8", errors="surrogateescape")


def invoke(arguments: list[str] | None = None) -> int:
    """Run one command line and return its exit code; a command returns its own code or None for 0."""
    try:
        result: object = root.main(args=arguments, prog_name="tester", standalone_mode=False)
    except click.ClickException as error:
        error.show()
        return error.exit_code
    except click.Abort:
        click.echo("interrupted", err=True)
        return EXIT_INTERRUPTED
    except ReaderGoneError:
        return EXIT_READER_GONE
    except _invalid_source() as error:
        click.echo(str(error), err=True)
        return EXIT_INVALID
    except OSError as error:
        from tester.base.trouble import in_words

        click.echo(f"Error: {in_words(error)}", err=True)
        return EXIT_FAILED
    return result if isinstance(result, int) else EXIT_DONE


def _flushed(code: int) -> int:
    """Return the exit code once everything is written; output for a reader that is gone is dropped."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except BrokenPipeError:
            code = code or EXIT_READER_GONE
        except OSError as error:
            from tester.base.trouble import in_words

            code = code or EXIT_FAILED
            if stream is sys.stdout:
                click.echo(f"Error: the output is not complete: {in_words(error)}", err=True)
        else:
            continue
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, stream.fileno())  # the interpreter flushes once more at its end
        os.close(nothing)
    return code


def main() -> None:
    """Entry point of the console script."""
    _prepare_streams()
    sys.exit(_flushed(invoke()))
