"""`tester doctor`: examine a rig without moving anything."""

from __future__ import annotations

from pathlib import Path

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.cli.options import json_option, print_json, rig_option, seed_option, set_option


@click.command("doctor")
@rig_option
@set_option
@seed_option
@click.option(
    "--seconds", default=60.0, show_default=True, metavar="S", type=click.FloatRange(1.0, 3600.0),
    help="How long to read the devices and time the computer.",
)  # fmt: skip
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder that runs are written to.")
@click.option("--quick", is_flag=True, help="Ask only the Modbus units of the rig file, not every number.")
@click.option("--bundle", default=None, metavar="FILE.zip", help="Write findings, rig file, versions and parameters.")
@json_option
def doctor(
    rig_name: str, overrides: tuple[str, ...], seed: int, seconds: float, out: str, quick: bool, bundle: str | None,
    as_json: bool,
) -> int:  # fmt: skip
    """Look at a rig and report what is wrong and what to do, faults first; exit code 1 if a run would not arm.

    It moves nothing, enables no drive and writes nothing to a device: it reads objects and registers, and listens to
    the CAN bus. It is refused while a run or the service uses the rig.
    """
    from tester.cli.device_commands import rig_alone
    from tester.doctor.examination import Examination
    from tester.doctor.finding import Severity
    from tester.doctor.probe_table import examined, written_bundle
    from tester.doctor.system import Computer
    from tester.kinds import load_rig, packaged_keys

    rig = load_rig(rig_name, overrides, "a look at the rig, not a run")
    with rig_alone(rig, "tester doctor", seed) as wires:
        examination = Examination(
            rig, Computer(), wires, Path(out), seconds, packaged_keys(rig_name, overrides), everybody=not quick,
            say=lambda text: click.echo(f"... {text}", err=True),
        )  # fmt: skip
        entries = sorted(examined(examination), key=lambda entry: entry.finding.severity, reverse=True)
        if bundle is not None:
            written_bundle(Path(bundle), examination, entries)
    for entry in () if as_json else entries:
        click.echo(str(entry.finding))
        if entry.finding.todo:
            click.echo(f"        {entry.finding.todo}")
    severities = [entry.finding.severity for entry in entries]
    if as_json:
        print_json({"rig": rig.name, "findings": [entry.as_data for entry in entries]})
    else:
        counts = [f"{severities.count(severity)} {severity.word}" for severity in reversed(Severity)]
        click.echo(", ".join(counts), err=True)
    if bundle is not None:
        click.echo(bundle, err=True)
    return EXIT_FAILED if Severity.FAULT in severities else EXIT_DONE
