"""`tester predict`: a friction law's value for one condition."""

from __future__ import annotations

from pathlib import Path

import click

from sim.physics import laws
from sim.physics.friction import MODEL_NAMES, UnknownCompoundError, in_range
from sim.physics.slip import CORNERING, belt_speed_for, caveats, slip_velocity
from sim.physics.slip import predict as model_value
from tester.cli.options import QuantityType, json_option, print_json
from tester.inputs.rig.profiles import extension_law, is_law_file


@click.command()
@click.option(
    "--compound", default=None, help='Compound: "1#", "2#" or "3#", or one that the law or a file knows.'
)
@click.option(
    "--slip",
    type=QuantityType("m/s"),
    required=True,
    help='Sliding speed, of a wheel its speed minus the belt\'s at sideslip 0, e.g. "300 mm/s".',
)
@click.option("--load", type=QuantityType("N"), required=True, help='Normal load, e.g. "200 N".')
@click.option("--temperature", type=QuantityType("degC"), required=True, help='Surface temperature, e.g. "25 degC".')
@click.option("--sideslip", type=QuantityType("deg"), default="0 deg", show_default=True, help="Sideslip angle.")
@click.option("--wheel-speed", type=QuantityType("m/s"), default="0.8 m/s", show_default=True, help="Wheel speed.")
@click.option(
    "--law",
    "--model",
    "law",
    metavar="LAW",
    default="paper",
    show_default=True,
    help="Law of friction: paper (equations 4-9), v2 (a better fit to the same data), wlf_bell, two_bells, power, "
    "arrhenius, persson, greta, the file of a kept law, or one of an installed package.",
)
@click.option("--surface", default="", metavar="NAME", help="Surface, for two_bells, persson and greta.")
@click.option(
    "--area",
    type=QuantityType("mm2"),
    default="100 mm2",
    show_default=True,
    help="Nominal area of contact, for persson and greta: makes a pressure of the load.",
)
@click.option("--components", is_flag=True, help="Also print adhesion and hysteresis, where the law has them.")
@click.option(
    "--table",
    is_flag=True,
    help="Make the table of persson or greta that a simulated track rubs by; exit 1 where it is off by 0.5 % or more.",
)
@json_option
def predict(
    compound: str | None, slip: float, load: float, temperature: float, sideslip: float, wheel_speed: float, law: str,
    surface: str, area: float, components: bool, table: bool, as_json: bool,
) -> int:  # fmt: skip
    """Print the friction coefficient that a law gives for one condition.

    The laws paper and v2 are the thermo-coupled model of Polymers 2024, 16(5), 596, doi 10.3390/polym16050596 (CC BY
    4.0), of a wheel on a belt: with a sideslip angle the slip is the vector between the wheel's plane and the belt's
    travel. The other laws of this program are of a specimen on a track; persson and greta are made of files of a
    compound and a surface (see `tester materials`).

    A law that `tester fit -o` has kept also gives its interval. Where the value is extrapolated, stderr has a warning.
    """
    laws.look_up_with(extension_law)
    try:
        if is_law_file(law):
            return _kept(law, compound, temperature, load, slip, not (sideslip or components or table), as_json)
        if compound is None:
            raise click.UsageError("Missing option '--compound'.")
        of_materials = isinstance(laws.find(law), laws.OfMaterials)
        if of_materials or (law not in MODEL_NAMES and compound not in CORNERING):
            from tester.cli.predict_track import TrackPoint, predict_on_track

            if sideslip:
                raise ValueError(f"--sideslip: law {law} is of a specimen on a track, which goes straight on")
            point = TrackPoint(law, compound, surface, area, temperature, load, slip)
            return predict_on_track(point, components=components, table=table, as_json=as_json)
        if components or table:
            raise ValueError(f"law {law} has neither parts nor a table (--components, --table: persson, greta)")
        _refuse_backwards(slip, wheel_speed)
        point = compound, slip, load, temperature, sideslip, wheel_speed, law
        mu = model_value(*point) if compound in CORNERING else _by_file(*point)
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    if law in MODEL_NAMES and compound in CORNERING:
        for caveat in caveats(compound, slip, load, temperature, sideslip):
            click.echo(f"warning: {caveat}", err=True)
    if as_json:
        print_json({"mu": mu})
    else:
        click.echo(f"{mu:.5f}")
    return 0


def _kept(
    law: str, compound: str | None, temperature: float, load: float, slip: float, plain: bool, as_json: bool
) -> int:
    """Print a kept law's value. Raises ValueError if more is asked of it (not ``plain``)."""
    from tester.cli.predict_kept import predict_kept

    if not plain:
        raise ValueError(f"{law} is a kept law: it has no --sideslip, --components or --table")
    predict_kept(law, compound, temperature, load, slip, as_json=as_json)
    return 0


def _refuse_backwards(slip: float, wheel_speed: float) -> None:
    if slip > wheel_speed:
        raise ValueError(
            f"--slip: {1e3 * slip:g} mm/s at a wheel speed of {wheel_speed:g} m/s needs a belt that runs backwards "
            f"(expected at most {1e3 * wheel_speed:g} mm/s, or a larger --wheel-speed)"
        )


def _by_file(
    compound: str, slip: float, load: float, temperature: float, sideslip: float, wheel_speed: float, law: str
) -> float:
    """Return the coefficient by the law in a compound's file. Raises ValueError, InvalidSource."""
    from sim.physics.wheel_law import wheel_law
    from tester.inputs.materials.setting import law_setting

    found = wheel_law(law, compound, law_setting("", Path("recipe.yaml")))  # the working folder counts as a recipe's
    if found.assumed:
        raise ValueError(f"{UnknownCompoundError(compound)}, or one with law: in its file")
    resultant = slip_velocity(wheel_speed, belt_speed_for(wheel_speed, slip), sideslip)[2]
    in_range(temperature, load, resultant)
    return found.mu(temperature, load, resultant) * found.cornering_factor(sideslip)
