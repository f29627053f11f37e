"""`tester sim`: the simulated rig in a process of its own, in real time."""

from __future__ import annotations

import click

from tester.cli.options import rig_option, seed_option, set_option


@click.command("sim", short_help="A simulated rig in real time, on CAN and Modbus over TCP.")
@rig_option
@set_option
@seed_option
@click.option("--compound", default="", metavar="NAME", help="Rubber of the specimen on the rig (the kind's first).")
@click.option(
    "--listen",
    default="127.0.0.1",
    show_default=True,
    metavar="HOST[:PORT]",
    help="Loopback address; CAN is on PORT, the Modbus lines on those after it. Without PORT: any free ones.",
)
@click.option("--write-rig", default=None, metavar="FILE", help="Write the rig file that reaches it.")
@click.option("--log", default=None, metavar="FILE", help="Write the rig's true state every 10 ms, as CSV.")
@click.option("--bus-log", default=None, metavar="DIR", help="Write every CAN and Modbus frame into this folder.")
def sim(
    rig_name: str,
    overrides: tuple[str, ...],
    seed: int,
    compound: str,
    listen: str,
    write_rig: str | None,
    log: str | None,
    bus_log: str | None,
) -> int:
    """Let a simulated rig live until it is interrupted, and say on stdout where it can be reached.

    Any CAN program that speaks socketcand and any Modbus TCP program can connect; `tester run RECIPE --rig FILE`, with
    the FILE of --write-rig, runs a recipe on it as on a machine.
    """
    from pathlib import Path

    from tester.run.sim_process import SimOptions, run_sim

    host, port = _loopback(listen)
    options = SimOptions(
        rig=rig_name,
        overrides=overrides,
        seed=seed,
        compound=compound,
        host=host,
        port=port,
        write_rig=Path(write_rig) if write_rig else None,
        log=Path(log) if log else None,
        bus_log=Path(bus_log) if bus_log else None,
    )
    try:
        latest_s = run_sim(options, _say)
    except (ValueError, FileNotFoundError) as error:  # a rubber that the kind does not have
        raise click.UsageError(str(error)) from error
    except OSError as error:
        from tester.base.trouble import in_words

        click.echo(f"cannot listen on {listen} or write a file: {in_words(error)}", err=True)
        return 1
    click.echo(f"ended; at most {1e3 * latest_s:.1f} ms late", err=True)
    return 0


def _say(line: str) -> None:
    """Print at once, also into a pipe."""
    click.echo(line)


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
