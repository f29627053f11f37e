"""`tester predict`: the friction model's value for one condition."""

from __future__ import annotations

import click

from sim.parameters import MODEL_NAMES, FrictionModelName
from sim.slip import predict as model_value
from tester.cli.options import QuantityType, json_option, print_json


@click.command()
@click.option("--compound", required=True, help='Compound with a friction model: "1#", "2#" or "3#".')
@click.option(
    "--slip",
    type=QuantityType("m/s"),
    required=True,
    help='Slip velocity: wheel speed minus belt speed at sideslip 0, e.g. "300 mm/s".',
)
@click.option("--load", type=QuantityType("N"), required=True, help='Normal load, e.g. "200 N".')
@click.option("--temperature", type=QuantityType("degC"), required=True, help='Surface temperature, e.g. "25 degC".')
@click.option("--sideslip", type=QuantityType("deg"), default="0 deg", show_default=True, help="Sideslip angle.")
@click.option("--wheel-speed", type=QuantityType("m/s"), default="0.8 m/s", show_default=True, help="Wheel speed.")
@click.option(
    "--model",
    type=click.Choice(MODEL_NAMES),
    default="paper",
    show_default=True,
    help="The paper's equations 4-9, or the better fit to the same data.",
)
@json_option
def predict(
    compound: str,
    slip: float,
    load: float,
    temperature: float,
    sideslip: float,
    wheel_speed: float,
    model: FrictionModelName,
    as_json: bool,
) -> None:
    """Print the friction coefficient that the model gives for one condition.

    The model is the thermo-coupled one of Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY 4.0); with a
    sideslip angle the slip is the vector between the wheel's plane and the belt's travel.
    """
    try:
        mu = model_value(compound, slip, load, temperature, sideslip, wheel_speed, model)
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    if as_json:
        print_json({"mu": mu})
    else:
        click.echo(f"{mu:.5f}")
