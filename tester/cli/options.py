"""Options that several commands share, and a command whose errors a person can mend."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import click

from tester.base.trouble import MisuseError, TroubleError
from tester.base.units import UnitError, parse

if TYPE_CHECKING:
    from tester.inputs.rig import Rig
    from tester.service.address import Address

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


class ReportedCommand(click.Command):
    """A command that prints the message of an error that a person can correct, and exits with 1 or 2, as click does."""

    def invoke(self, ctx: click.Context) -> object:
        try:
            return super().invoke(ctx)
        except MisuseError as error:
            raise click.UsageError(str(error), ctx) from error
        except TroubleError as error:
            from tester.cli.text_table import shown

            raise click.ClickException("\n".join(map(shown, str(error).split("\n")))) from error


class ReportedGroup(click.Group):
    """A group of such commands."""

    command_class = ReportedCommand


def command(name: str | None = None) -> Callable[[Callable[..., object]], click.Command]:
    """Return the decorator that makes a ReportedCommand of a function."""
    return click.command(name, cls=ReportedCommand)


class QuantityType(click.ParamType[float]):
    """A number with a unit, e.g. "300 mm/s"; the command gets the value in ``unit``."""

    def __init__(self, unit: str) -> None:
        """``unit`` is one of the table in tester.base.units."""
        self.name = "quantity"
        self.unit = unit

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Return the value in the unit; a wrong or missing unit is a usage error that names those accepted."""
        if isinstance(value, int | float):
            return float(value)  # a default, already in the unit
        try:
            return parse(str(value), self.unit)
        except UnitError as error:
            self.fail(str(error), param, ctx)


class SpeedType(click.ParamType[float | None]):
    """Rig seconds per second: a number above 0, or max, which is None."""

    name = "speed"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float | None:
        """Return the number, None for max; any other text is a usage error."""
        from tester.base.units import rig_speed

        try:
            return rig_speed(str(value))
        except ValueError as error:
            self.fail(str(error), param, ctx)


class RigChoice(NamedTuple):
    """The rig of a command, as ``load_rig(*choice)`` takes it: its file or name, replaced keys, accepted risk."""

    name: str
    overrides: tuple[str, ...]
    accept_risk: str

    def remark(self, rig: Rig) -> None:
        """Print on stderr the keys that take the packaged value, and lines set otherwise than their devices' profiles
        say.
        """
        from tester.inputs.rig.checks import other_settings
        from tester.kinds import packaged_keys

        if keys := packaged_keys(self.name, self.overrides):
            click.echo(f"{self.name}: packaged values count for {', '.join(keys)}", err=True)
            click.echo(f"{self.name}: `tester rig upgrade {self.name}` writes them in", err=True)
        for text in other_settings(rig):
            click.echo(f"{self.name}: warning: {text}", err=True)


rig_option = click.option(
    "--rig", "rig_name", default="sim", show_default=True, metavar="RIG",
    help="Rig file, or sim for the simulated rig.",
)  # fmt: skip
set_option = click.option(
    "--set", "overrides", multiple=True, metavar="KEY=VALUE",
    help="Replace one key of the rig file, e.g. sim.noise=0. May be given again.",
)  # fmt: skip
risk_option = click.option(
    "--accept-risk", default="", metavar="REASON",
    help="Why safety keys of the rig may be looser than they should be; stored and shown with the run.",
)  # fmt: skip
seed_option = click.option(
    "--seed", default=0, show_default=True, metavar="N", type=click.IntRange(0, 2**63 - 1),
    help="Seed of the simulated rig.",
)  # fmt: skip
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON on stdout.")
yes_option = click.option(
    "--yes", is_flag=True, help="Answer prompts with yes, but those that ask a person to a real rig."
)
hands_option = click.option(
    "--hands", default="", metavar="HOST:PORT",
    help="Simulated machine in another process (`tester sim --control`): its hands do what prompts ask for.",
)  # fmt: skip
operator_option = click.option("--operator", default="", metavar="NAME", help="Who runs the test; stored with the run.")
lapse_option = click.option(
    "--speed", type=SpeedType(), default="max", metavar="max|X",
    help="Simulated rig: as fast as it goes, or X times real time; in another process, as fast as it lives there.",
)  # fmt: skip
bus_log_option = click.option(
    "--bus-log", default=None, metavar="DIR", type=click.Path(path_type=Path),
    help="Write every CAN and Modbus frame into this folder.",
)  # fmt: skip
theme_option = click.option("--theme", type=click.Choice(["dark", "light", "16"]), default=None, help="Colours.")
ascii_option = click.option("--ascii", "plain", is_flag=True, help="Draw with ASCII characters only.")


def runs_option(text: str) -> Callable[[Decorated], Decorated]:
    """Return --out, the folder of the runs; ``text``: its help."""
    folder = click.Path(path_type=Path)
    return click.option("--out", default=Path("runs"), show_default=True, metavar="DIR", type=folder, help=text)


def rig_options(function: Callable[..., Any]) -> Callable[..., Any]:
    """Add --rig, --set and --accept-risk, which arrive as one RigChoice named ``rig``."""

    @wraps(function)
    def chosen(
        *arguments: object, rig_name: str, overrides: tuple[str, ...], accept_risk: str, **others: object
    ) -> object:
        return function(*arguments, rig=RigChoice(rig_name, overrides, accept_risk), **others)

    return rig_option(set_option(risk_option(chosen)))


def print_json(data: object) -> None:
    """Print data as one line of JSON, numbers in full precision; not-a-number is refused (ValueError)."""
    click.echo(json.dumps(data, ensure_ascii=False, allow_nan=False))


connect_option = click.option(
    "--connect", "address", default="", metavar="URL", help="The service: unix:PATH or ws://127.0.0.1:PORT."
)


def address_named(text: str) -> Address | None:
    """Return the address that was typed, None for the user's own service; raises AddressError."""
    from tester.service.address import address_of

    return address_of(text) if text else None


def name_here(person: str = "") -> str:
    """Return this command's name at the service; ``person``: who gives it, "" for the user."""
    from tester.base.who import who_here

    return who_here("command", person)
