"""``tester stop``: it imports only what it needs to send STOP, because somebody waits for it beside the machine."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE
from tester.cli.options import command

if TYPE_CHECKING:
    from tester.service.address import Address

connect_option = click.option(
    "--connect", "address", default="", metavar="URL", help="The service: unix:PATH or ws://127.0.0.1:PORT."
)


@command()
@connect_option
@click.option("--fast", is_flag=True, help="Quick stop of both drives instead of a controlled stop.")
def stop(address: str, fast: bool) -> int:
    """STOP: heat off, lift, both drives to standstill. From any shell, with or without control. No emergency stop."""
    from tester.service.stop_call import NotTakenError, StopCall

    try:
        with StopCall(address_named(address), name_here()) as call:
            call.stop(fast=fast)
    except NotTakenError:  # the door for STOP does not answer: the gateway passes it on like any other command
        from tester.cli.service_commands import give
        from tester.service.commands import Stop

        return give(address, Stop(fast=fast), take=False, control=False)
    return EXIT_DONE


def address_named(text: str) -> Address | None:
    """Return the address that was typed, None for the user's own service; raises AddressError."""
    from tester.service.address import address_of

    return address_of(text) if text else None


def name_here() -> str:
    """Return this command's name at the service."""
    return f"command of process {os.getpid()}"
