"""``tester stop``: it imports only what it needs to send STOP, because a person at the machine waits for it."""

from __future__ import annotations

import click

from tester.base.processes import EXIT_DONE
from tester.cli.options import address_named, command, connect_option, name_here


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
