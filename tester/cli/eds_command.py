"""`tester bus eds`: why a drive with this data sheet would be refused, and which functions it would lack."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.cli.options import json_option, print_json

if TYPE_CHECKING:
    from drivers.axis import AxisConfig
    from drivers.canopen.data_sheet import DataSheet
    from drivers.sheet_check import SheetVerdict


@click.command()
@click.argument("file", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--profile", default="", metavar="NAME", help="Drive profile, or a path; else the one of the maker.")
@click.option("--rig", "rig_name", default="", metavar="RIG", help="Rig file (or sim) whose axes are meant.")
@click.option("--axis", default="", metavar="AXIS", help="With --rig: this axis only.")
@json_option
def eds(file: Path, profile: str, rig_name: str, axis: str, as_json: bool) -> int:
    """List every reason to refuse a drive with the data sheet FILE (EDS or DCF), without the drive.

    It also lists missing functions, and what is lost by each. Without --rig three axes are checked against it: one
    of speed, one that presses and carries the safety inputs, one of position. Exit code 1 where one is refused.
    """
    from drivers.canopen.data_sheet import read_data_sheet
    from drivers.sheet_check import check_sheet

    if axis and not rig_name:
        raise click.UsageError("--axis needs --rig")
    try:
        sheet = read_data_sheet(file)
        axes = _axes_of(rig_name, axis, profile) if rig_name else _usual_axes(profile or _makers(sheet))
    except ValueError as error:  # an unreadable sheet or profile, or an axis that the profile cannot have
        raise click.UsageError(str(error)) from error
    verdicts = {name: check_sheet(config, sheet) for name, config in axes.items()}
    if as_json:
        print_json({
            "file": str(file),
            "device": sheet.title,
            "axes": {
                name: {
                    "profile": axes[name].profile, "refused": one.refused, "without": one.without, "noted": one.noted,
                }
                for name, one in verdicts.items()
            },
        })  # fmt: skip
    else:
        click.echo(f"{file.name}: {sheet.title}, vendor 0x{sheet.vendor_id:08X}, product 0x{sheet.product_code:08X}")
        for name, one in verdicts.items():
            _say(name, axes[name].profile, one)
    return EXIT_FAILED if any(one.refused for one in verdicts.values()) else EXIT_DONE


def _say(name: str, profile: str, verdict: SheetVerdict) -> None:
    head = f"refused, for {len(verdict.refused)} reasons" if verdict.refused else "would be connected"
    click.echo(f"\n{name} with the profile {profile}: {head}")
    for word, lines in (("refused", verdict.refused), ("without", verdict.without), ("note", verdict.noted)):
        for line in lines:
            click.echo(f"  {word}: {line.removeprefix('no ')}" if word == "without" else f"  {word}: {line}")


def _makers(sheet: DataSheet) -> str:
    """Return the maker's profile: of several the profile with the fewest refusals; without any, the generic profile."""
    from drivers.drives.reader import GENERIC, drive_profile, drive_profile_names
    from drivers.sheet_check import check_sheet

    vendor = sheet.vendor_id
    found = [name for name in drive_profile_names() if vendor and drive_profile(name).vendor_id == vendor]

    def refusals(name: str) -> int:
        return sum(len(check_sheet(config, sheet).refused) for config in _usual_axes(name).values())

    return min(found, key=refusals) if found else GENERIC


def _axes_of(rig_name: str, axis: str, profile: str) -> dict[str, AxisConfig]:
    """Return the requested axes of a rig, with another profile if one is named."""
    from tester.kinds import load_rig

    drives = dict(load_rig(rig_name).drives())
    if axis and axis not in drives:
        raise click.UsageError(f"the rig has no drive {axis} (it has {', '.join(drives)})")
    chosen = {axis: drives[axis]} if axis else drives
    if not profile:
        return chosen
    return {name: replace(config, profile=profile, parameters={}) for name, config in chosen.items()}


def _usual_axes(profile: str) -> dict[str, AxisConfig]:
    """Return an axis of each sort for no particular machine: identities are not compared, numbers are of usual size.

    A frequency inverter turns an axis of speed and no other.
    """
    from drivers.axis import AxisConfig
    from drivers.drives.reader import drive_profile
    from drivers.screw import Screw

    drive = drive_profile(profile)
    speed = AxisConfig(
        name="speed axis", node_id=1, mode="velocity", unit="rad/s", velocity_increments=95.49 / drive.units.target_rpm,
        position_increments=0.0, feedback="velocity", rated_torque_nm=2.0, max_speed=25.0, acceleration=40.0,
        deceleration=40.0, quick_stop_deceleration=200.0, speed_zero=0.2, vendor_id=0, product_code=0,
        rpdo_deadline_s=0.2, gear=10.0, profile=profile,
    )  # fmt: skip
    if drive.inverter:
        return {speed.name: speed}
    lifted = replace(speed, speed_zero=0.0, position_increments=1000.0, feedback="position")
    press = replace(lifted, name="press", unit="mm/s", digital_io=True, screw=Screw(5.0, 0.87, 0.93, 0.01, 0.02, 40.0))
    position = replace(
        lifted, name="position axis", unit="deg", mode="position", software_limits=(-30.0, 30.0), position_window=0.02,
        rpdo_deadline_s=0.0,
    )  # fmt: skip
    return {one.name: one for one in (speed, press, position)}
