"""The `tester` command.

The root group knows each command's module, attribute and one line of help as text, and imports the module only when
that command is called: `tester --help` loads nothing but click (docs/decisions/0009).
"""

from __future__ import annotations

import io
import os
import sys
from importlib import import_module
from typing import NamedTuple

import click

from tester import __version__
from tester.base.exits import EXIT_DONE, EXIT_FAILED, EXIT_INTERRUPTED, EXIT_INVALID, EXIT_READER_GONE


class CommandEntry(NamedTuple):
    """Where a command lives and what the root help says of it."""

    module: str
    attribute: str
    help: str


COMMANDS: dict[str, CommandEntry] = {
    "check": CommandEntry("tester.cli.recipe_commands", "check", "Validate a recipe; every problem at once."),
    "plan": CommandEntry("tester.cli.recipe_commands", "plan", "List the steps of a recipe, with their durations."),
    "run": CommandEntry("tester.cli.run_command", "run", "Run a recipe on a rig, simulated unless told."),
    "sweep": CommandEntry("tester.cli.sweep_command", "sweep", "Run a recipe for many seeds and rig parameters."),
    "resume": CommandEntry("tester.cli.resume_command", "resume", "Go on with an interrupted run."),
    "tui": CommandEntry("tester.cli.tui_command", "tui", "The operator's screen."),
    "replay": CommandEntry("tester.cli.replay_command", "replay", "The screens over a stored run."),
    "serve": CommandEntry("tester.cli.service_commands", "serve", "Own the rig and serve its screens and commands."),
    "status": CommandEntry("tester.cli.service_commands", "status", "Say what the rig is doing."),
    "hold": CommandEntry("tester.cli.service_commands", "hold", "HOLD: lift and wait, keep the temperature."),
    "release": CommandEntry("tester.cli.service_commands", "release", "End a HOLD."),
    "ack": CommandEntry("tester.cli.service_commands", "ack", "Acknowledge alarms; nothing moves by it."),
    "stop": CommandEntry("tester.cli.service_commands", "stop", "STOP the rig."),
    "runs": CommandEntry("tester.cli.runs_command", "runs", "List the runs that are stored."),
    "show": CommandEntry("tester.cli.result_commands", "show", "Show what a run holds."),
    "exclude": CommandEntry("tester.cli.exclude_command", "exclude", "Leave a repeat out of the means, with a reason."),
    "include": CommandEntry("tester.cli.exclude_command", "include", "Take an excluded repeat into the means again."),
    "compare": CommandEntry("tester.cli.compare_command", "compare", "Hold two runs' conditions against each other."),
    "verify": CommandEntry("tester.cli.verify_command", "verify", "Check that a run is as it was left."),
    "export": CommandEntry("tester.cli.result_commands", "export", "Write a run's results as a table."),
    "fit": CommandEntry("tester.cli.fit_command", "fit", "Fit a law of friction to measured conditions."),
    "paper": CommandEntry("tester.cli.paper_command", "paper", "Hold the papers against their data and the laws."),
    "components": CommandEntry(
        "tester.cli.components_command", "components", "Adhesion and hysteresis: dry less wet."
    ),
    "master": CommandEntry("tester.cli.master_command", "master", "Put friction on one curve over aT v, if it is one."),
    "figure": CommandEntry("tester.cli.figure_command", "figure", "Draw a run's results."),
    "report": CommandEntry("tester.cli.report_command", "report", "Write a run's results as a page to send and print."),
    "slip-ring": CommandEntry("tester.cli.slip_ring_command", "slip_ring", "Errors of the slip ring, and their trend."),
    "predict": CommandEntry("tester.cli.predict_command", "predict", "The friction model's value for one condition."),
    "sim": CommandEntry("tester.cli.sim_command", "sim", "A simulated rig in real time, on CAN and Modbus."),
    "rig": CommandEntry("tester.cli.rig_commands", "rig", "Write or show a rig file."),
    "doctor": CommandEntry("tester.cli.doctor_command", "doctor", "Look at a rig: what is wrong, and what to do."),
    "commission": CommandEntry(
        "tester.cli.commission_command", "commission", "Guide a new rig to its first trusted coefficient."
    ),
    "eds": CommandEntry("tester.cli.eds_command", "eds", "Hold a drive's data sheet against what an axis needs."),
    "sdo": CommandEntry("tester.cli.device_commands", "sdo", "Read an object of a CANopen node, or write one."),
    "params": CommandEntry("tester.cli.device_commands", "params", "What devices are set to: dump it, or compare it."),
    "record": CommandEntry("tester.cli.record_command", "record", "Write down the frames of live wires."),
    "materials": CommandEntry("tester.cli.materials_commands", "materials", "Compounds and surfaces as files."),
    "schema": CommandEntry(
        "tester.cli.recipe_commands", "schema", "Print the JSON Schema of recipes, compounds or surfaces."
    ),
}
"""The commands in the order of the help page. A test holds every entry against the module it names."""


class ReaderGoneError(Exception):
    """What a command writes to has been closed at its other end."""


class LazyGroup(click.Group):
    """A click group whose commands are imported when they are called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the command names in the order of the help page."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Import and return one command, None where there is no such name."""
        entry = COMMANDS.get(cmd_name)
        if entry is None:
            return None
        command: object = getattr(import_module(entry.module), entry.attribute)
        if not isinstance(command, click.Command):
            raise TypeError(f"{entry.module}.{entry.attribute} is not a click command")
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command that is meant; a name that is none is a usage error that names the nearest."""
        try:
            return super().resolve_command(ctx, args)
        except click.UsageError as error:
            from difflib import get_close_matches

            near = get_close_matches(args[0], COMMANDS, 1)
            meant = f" Did you mean {near[0]}?" if near else ""
            raise click.UsageError(f"{error.message}{meant}", ctx) from error

    def invoke(self, ctx: click.Context) -> object:
        """Carry out the command; a reader that is gone is ours to tell, click would end with 1."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError as error:
            raise ReaderGoneError from error

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the commands' help lines without importing the commands."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, entry.help) for name, entry in COMMANDS.items()])


@click.group(
    cls=LazyGroup,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="stdout is data, stderr is messages. Exit codes: 0 done, 1 run failed, 2 usage, 3 invalid recipe or rig "
    "file, 4 rig unreachable, 5 tripped or stopped, 6 incomplete, 130 interrupted, "
    "141 nobody reads the output any more.",
)
@click.version_option(__version__, message="%(prog)s %(version)s")
def root() -> None:
    """Run friction tests of rubber wheels from recipes, on a rig or on its digital twin."""


def _invalid_source() -> type[Exception]:
    """Return the exception of an invalid recipe or rig file.

    An `except` clause evaluates its class only once something was raised, so a run of a command that reads no file
    never imports the loader.
    """
    from tester.base.source import InvalidSource

    return InvalidSource


def _prepare_streams() -> None:
    """Let every character of a table's header and of a file's name go out, whatever the locale.

    A redirected stream is UTF-8; a terminal that does not know a character (LANG=C) shows a question mark. A closed
    stream leads nowhere: without that, a file that is opened would stand in its place.
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
    """Return the exit code once everything is written; what is left for a reader that is gone is dropped."""
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
