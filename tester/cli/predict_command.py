"""`tester predict`: the friction model's value for one condition."""

from __future__ import annotations

import click

from sim.physics import laws
from sim.physics.data_range import caveats
from sim.physics.friction import MODEL_NAMES
from sim.physics.slip import predict as model_value
from tester.cli.options import QuantityType, json_option, print_json
from tester.rig.laws import extension_law


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
    metavar="LAW",
    default="paper",
    show_default=True,
    help="Law of friction: paper (equations 4-9), v2 (a better fit to the same data), or one of an installed package.",
)
@json_option
def predict(
    compound: str,
    slip: float,
    load: float,
    temperature: float,
    sideslip: float,
    wheel_speed: float,
    model: str,
    as_json: bool,
) -> None:
    """Print the friction coefficient that the model gives for one condition.

    The model is the thermo-coupled one of Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY 4.0); with a
    sideslip angle the slip is the vector between the wheel's plane and the belt's travel. What the value rests on,
    where it lies outside the paper's data, is said on stderr.
    """
    if slip > wheel_speed:
        raise click.UsageError(
            f"--slip: {1e3 * slip:g} mm/s at a wheel speed of {wheel_speed:g} m/s needs a belt that runs backwards "
            f"(expected at most {1e3 * wheel_speed:g} mm/s, or a larger --wheel-speed)"
        )
    laws.look_up_with(extension_law)
    try:
        mu = model_value(compound, slip, load, temperature, sideslip, wheel_speed, model)
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    if model in MODEL_NAMES:
        for caveat in caveats(compound, slip, load, temperature, sideslip):
            click.echo(f"warning: {caveat}", err=True)
    if as_json:
        print_json({"mu": mu})
    else:
        click.echo(f"{mu:.5f}")
