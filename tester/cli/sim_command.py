"""`tester sim`: the simulated rig in a process of its own, in real time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.cli.options import RigChoice, bus_log_option, command, rig_options, seed_option

if TYPE_CHECKING:
    from sim.servers.doors import Doors

PATH = click.Path(path_type=Path)
TIMES = click.FloatRange(0.01, 100.0)
"""How many times as fast as real time."""


@command()
@rig_options
@seed_option
@click.option("--compound", default="", metavar="NAME", help="Rubber of the specimen on the rig (the kind's first).")
@click.option(
    "--listen", default="127.0.0.1", show_default=True, metavar="HOST[:PORT]",
    help="Loopback address of TCP doors; CAN is on PORT, the lines after it. Without PORT: any free ones.",
)
@click.option("--slcan", is_flag=True, help="CAN on a pseudo-terminal, as an slcan adapter, instead of TCP.")
@click.option("--rtu", is_flag=True, help="Modbus RTU on a pseudo-terminal for each line, instead of TCP.")
@click.option(
    "--can", default="", metavar="INTERFACE:CHANNEL",
    help="CAN on a real interface of python-can, e.g. socketcan:vcan0, instead of TCP.",
)
@click.option("--links", default=None, metavar="DIR", type=PATH, help="Folder for links to the pseudo-terminals.")
@click.option(
    "--speed", default=1.0, show_default=True, metavar="X", type=TIMES,
    help="The rig lives X times as fast, for all: its time-outs are X times as short for programs.",
)
@click.option("--idle-speed", default=None, metavar="X", type=TIMES, help="X while no program is on its CAN bus.")
@click.option(
    "--control", default=None, metavar="PORT", type=click.IntRange(0, 65535),
    help="Take commands (faults, speed, state; see help) over TCP on this port of loopback; 0 = any free one.",
)
@click.option("--console", is_flag=True, help="Take commands from standard input also where it is no terminal.")
@click.option("--write-rig", default=None, metavar="FILE", type=PATH, help="Write the rig file that reaches it.")
@click.option("--log", default=None, metavar="FILE", type=PATH, help="Write the rig's true state every 10 ms, as CSV.")
@bus_log_option
def sim(
    rig: RigChoice, listen: str, slcan: bool, rtu: bool, can: str, links: Path | None, console: bool, **options: Any
) -> int:
    """Let a simulated rig live until it is interrupted, and say on stdout where it can be reached.

    Any CAN program that speaks socketcand or slcan and any Modbus program can connect; `tester run RECIPE --rig FILE`,
    with the FILE of --write-rig, runs a recipe on it as on a machine. On a terminal, commands can be typed: `help`
    lists them, `fault belt drive heartbeat lost for 3 s` is one.
    """
    # ``options`` has the fields of SimOptions that no other option changes.
    from tester.run.sim_process import SimOptions, run_sim

    doors = _doors(listen, slcan, rtu, can, links)
    at_terminal = sys.stdin is not None and sys.stdin.isatty() and sys.stdout is not None and sys.stdout.isatty()
    status = StatusLine() if at_terminal else None
    try:
        simulated = SimOptions(*rig, doors=doors, typed=console or at_terminal, **options)
        latest_s = run_sim(simulated, click.echo, status.show if status is not None else None)
    except (ValueError, FileNotFoundError) as error:  # a rubber that the kind does not have
        raise click.UsageError(str(error)) from error
    except OSError as error:
        from tester.base.trouble import in_words

        click.echo(f"cannot listen on {listen}, open a door or write a file: {in_words(error)}", err=True)
        return EXIT_FAILED
    finally:
        if status is not None:
            status.close()
    click.echo(f"ended; at most {1e3 * latest_s:.1f} ms late", err=True)
    return EXIT_DONE


def _doors(listen: str, slcan: bool, rtu: bool, can: str, links: Path | None) -> Doors:
    """Return the doors of the rig's wires; a usage error where two are asked for the CAN bus."""
    from sim.servers.doors import Doors

    host, port = _loopback(listen)
    if slcan and can:
        raise click.UsageError("--slcan and --can: the CAN bus has one door")
    if can and not all(can.partition(":")):
        raise click.UsageError(f"--can: expected INTERFACE:CHANNEL such as socketcan:vcan0, not {can!r}")
    folder = str(links.absolute()) if links is not None else ""
    return Doors("slcan" if slcan else can or "tcp", "rtu" if rtu else "tcp", host, port, folder)


class StatusLine:
    """The last line of the terminal shows the rig's state; commands are typed and answered above it."""

    def __init__(self) -> None:
        """Nothing is shown yet."""
        self._rows = 0

    def show(self, text: str) -> None:
        """Write the line, cut to the terminal's width. Everything else scrolls above it (VT100: DECSTBM, DECSC)."""
        import shutil

        columns, rows = shutil.get_terminal_size()
        if rows != self._rows:
            self._rows = rows
            click.echo(f"\n\x1b7\x1b[1;{rows - 1}r\x1b8\x1b[1A", nl=False)
        click.echo(f"\x1b7\x1b[{rows};1H\x1b[2K\x1b[7m{text[: columns - 1]}\x1b[0m\x1b8", nl=False)

    def close(self) -> None:
        """Give the line back."""
        if self._rows:
            click.echo(f"\x1b7\x1b[r\x1b[{self._rows};1H\x1b[2K\x1b8", nl=False)


def _loopback(text: str) -> tuple[str, int]:
    """Return host and port (0 = any).

    Field buses know no password: another address would hand the rig to the whole network.
    """
    from ipaddress import AddressValueError, IPv4Address

    host, _, port = text.partition(":")
    try:
        address = IPv4Address("127.0.0.1" if host == "localhost" else host)
        number = int(port or "0")
    except (AddressValueError, ValueError) as error:
        raise click.UsageError(f"--listen: expected HOST or HOST:PORT such as 127.0.0.1:29536, not {text!r}") from error
    if not address.is_loopback:
        raise click.UsageError(f"--listen: {host} is not a loopback address; CAN and Modbus have no password")
    if not 0 <= number <= 65000:
        raise click.UsageError(f"--listen: port {number} is not between 0 and 65000")
    return str(address), number
