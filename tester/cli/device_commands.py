"""`tester bus sdo` and `tester bus params`: single objects of a node, and everything that devices are set to."""

from __future__ import annotations

import re
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_UNREACHABLE
from tester.cli.options import json_option, print_json, rig_option, set_option

if TYPE_CHECKING:
    from drivers.canopen.scan import ObjectAnswer
    from tester.doctor.device_parameters import ParameterDump
    from tester.doctor.open_wires import Wires
    from tester.inputs.rig import Rig
    from tester.run.set_up import Parameters

TYPES = ("u8", "i8", "u16", "i16", "u32", "i32", "text")
_OBJECT = re.compile(r"(?:0x)?([0-9a-fA-F]{4})(?::([0-9a-fA-F]{1,2}))?")


class RigBusyError(click.ClickException):
    """The rig is in use, or no device of it answers."""

    exit_code = EXIT_UNREACHABLE


@contextmanager
def rig_alone(rig: Rig, what: str, seed: int = 0) -> Generator[Wires]:
    """Yield the wires of a rig, for exclusive use; ``seed``: of a simulated one. Raises RigBusyError."""
    from tester.base.lock import ExclusiveUse
    from tester.doctor.open_wires import wires_of
    from tester.run.endings import CannotStartError
    from tester.run.preconditions import hold_rig

    with ExclusiveUse() as use:
        try:
            hold_rig(use, rig, what)
        except CannotStartError as error:
            raise RigBusyError(str(error)) from error
        wires = wires_of(rig, seed)
        try:
            yield wires
        finally:
            wires.close()


@click.command("sdo")
@click.argument("node")
@click.argument("name", metavar="INDEX[:SUB]")
@rig_option
@set_option
@click.option(
    "--write", "value", default=None, metavar="VALUE", help="Write this value, after a yes; then read it back."
)
@click.option(
    "--type", "kind", default=None, type=click.Choice(TYPES), help="Type of an object that is not known here."
)
def sdo(node: str, name: str, rig_name: str, overrides: tuple[str, ...], value: str | None, kind: str | None) -> int:
    """Read object INDEX[:SUB] (hexadecimal: 0x6076, 1018:4) of NODE, a number or an axis of the rig file.

    With --write the value is shown with what it replaces, and written after a yes. Refused while a run or the service
    uses the rig, while the drive has power, and for objects that command it.
    """
    from drivers.ports import BusLost
    from tester.kinds import load_rig

    rig = load_rig(rig_name, overrides, "one object, not a run")
    number, key = _node(rig, node), _object(name)
    with rig_alone(rig, "tester bus sdo") as wires:
        try:
            return _accessed(rig, wires, number, key, value, kind)
        except BusLost as lost:
            raise RigBusyError(str(lost)) from lost


def _accessed(rig: Rig, wires: Wires, number: int, key: tuple[int, int], value: str | None, kind: str | None) -> int:
    from drivers.canopen.dictionary import KNOWN
    from drivers.canopen.objects import DataType
    from tester.doctor.sdo_reads import NodeAccess, WriteRefusedError

    access = NodeAccess(wires.can(rig.can.bitrate), wires, number)
    before = access.read(key)
    if value is None:
        return _told(before, before.error)
    known = KNOWN.get(key)
    if kind is None and known is None:
        raise click.UsageError(f"--type: the type of {before.describe()} is not known here (expected one of {TYPES})")
    data_type = DataType[kind.upper()] if kind is not None else known.type if known is not None else DataType.TEXT
    try:
        written: int | str = value if data_type is DataType.TEXT else int(value, 0)
    except ValueError as error:
        raise click.UsageError(f"--write: expected a whole number for {data_type.name}, got {value!r}") from error
    now = before.text if before.ok else before.error
    try:
        access.may_write(key)
        click.confirm(f"node {number}, {before.describe()}: {now}; write {written}?", abort=True, err=True)
        after = access.write(key, data_type, written)
    except WriteRefusedError as error:
        raise click.ClickException(f"not written: {error}") from error
    except ValueError as error:
        raise click.UsageError(f"--write: {error}") from error
    if after.ok and after.text != str(written):
        click.echo(f"written, but it reads back as {after.text}", err=True)
        _told(after, "")
        return EXIT_FAILED
    return _told(after, f"not written: {after.error}")


def _told(answer: ObjectAnswer, error: str) -> int:
    if not answer.ok:
        click.echo(f"{answer.describe()}: {error}", err=True)
        return EXIT_FAILED
    number = answer.number
    shown = answer.text if number is None else f"{number} (0x{number & 0xFFFFFFFF:X})"
    click.echo(f"{answer.describe()}: {shown}")
    return EXIT_DONE


def _node(rig: Rig, text: str) -> int:
    axes = rig.drives()
    if text in axes:
        return axes[text].node_id
    if text in rig.can.nodes:
        return rig.can.nodes[text].node_id
    if not text.isdecimal() or not 1 <= int(text) <= 127:
        names = ", ".join([*axes, *rig.can.nodes])
        raise click.UsageError(f"NODE: expected 1 to 127, or one of {names}, got {text!r}")
    return int(text)


def _object(text: str) -> tuple[int, int]:
    found = _OBJECT.fullmatch(text)
    if found is None:
        raise click.UsageError(f"INDEX[:SUB]: expected four hexadecimal digits, as 0x6076 or 1018:4, got {text!r}")
    return int(found[1], 16), int(found[2] or "0", 16)


@click.group("params")
def params() -> None:
    """Dump the settings of a rig's devices, or compare them with a dump."""


@params.command()
@click.argument("rig_name", metavar="RIG", default="sim")
@click.option("-o", "--output", "path", default=None, metavar="FILE", type=click.Path(dir_okay=False, path_type=Path))
def dump(rig_name: str, path: Path | None) -> int:
    """Read what every device of RIG is set to, and write it to FILE or to stdout; nothing is written to a device.

    Drives: identity, ratings, gear, polarity, everything a set-up writes; Modbus devices: the registers of
    configuration that their profiles name. Exit code 1 where a device does not answer.
    """
    found = _dump(rig_name)
    if path is None:
        click.echo(found.text, nl=False)
    else:
        path.write_text(found.text, encoding="utf-8", newline="\n")
        click.echo(str(path))
    for device in found.silent:
        click.echo(f"{device} does not answer", err=True)
    return EXIT_FAILED if found.silent else EXIT_DONE


@params.command()
@click.argument("rig_name", metavar="RIG", default="sim")
@click.argument("other", metavar="[FILE|RUN]", default="")
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder of the runs.")
@json_option
def compare(rig_name: str, other: str, out: str, as_json: bool) -> int:
    """Compare what the devices of RIG are set to with FILE, which `params dump` wrote, or with a run.

    Without either: with the newest run on a rig of this name that went through its plan. Exit code 1 where something
    differs that this program does not write at every connect.
    """
    from tester.doctor.device_parameters import DumpError
    from tester.run.set_up import differences
    from tester.store.record_schema import StoreError

    try:
        where, before = _before(rig_name, other, Path(out))
    except (DumpError, StoreError) as error:
        raise click.UsageError(str(error)) from error
    now = _dump(rig_name)
    found = differences(before, now.devices)
    lasting = [one for one in found if not one.written]
    if as_json:
        print_json(
            {
                "compared_with": where,
                "differences": [
                    {"device": one.device, "object": one.key, "name": one.name, "was": one.was, "is": one.found,
                     "written_at_connect": one.written} for one in found
                ],
            }
        )  # fmt: skip
        return EXIT_FAILED if lasting else EXIT_DONE
    for one in lasting:
        click.echo(str(one))
    click.echo(f"compared with {where}: {len(lasting)} of {sum(map(len, before.values()))} differ", err=True)
    if len(found) > len(lasting):
        click.echo(f"{len(found) - len(lasting)} more differ that every connect writes anyway", err=True)
    return EXIT_FAILED if lasting else EXIT_DONE


def _dump(rig_name: str) -> ParameterDump:
    from tester.doctor.device_parameters import dumped
    from tester.doctor.examination import Examination
    from tester.doctor.system import Computer
    from tester.kinds import load_rig

    rig = load_rig(rig_name, (), "what devices are set to, not a run")
    with rig_alone(rig, "tester bus params") as wires:
        found = dumped(Examination(rig, Computer(), wires, everybody=False))
    if not found.devices:
        raise RigBusyError(f"no device of {rig.name} answers: `tester doctor --rig {rig_name}` finds the reason")
    return found


def _before(rig_name: str, other: str, runs: Path) -> tuple[str, Parameters]:
    """Return the name of the file or run to compare with, and its parameters. Raises DumpError, StoreError, OSError."""
    from tester.doctor.device_parameters import read_dump, stored_in
    from tester.kinds import load_rig
    from tester.run.set_up import last_good

    rig = load_rig(rig_name, (), "what devices are set to, not a run")
    if other and Path(other).is_file() and Path(other).suffix != ".db":
        return other, read_dump(Path(other)).devices
    folder = last_good(rig, runs) if not other else None
    if folder is None:
        from tester.store.run_folders import find_run

        folder = find_run(other or "latest", runs)
    return folder.name, stored_in(rig, folder)
