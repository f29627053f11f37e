"""``tester serve`` and its controls: ``status``, ``hold``, ``release``, ``ack``, ``stop``."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import TYPE_CHECKING, Any, TypeVar

import click

from tester.base.processes import EXIT_FAILED, EXIT_UNREACHABLE
from tester.base.words import conditions_done, duration
from tester.cli.options import json_option, print_json, rig_option, risk_option, set_option

if TYPE_CHECKING:
    from tester.service.address import Address
    from tester.service.client import Client
    from tester.service.commands import Action
    from tester.service.state_view import StateView

NO_SERVICE = "no service is running: start one with `tester serve`"
Decorated = TypeVar("Decorated", bound=Callable[..., Any])


def connect_option(command: Decorated) -> Decorated:
    """Add --connect: where the service listens."""
    return click.option(
        "--connect", "address", default="", metavar="URL", help="The service: unix:PATH or ws://127.0.0.1:PORT."
    )(command)


def take_option(command: Decorated) -> Decorated:
    """Add --take: take control from the client that has it."""
    return click.option("--take", is_flag=True, help="Take control from the client that has it.")(command)


@click.command()
@rig_option
@set_option
@risk_option
@click.option("--out", default="runs", show_default=True, metavar="DIR", help="Folder that gets the runs' folders.")
@click.option("--connect", "address", default="", metavar="URL", help="Listen at unix:PATH instead of the user's own.")
@click.option("--tcp", "port", default=None, metavar="PORT", type=click.IntRange(0, 65535),
              help="Listen on loopback TCP with a token instead of a Unix socket; 0 = any port.")  # fmt: skip
@click.option("--allow", "allowed", multiple=True, metavar="NAME",
              help="Extension that may be loaded: entry point or package.module:object.")  # fmt: skip
@click.option("--notify", default="", metavar="COMMAND",
              help="Command to run on a trip, hold, prompt, end or full disk; JSON on its standard input.")  # fmt: skip
def serve(
    rig_name: str,
    overrides: tuple[str, ...],
    accept_risk: str,
    out: str,
    address: str,
    port: int | None,
    allowed: tuple[str, ...],
    notify: str,
) -> int:
    """Own the rig and run what clients ask for. Runs continue when they disconnect.

    Nothing moves by starting it. TERM or Ctrl+C stops a run in a controlled way and leaves at standstill.
    """
    from pathlib import Path

    from tester.service.service import ServiceOptions
    from tester.service.service_process import host

    return host(ServiceOptions(rig_name, overrides, Path(out), accept_risk, allowed), address, port, notify)


@click.command()
@connect_option
@json_option
def status(address: str, as_json: bool) -> int:
    """Say what the rig is doing; exit code 4 where no service is running."""

    async def ask(client: Client) -> None:
        _show(client.state, as_json)

    from tester.service.client import NoServiceError

    try:
        _with_client(address, ask, control=False)
    except NoServiceError as error:
        if as_json:
            print_json({"service": False, "mode": None, "reason": str(error)})
        else:
            click.echo(NO_SERVICE, err=True)
        return EXIT_UNREACHABLE
    return 0


@click.command()
@connect_option
@take_option
def hold(address: str, take: bool) -> int:
    """Lift, take the slip out and keep the temperature; the repeat under way is done again after `tester release`."""
    from tester.service.commands import Hold

    return _command(address, Hold(), take)


@click.command()
@connect_option
@take_option
def release(address: str, take: bool) -> int:
    """Resume a run that `tester hold` holds."""
    from tester.service.commands import Release

    return _command(address, Release(), take)


@click.command()
@connect_option
@take_option
def ack(address: str, take: bool) -> int:
    """Acknowledge every alarm and a latched trip. Nothing moves by it."""
    from tester.service.commands import Acknowledge

    return _command(address, Acknowledge(), take)


@click.command()
@connect_option
@click.option("--fast", is_flag=True, help="Quick stop of both drives instead of a controlled stop.")
def stop(address: str, fast: bool) -> int:
    """STOP: heat off, lift, both drives to standstill. From any shell, whoever has control. No emergency stop."""
    from tester.service.commands import Stop
    from tester.service.stop_call import NotTakenError, StopCall

    try:
        with StopCall(_address(address), _name()) as call:
            call.stop(fast=fast)
    except NotTakenError:
        pass  # its lane is not there: as any other command then
    else:
        return 0
    return _command(address, Stop(fast=fast), take=False, control=False)


def run_detached(address: str, action: Action, take: bool) -> int:
    """Have the service run a recipe, print the run's folder and leave it to the service; return the exit code."""
    return _command(address, action, take, show_folder=True)


def _command(address: str, action: Action, take: bool, *, control: bool = True, show_folder: bool = False) -> int:
    """Give one command; return the exit code."""
    from tester.service.client import LostError, NoServiceError, RefusedError
    from tester.service.commands import TakeControl

    async def give(client: Client) -> None:
        if control and take:
            await client.command(TakeControl(force=True))
        result = await client.command(action)
        if show_folder and isinstance(result, dict):
            click.echo(str(result["folder"]))

    try:
        _with_client(address, give, control=control)
    except NoServiceError:
        click.echo(NO_SERVICE, err=True)
        return EXIT_UNREACHABLE
    except (RefusedError, LostError, TimeoutError) as error:
        may_take = control and not take
        hint = ": `--take` takes control" if may_take and "has control" in str(error) else ""
        click.echo(f"refused: {error}{hint}" if isinstance(error, RefusedError) else f"no answer: {error}", err=True)
        return EXIT_FAILED
    return 0


def _with_client(address: str, work: Callable[[Client], Awaitable[None]], *, control: bool) -> None:
    """Connect, do something, hang up. Raises NoServiceError and what the work raises."""
    import asyncio

    from tester.service.client import Client

    async def session() -> None:
        async with await Client.connect(_address(address), name=_name(), control=control) as client:
            await work(client)

    asyncio.run(session())


def _address(text: str) -> Address | None:
    """Return the address that was typed, None for the user's own service. Raises UsageError."""
    from tester.service.address import AddressError, address_of

    try:
        return address_of(text) if text else None
    except AddressError as error:
        raise click.UsageError(str(error)) from error


def _name() -> str:
    """Return how a command is called at the service."""
    import os

    return f"command of process {os.getpid()}"


def _show(state: StateView, as_json: bool) -> None:
    """Print a state for people, or whole."""
    if as_json:
        from pydantic_core import to_json

        click.echo(to_json(state, inf_nan_mode="null"))
        return
    for line in _lines(state):
        click.echo("".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line))


def _lines(state: StateView) -> list[str]:
    """Return a state in some lines."""
    run, progress = state.run, state.progress
    held = f"  for {duration(state.mode_since_s)}" if state.mode == "HOLD" else ""
    lines = [f"{state.mode}  {state.mode_text}{held}".rstrip()]
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
    control = state.clients.controller or "nobody"
    lines.append(f"control  {control}; {state.clients.viewers} watching")
    return lines
