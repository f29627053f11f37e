"""`tester queue`: recipes that run one after another on the rig of the service."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from tester.base.processes import EXIT_DONE, EXIT_FAILED
from tester.cli.options import (
    SpeedType,
    command,
    connect_option,
    json_option,
    operator_option,
    print_json,
    runs_option,
    seed_option,
    set_option,
    yes_option,
)
from tester.cli.queue_words import check_lines, queue_lines
from tester.cli.service_commands import NO_SERVICE, carry_out, take_option, with_client
from tester.cli.text_table import shown
from tester.queue.items import MOST_COPIES

if TYPE_CHECKING:
    from tester.queue.view import QueueView
    from tester.service.client import Client
    from tester.service.commands import Action

speed_option = click.option(
    "--speed", type=SpeedType(), default="1", show_default=True, metavar="max|X",
    help="Simulated rig: as fast as it goes, or X times real time.",
)  # fmt: skip


@command()
@click.argument("recipe")
@set_option
@seed_option
@speed_option
@yes_option
@operator_option
@click.option("--note", "notes", default="", metavar="TEXT", help="Note for the run's record.")
@click.option("--after", default="done,short", show_default=True, metavar="ENDS",
              help="Ends after which the queue continues: done, short, failed.")  # fmt: skip
@click.option("--copies", default=1, show_default=True, metavar="N", type=click.IntRange(1, MOST_COPIES),
              help="Add it N times; on a simulated rig each has the next seed.")  # fmt: skip
@click.option("--answer-within", "within", default="", metavar="TIME",
              help="Stop the item once a question has waited so long, e.g. 2 h, with the guard closed.")  # fmt: skip
@click.option("--unanswered", type=click.Choice(["stand", "skip"]), default="stand", show_default=True,
              help="What then: the queue stands, or continues if the next item asks for no person.")  # fmt: skip
@connect_option
@json_option
def add(
    recipe: str, overrides: tuple[str, ...], seed: int, speed: float | None, yes: bool, operator: str, notes: str,
    after: str, copies: int, within: str, unanswered: Literal["stand", "skip"], address: str, as_json: bool,
) -> int:  # fmt: skip
    """Check RECIPE (a file, or the name of a packaged recipe), freeze it, and add it to the end of the queue."""
    import recipes
    from tester.service.commands import QueueAdd

    try:
        path = recipes.find(recipe)
    except recipes.UnknownRecipe as error:
        raise click.UsageError(str(error)) from error
    packaged = path.parent == recipes.FOLDER and Path(recipe) != path
    ends: tuple[Literal["done", "short", "failed"], ...] = tuple(
        _end(word.strip()) for word in after.split(",") if word.strip()
    )
    where = recipe if packaged else str(path.absolute())
    within_s = _within_s(within, unanswered)
    action = QueueAdd(where, "", overrides, seed, speed, yes, operator, notes, ends, copies, within_s, unanswered)

    async def work(client: Client) -> None:
        result = await client.command(action, within_s=ADD_S)
        if as_json:
            print_json(result)
        elif isinstance(result, dict) and isinstance(numbers := result["ids"], list):
            words = f"item {numbers[0]}" if len(numbers) == 1 else f"items {numbers[0]} to {numbers[-1]}"
            click.echo(f"{words} added")

    return carry_out(address, work)


ADD_S = 150.0
"""Time limit of adding, s: a plan of 100,000 conditions takes some seconds, other items may be checked first [A]."""


def _within_s(text: str, unanswered: str) -> float | None:
    """Return the time limit of a question, s; None without one."""
    from tester.queue.items import wait_typed

    if not text:
        if unanswered == "skip":
            raise click.UsageError("--unanswered skip needs --answer-within: how long does a question wait?")
        return None
    try:
        return wait_typed(text)
    except ValueError as error:
        raise click.UsageError(f"--answer-within: {error}") from error


def _end(word: str) -> Literal["done", "short", "failed"]:
    if word == "done" or word == "short" or word == "failed":
        return word
    raise click.UsageError(f'--after: "{word}" is no end after which a queue continues (expected done, short, failed)')


@command("list")
@runs_option("Folder of the runs, where no service is running.")
@click.option("--rig", "rig_name", default="sim", show_default=True, metavar="RIG", help="Rig, without a service.")
@connect_option
@json_option
def list_(out: Path, rig_name: str, address: str, as_json: bool) -> int:
    """List the items, what the queue waits for, and when each item is expected to end."""
    view = _view(address, out, rig_name)
    if as_json:
        _print_whole(view)
        return EXIT_DONE
    for line in queue_lines(view):
        click.echo(shown(line))
    return EXIT_DONE


@command()
@click.argument("item", type=click.IntRange(1))
@click.option(
    "--before", default=0, metavar="ITEM", type=click.IntRange(0), help="Item before which it goes; 0: the end."
)
@connect_option
def move(item: int, before: int, address: str) -> int:
    """Move ITEM before another one, or to the end. A skipped item waits again."""
    from tester.service.commands import QueueMove

    return _edit(address, lambda revision: QueueMove(item, revision, before))


@command()
@click.argument("item", type=click.IntRange(1))
@take_option
@connect_option
def skip(item: int, take: bool, address: str) -> int:
    """Pass over ITEM. If it runs, it is stopped in a controlled way, and the next one begins."""
    from tester.service.commands import QueueSkip

    return _edit(address, lambda revision: QueueSkip(item, revision), control=True, take=take)


@command()
@click.argument("item", type=click.IntRange(1))
@connect_option
def drop(item: int, address: str) -> int:
    """Remove ITEM, which does not run, from the queue."""
    from tester.service.commands import QueueDrop

    return _edit(address, lambda revision: QueueDrop(item, revision))


@command()
@click.option("--agree", multiple=True, metavar="ITEM", type=click.IntRange(1),
              help="Item that runs although something changed since it was added. May be given again.")  # fmt: skip
@click.option("--until", default="", metavar="HH:MM",
              help="Begin no item that may last beyond this time; the queue then stands.")  # fmt: skip
@take_option
@connect_option
def start(agree: tuple[int, ...], until: str, take: bool, address: str) -> int:
    """Start the queue: its items run one after another, each after evidence about the rig."""
    from tester.queue.check import time_of_day
    from tester.service.commands import QueueStart

    try:
        clock_text = time_of_day(until).strftime("%H:%M") if until else ""
    except ValueError as error:
        raise click.UsageError(f"--until: {error}") from error
    return _edit(address, lambda _revision: QueueStart(agree, clock_text), control=True, take=take)


@command()
@click.option("--reason", default="", metavar="TEXT", help="Why; it is shown with the queue.")
@connect_option
def stand(reason: str, address: str) -> int:
    """Begin no further item; the running item continues."""
    from tester.service.commands import QueueStand

    return _edit(address, lambda _revision: QueueStand(reason))


@command()
@click.option("--from", "begins", default="18:00", show_default=True, metavar="HH:MM", help="Begin of the window.")
@click.option("--to", "ends", default="08:00", show_default=True, metavar="HH:MM", help="End of the window.")
@runs_option("Folder of the runs, where no service is running.")
@click.option("--rig", "rig_name", default="sim", show_default=True, metavar="RIG", help="Rig, without a service.")
@connect_option
@json_option
def check(begins: str, ends: str, out: Path, rig_name: str, address: str, as_json: bool) -> int:
    """Until when the queue runs alone, when it needs a person, and which order would run longer.

    Times are expected ones with the interval of 95 % of queues. Nothing is moved by it. Exit code 1 where the queue
    needs a person, or is at its end, before the window ends.
    """
    from tester.base import clock
    from tester.queue.check import night_check, window

    now = clock.utc_now()
    try:
        times = window(begins, ends, now)
    except ValueError as error:
        raise click.UsageError(str(error)) from error
    found = night_check(_view(address, out, rig_name), now, *times)
    if as_json:
        _print_whole(found)
    else:
        for line in check_lines(found):
            click.echo(shown(line))
    return EXIT_DONE if found.covered else EXIT_FAILED


@command()
@click.argument("name", default="")
@click.option("--list", "listed", is_flag=True, help="List the keys that were made.")
@click.option("--revoke", default=None, metavar="N", type=click.IntRange(1), help="Revoke key N.")
@runs_option("Folder of the runs.")
def key(name: str, listed: bool, revoke: int | None, out: Path) -> None:
    """Make a key, for NAME, that reads the queue's calendar: times and names of items, nothing else."""
    from tester.queue.calendar import calendar_keys, new_key, revoke_key

    if revoke is not None:
        revoke_key(out, revoke)
        click.echo(f"key {revoke} is revoked")
    elif listed:
        for one in calendar_keys(out):
            ended = f", revoked {one.revoked_utc}" if one.revoked_utc else ""
            click.echo(shown(f"{one.number}  {one.name or 'no name'}, made {one.made_utc}{ended}"))
    else:
        click.echo(f"/queue.ics?key={new_key(out, name)}")


def _edit(address: str, make: Callable[[int], Action], *, control: bool = False, take: bool = False) -> int:
    """Change the queue as it is now, and return the exit code."""

    async def work(client: Client) -> None:
        revision = client.queue.revision if client.queue is not None else 0
        await client.command(make(revision))

    return carry_out(address, work, control=control, take=take)


def _view(address: str, out: Path, rig_name: str) -> QueueView:
    """Return the service's queue, or where no service runs the one on the disk."""
    from tester.service.client import NoServiceError

    found: list[QueueView] = []

    async def work(client: Client) -> None:
        if client.queue is None:
            raise click.ClickException("the service has not read its queue yet")
        found.append(client.queue)

    try:
        with_client(address, work)
    except NoServiceError:
        return _stored(out, rig_name)
    return found[0]


def _stored(out: Path, rig_name: str) -> QueueView:
    from tester.base import clock
    from tester.queue.places import queue_folder
    from tester.queue.record import read_queue
    from tester.queue.view import view_of
    from tester.run.kind_lookup import load_rig

    rig = load_rig(rig_name)
    queue = read_queue(queue_folder(out, rig.name, simulated=rig.simulated))
    return view_of(queue, f"standing: {NO_SERVICE}", clock.utc_now())


def _print_whole(value: object) -> None:
    from pydantic_core import to_json

    click.echo(to_json(value, inf_nan_mode="null"))
