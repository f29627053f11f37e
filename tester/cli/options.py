"""Options that several commands share, and the parameter type for quantities."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from tester.base.units import UnitError, parse

if TYPE_CHECKING:
    from tester.inputs.rig import Rig


Decorated = TypeVar("Decorated", bound=Callable[..., Any])


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


def rig_option(command: Decorated) -> Decorated:
    """Add --rig: the rig's file, or sim."""
    return click.option(
        "--rig",
        "rig_name",
        default="sim",
        show_default=True,
        metavar="RIG",
        help="Rig file, or sim for the simulated rig.",
    )(command)


def set_option(command: Decorated) -> Decorated:
    """Add --set KEY=VALUE, any number of times."""
    return click.option(
        "--set",
        "overrides",
        multiple=True,
        metavar="KEY=VALUE",
        help="Replace one key of the rig file, e.g. sim.noise=0. May be given again.",
    )(command)


def risk_option(command: Decorated) -> Decorated:
    """Add --accept-risk REASON."""
    return click.option(
        "--accept-risk",
        "accept_risk",
        default="",
        metavar="REASON",
        help="Why safety keys of the rig may be looser than they should be; stored and shown with the run.",
    )(command)


def seed_option(command: Decorated) -> Decorated:
    """Add --seed: where all randomness of the simulated rig comes from."""
    return click.option(
        "--seed",
        default=0,
        show_default=True,
        metavar="N",
        type=click.IntRange(0, 2**63 - 1),
        help="Seed of the simulated rig.",
    )(command)


def json_option(command: Decorated) -> Decorated:
    """Add --json: data for programs on stdout."""
    return click.option("--json", "as_json", is_flag=True, help="Print JSON on stdout.")(command)


def print_json(data: object) -> None:
    """Print data as one line of JSON, numbers in full precision; not-a-number is refused (ValueError)."""
    click.echo(json.dumps(data, ensure_ascii=False, allow_nan=False))


def say_other_settings(rig_name: str, rig: Rig) -> None:
    """Say on stderr which lines are set otherwise than the profiles of their devices say."""
    from tester.inputs.rig.checks import other_settings

    for text in other_settings(rig):
        click.echo(f"{rig_name}: warning: {text}", err=True)


def say_packaged_keys(rig_name: str, overrides: Sequence[str]) -> None:
    """Say on stderr for which keys the packaged value counts, because the rig file does not have them."""
    from tester.kinds import packaged_keys

    keys = packaged_keys(rig_name, overrides)
    if keys:
        click.echo(f"{rig_name}: packaged values count for {', '.join(keys)}", err=True)
        click.echo(f"{rig_name}: `tester rig upgrade {rig_name}` writes them in", err=True)


def run_folder(name: str) -> Path:
    """Return the folder of a run; a name that is none is a usage error."""
    from tester.store.record_schema import StoreError
    from tester.store.run_folders import find_run

    try:
        return find_run(name)
    except StoreError as error:
        raise click.UsageError(str(error)) from error
