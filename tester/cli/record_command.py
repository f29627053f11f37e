"""`tester bus record`: the frames of live wires, as a record that tests replay."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from tester.run.recording import LineTapped


@click.command("record")
@click.argument("folder", type=click.Path(file_okay=False, path_type=Path))
@click.option("--can", default="", metavar="INTERFACE:CHANNEL", help="CAN bus to listen to, e.g. socketcan:can0.")
@click.option("--bitrate", default=500_000, show_default=True, metavar="N", help="Of the CAN bus, bit/s.")
@click.option("--master", default=127, show_default=True, type=click.IntRange(1, 127), help="Node id of the master.")
@click.option(
    "--line",
    "lines",
    multiple=True,
    metavar="NAME=PORT@BAUD",
    help="Modbus RTU line to listen to, by an adapter that only listens, e.g. heat=/dev/ttyUSB1@38400.",
)
@click.option("--seconds", default=10.0, show_default=True, type=click.FloatRange(0.1, 86400.0), help="How long.")
def record(folder: Path, can: str, bitrate: int, master: int, lines: tuple[str, ...], seconds: float) -> int:
    """Listen to live wires and write every frame into FOLDER, as `tester run --bus-log` does of its own.

    Nothing is sent. On SocketCAN it listens beside a run; other CAN adapters, and serial ports, belong to one program:
    there a second adapter listens, or the run writes its own --bus-log. A test reads the folder with
    tests/drivers/recorded.py. Ends with exit code 1 if no frame was received.
    """
    from drivers.ports import BusLost
    from tester.base.processes import end_asked
    from tester.run.recording import RecordOptions, record

    interface, colon, channel = can.partition(":")
    if can and not (interface and colon and channel):
        raise click.UsageError(f"--can: expected INTERFACE:CHANNEL such as socketcan:can0, not {can!r}")
    if not can and not lines:
        raise click.UsageError("nothing to listen to: --can or --line")
    options = RecordOptions(
        folder, seconds, (interface, channel) if can else None, bitrate, master, tuple(_tapped(line) for line in lines)
    )
    try:
        with end_asked() as asked:
            found = record(options, asked)
    except BusLost as error:
        click.echo(str(error), err=True)
        return 4
    except OSError as error:
        from tester.base.trouble import in_words

        click.echo(f"{folder} cannot be written: {in_words(error)}", err=True)
        return 1
    click.echo(str(folder))
    for wire, count in found.frames.items():
        click.echo(f"{wire}: {count} frames", err=True)
    if found.garbage:
        click.echo(f"{found.garbage} bytes that are no frame: baud rate, or two that talk at once", err=True)
    return 0 if any(found.frames.values()) else 1


def _tapped(text: str) -> LineTapped:
    """Return a line's name, port and baud rate."""
    from tester.run.recording import LineTapped

    name, _, place = text.partition("=")
    port, _, baud = place.rpartition("@")
    if not name.replace("_", "").isalnum() or not port or not baud.isdecimal():
        raise click.UsageError(f"--line: expected NAME=PORT@BAUD such as heat=/dev/ttyUSB1@38400, not {text!r}")
    return LineTapped(name, port, int(baud))
