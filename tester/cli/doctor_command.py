"""`tester doctor`: a look at a rig that moves nothing."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.cli.options import json_option, print_json, rig_option, seed_option, set_option

if TYPE_CHECKING:
    from tester.doctor.probe_table import TableEntry


@click.command("doctor")
@rig_option
@set_option
@seed_option
@click.option(
    "--seconds", default=60.0, show_default=True, metavar="S", type=click.FloatRange(1.0, 3600.0),
    help="How long devices are read and the computer is timed.",
)  # fmt: skip
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder that runs are written to.")
@click.option("--quick", is_flag=True, help="Ask only the Modbus units of the rig file, not every number.")
@click.option("--bundle", default=None, metavar="FILE.zip", help="Write findings, rig file, versions and parameters.")
@json_option
def doctor(
    rig_name: str,
    overrides: tuple[str, ...],
    seed: int,
    seconds: float,
    out: str,
    quick: bool,
    bundle: str | None,
    as_json: bool,
) -> int:
    """Look at a rig and say what is wrong and what to do; exit code 1 where there is a fault.

    It moves nothing, enables no drive and writes nothing to a device: objects and registers are read, the CAN bus is
    listened to. While a run or the service uses the rig it is refused.
    """
    from tester.cli.device_commands import rig_alone
    from tester.doctor.examination import Examination
    from tester.doctor.finding import Severity, worst
    from tester.doctor.probe_table import examined, written_bundle
    from tester.doctor.system import ThisComputer
    from tester.kinds import load_rig, packaged_keys

    rig = load_rig(rig_name, overrides, "a look at the rig, not a run")
    found: list[TableEntry] = []
    with rig_alone(rig, "tester doctor", seed) as wires:
        examination = Examination(
            rig, ThisComputer(), wires, Path(out), seconds, packaged_keys(rig_name, overrides), everybody=not quick,
            say=lambda text: click.echo(f"... {text}", err=True),
        )  # fmt: skip
        for entry in examined(examination):
            found.append(entry)
            if not as_json:
                _show(entry)
        if bundle is not None:
            written_bundle(Path(bundle), examination, found)
    findings = [entry.finding for entry in found]
    if as_json:
        print_json({"rig": rig.name, "findings": [{"heading": one.heading, **one.finding.as_data} for one in found]})
    else:
        counts = {severity: sum(one.severity is severity for one in findings) for severity in reversed(Severity)}
        click.echo(", ".join(f"{count} {severity.word}" for severity, count in counts.items()), err=True)
    if bundle is not None:
        click.echo(bundle, err=True)
    return EXIT_FAILED if worst(findings) is Severity.FAULT else EXIT_DONE


def _show(entry: TableEntry) -> None:
    click.echo(str(entry.finding))
    if entry.finding.todo:
        click.echo(f"        {entry.finding.todo}")
