"""``tester serve`` and its controls: ``status``, ``hold``, ``release``, ``ack``; ``stop`` is in ``stop_command``."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED, EXIT_UNREACHABLE
from tester.base.words import conditions_done, duration
from tester.cli.options import (
    RigChoice,
    address_named,
    command,
    connect_option,
    json_option,
    name_here,
    print_json,
    rig_options,
    runs_option,
)
from tester.cli.text_table import shown

if TYPE_CHECKING:
    from tester.service.client import Client
    from tester.service.commands import Action
    from tester.service.state_view import StateView

NO_SERVICE = "no service is running: start one with `tester serve`"
take_option = click.option("--take", is_flag=True, help="Take control from the client that has it.")


@command()
@rig_options
@runs_option("Folder that gets the runs' folders.")
@click.option("--connect", "address", default="", metavar="URL", help="Listen at unix:PATH instead of the user's own.")
@click.option("--tcp", "port", default=None, metavar="PORT", type=click.IntRange(0, 65535),
              help="Listen on loopback TCP with a token instead of a Unix socket; 0 = any port.")  # fmt: skip
@click.option("--allow", "allowed", multiple=True, metavar="NAME",
              help="Extension that may be loaded: entry point or package.module:object.")  # fmt: skip
@click.option("--notify", default="", metavar="COMMAND",
              help="Command to run for every notice; it gets JSON on its standard input.")  # fmt: skip
def serve(rig: RigChoice, out: Path, address: str, port: int | None, allowed: tuple[str, ...], notify: str) -> int:
    """Own the rig and run what clients ask for. Runs continue when they disconnect.

    Nothing moves by starting it. TERM or Ctrl+C stops a run in a controlled way and leaves at standstill.
    """
    from tester.service.service import ServiceOptions
    from tester.service.service_process import host

    options = ServiceOptions(rig.name, rig.overrides, out, rig.accept_risk, allowed)
    return host(options, address, port, notify)


@command()
@connect_option
@json_option
def status(address: str, as_json: bool) -> int:
    """Print what the rig is doing; exit code 4 where no service is running."""

    async def ask(client: Client) -> None:
        _show(client.state, as_json)

    from tester.service.client import NoServiceError

    try:
        with_client(address, ask)
    except NoServiceError as error:
        if as_json:
            print_json({"service": False, "mode": None, "reason": str(error)})
        else:
            click.echo(NO_SERVICE, err=True)
        return EXIT_UNREACHABLE
    return EXIT_DONE


@command()
@connect_option
@take_option
def hold(address: str, take: bool) -> int:
    """Lift, take the slip out and keep the temperature; the repeat under way is done again after `tester release`."""
    from tester.service.commands import Hold

    return give(address, Hold(), take)


@command()
@connect_option
@take_option
def release(address: str, take: bool) -> int:
    """Resume a run that `tester hold` holds."""
    from tester.service.commands import Release

    return give(address, Release(), take)


@command()
@connect_option
@take_option
def ack(address: str, take: bool) -> int:
    """Acknowledge every alarm and a latched trip. Nothing moves by it."""
    from tester.service.commands import Acknowledge

    return give(address, Acknowledge(), take)


def give(address: str, action: Action, take: bool, *, control: bool = True, show_folder: bool = False) -> int:
    """Give the service one command and return the exit code; ``show_folder``: print the run's folder."""

    async def give(client: Client) -> None:
        result = await client.command(action)
        if show_folder and isinstance(result, dict):
            click.echo(str(result["folder"]))

    return carry_out(address, give, control=control, take=take)


def carry_out(
    address: str, work: Callable[[Client], Awaitable[None]], *, control: bool = False, take: bool = False,
    person: str = "", unreachable: str = NO_SERVICE,
) -> int:  # fmt: skip
    """Do something with the service, print why not, and return the exit code.

    ``take``: first take control, where control is asked for. ``person``: who joins, "" for the user. ``unreachable``:
    printed where no service answers.
    """
    from tester.service.client import LostError, NoServiceError, RefusedError
    from tester.service.commands import TakeControl

    async def controlled(client: Client) -> None:
        if control and take:
            await client.command(TakeControl(force=True))
        await work(client)

    try:
        with_client(address, controlled, control=control, person=person)
    except NoServiceError:
        click.echo(shown(unreachable), err=True)
        return EXIT_UNREACHABLE
    except RefusedError as error:
        may_take = control and not take and "has control" in str(error)
        click.echo(shown(f"refused: {error}{': `--take` takes control' if may_take else ''}"), err=True)
        return EXIT_FAILED
    except (LostError, TimeoutError) as error:
        click.echo(f"no answer: {error}", err=True)
        return EXIT_FAILED
    return EXIT_DONE


def with_client(
    address: str, work: Callable[[Client], Awaitable[None]], *, control: bool = False, person: str = ""
) -> None:
    """Connect for a person ("": the user), do something, hang up. Raises NoServiceError and what the work raises."""
    import asyncio

    from tester.service.client import Client

    async def session() -> None:
        async with await Client.connect(address_named(address), name=name_here(person), control=control) as client:
            await work(client)

    asyncio.run(session())


def _show(state: StateView, as_json: bool) -> None:
    """Print a state for people, or whole."""
    if as_json:
        from pydantic_core import to_json

        click.echo(to_json(state, inf_nan_mode="null"))
        return
    for line in _lines(state):
        click.echo(shown(line))


def _lines(state: StateView) -> list[str]:
    """Return a state in some lines."""
    run, progress = state.run, state.progress
    since = f"  for {duration(state.mode_since_s)}" if state.mode == "HOLD" else ""
    lines = [f"{state.mode}  {state.mode_text}{since}".rstrip()]
    if state.risk:
        lines.append(f"risk     accepted: {state.risk}")
    if run is not None:
        lines.append(f"run      {run.name} ({run.recipe}): {run.outcome}" + (f": {run.reason}" if run.reason else ""))
    if progress.steps:
        where = f"step     {progress.step}/{progress.steps}  {progress.title}"
        lines.append(where + (f"  repeat {progress.repeat}/{progress.repeats}" if progress.repeats else ""))
        done = f"{conditions_done(progress.over, progress.conditions)}, " if progress.conditions else ""
        left = f", {duration(progress.left_s)} of rig time left" if progress.left_s is not None else ""
        lines.append(f"progress {done}{100 * progress.share:.0f} %{left}")
    if state.prompt is not None:
        lines.append(f"prompt   {state.prompt.number}: {state.prompt.text}")
    lines += [f"alarm    {alarm.state}: {alarm.name}: {alarm.text}" for alarm in state.alarms]
    lines += [f"value    {value.label} {value.value:.{value.decimals}f} {value.unit}".rstrip()
              for value in state.values[:5] if value.value is not None]  # fmt: skip
    control = state.clients.controller or "no client"
    lines.append(f"control  {control}; {state.clients.viewers} watching")
    return lines
