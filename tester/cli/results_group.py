"""`tester results`: exclude or include a repeat, and notes, on record; errors of the slip ring."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tester.base.processes import EXIT_DONE
from tester.cli.options import Decorated, command, connect_option, json_option
from tester.cli.service_commands import carry_out
from tester.cli.stored_runs import results_named, run_folder
from tester.cli.text_table import dump, shown

if TYPE_CHECKING:
    from tester.analysis.ring_errors import RingRun
    from tester.base.lock import Holder
    from tester.service.client import Client
    from tester.service.commands import RunEdit


def _of_a_repeat(command: Decorated) -> Decorated:
    """Add the arguments and options that both commands have."""
    command = connect_option(command)
    command = click.option("--operator", default=None, metavar="NAME", help="Who decides so.  [default: user]")(command)
    command = click.option("--reason", required=True, metavar="TEXT", help="Why; the record keeps it.")(command)
    command = click.argument("repeat", metavar="CONDITION/REPEAT")(command)
    return click.argument("run")(command)


@command()
@_of_a_repeat
def exclude(run: str, repeat: str, reason: str, operator: str | None, address: str) -> int:
    """Leave a repeat of RUN out of its condition's mean, and make the run's tables anew.

    CONDITION/REPEAT as repeats.csv counts them, e.g. 3/2. Nothing is deleted: `tester results include` takes it back.
    On a run under way its service records it, and the tables are made at the end.
    """
    return _decide(run, repeat, reason, operator, address, excluded=True)


@command()
@_of_a_repeat
def include(run: str, repeat: str, reason: str, operator: str | None, address: str) -> int:
    """Take a repeat of RUN that was excluded into its condition's mean again, and make the run's tables anew."""
    return _decide(run, repeat, reason, operator, address, excluded=False)


def _decide(run: str, repeat: str, reason: str, operator: str | None, address: str, *, excluded: bool) -> int:
    from tester.base.lock import user
    from tester.results.exclude import CannotExcludeError, Word, parse_target, record_word
    from tester.service.commands import ExcludeRepeat
    from tester.store.run_folders import under_way

    folder = run_folder(run)
    try:
        condition, number = parse_target(repeat)
    except CannotExcludeError as error:
        raise click.UsageError(str(error)) from error
    holder = under_way(folder)
    if holder is not None:
        action = ExcludeRepeat(folder.name, condition, reason, number, not excluded)
        if (code := _by_the_service(folder, holder, action, operator, address)) != EXIT_DONE:
            return code
    else:
        record_word(folder, Word(condition, number, excluded, reason, user() if operator is None else operator))
    results = results_named(run)
    row = next(row for row in results.all_rows() if any(m.info.condition == condition for m in row.replicates))
    n = f"valid {row.result.counts.words}"
    click.echo(f"{condition}/{number} {'excluded' if excluded else 'included'}: {shown(row.describe())}, {n}", err=True)
    end = f"record head: {results.record_head}" if holder is None else "its tables are made anew at the run's end"
    click.echo(end, err=True)
    return EXIT_DONE


def _by_the_service(folder: Path, holder: Holder, action: RunEdit, operator: str | None, address: str) -> int:
    """Have the service write a decision into its run under way, print why not, and return the exit code."""

    async def work(client: Client) -> None:
        run = client.state.run
        if run is None or run.name != folder.name or (Path(run.folder).exists() and not folder.samefile(run.folder)):
            raise click.ClickException(shown(f"{busy}; not at this service: {choice}"))
        await client.command(action)

    busy, choice = f"{folder.name} is under way: {holder.describe()}", "wait for its end, or --connect to its service"
    return carry_out(address, work, person=operator or "", unreachable=f"{busy}; no service answers: {choice}")


@command()
@click.argument("run")
@click.argument("text", default="")
@click.option("--tag", "tags", multiple=True, metavar="TAG", help="Tag to add; -TAG takes it back. May be given again.")
@click.option("--operator", default=None, metavar="NAME", help="Who writes it.  [default: user]")
@connect_option
def note(run: str, text: str, tags: tuple[str, ...], operator: str | None, address: str) -> int:
    """Write a note on RUN, or tags by which it is found; the record keeps who wrote it and when.

    With neither, print the notes and tags that it has. On a run under way its service writes the note.
    """
    from tester.base.lock import user
    from tester.results.exclude import record_note
    from tester.service.commands import AddNote
    from tester.store.notes import notes_of, tags_of
    from tester.store.run_folders import under_way
    from tester.store.run_reader import RunReader

    folder = run_folder(run)
    if text or tags:
        if (holder := under_way(folder)) is not None:
            return _by_the_service(folder, holder, AddNote(folder.name, text, tags), operator, address)
        record_note(folder, text, tags, user() if operator is None else operator)
        return EXIT_DONE
    with RunReader(folder) as reader:
        for one in notes_of(reader):
            words = one.text or f"tags {', '.join(one.tags)}"
            click.echo(shown(f"{one.utc}  {one.by}: {words}" if one.by else f"{one.utc}  {words}"))
        click.echo(shown(f"tags: {', '.join(tags_of(reader)) or 'none'}"))
    return EXIT_DONE


@command("slip-ring")
@click.argument("runs", metavar="RUN...", nargs=-1, required=True)
@click.option("--before", type=float, default=0.0, metavar="TURNS", help="Turns of the ring before the first run.")
@json_option
def slip_ring(runs: Sequence[str], before: float, as_json: bool) -> None:
    """Show how requests over the slip ring failed in each RUN: time-outs, bad checksums, late replies of the jacket.

    Of each: how many of a thousand, at which speed of the wheel, and whether they gather at an angle of it, which
    means a worn place or a brush. The angle counts from the wheel's position when it was mounted. Several runs are
    put in order of time, with the turns of the ring until then: errors that grow with its age call for new brushes.
    """
    from tester.analysis.ring_errors import ages_of, trend_of

    found = sorted((_ring_of(name) for name in dict.fromkeys(runs)), key=lambda one: one.started)
    ages = ages_of(found, before)
    if as_json:
        dump([{**one.as_json(), "age_turns": age} for one, age in zip(found, ages, strict=True)])
        return
    for one in found:
        _tell(one)
    if len(found) > 1:
        click.echo("run                             turns of the ring  requests  errors  of 1000")
        for one, age in zip(found, ages, strict=True):
            click.echo(f"{one.name:<32}{age:>17.0f}{one.requests:>10}{one.errors:>8}{one.per_thousand:>9.2f}")
        trend = trend_of([(age, one.requests, one.errors) for one, age in zip(found, ages, strict=True)]).words
        if trend:
            click.echo(trend)


def _ring_of(name: str) -> RingRun:
    """Return a run's record of the slip ring; raises ClickException if its machine has none."""
    from dataclasses import replace

    from tester.run.kind_lookup import ring_in

    found = ring_in(run_folder(name))
    if found is None:
        raise click.ClickException(f"{name}: a rig of its kind has no slip ring")
    return replace(found.run, name=name)


def _tell(one: RingRun) -> None:
    click.echo(f"{one.name}: {one.errors} of {one.requests} requests failed ({one.per_thousand:.2f} of 1000)"
               f" in {one.turns:.0f} turns")  # fmt: skip
    for words, requests, errors in one.by_speed():
        share = f"{1e3 * errors / requests:.2f} of 1000" if requests else "-"
        click.echo(f"  {words:<18}{errors:>6} of {requests:<8} {share}")
    for number, sector in enumerate(one.sectors(), start=1):
        wheel = f"wheel {number}"
        if sector.found:
            near = f"{sector.centre_deg:.0f} degrees, half of them within {sector.half_deg:.0f} of it"
            click.echo(f"  {wheel}: errors gather at {near} (strength {sector.strength:.2f})")
            click.echo("    degrees " + "".join(f"{30 * place:>5}" for place in range(12)))
            click.echo("    errors  " + "".join(f"{count:>5}" for count in sector.sectors))
        elif sector.errors:
            click.echo(f"  {wheel}: {sector.errors} errors, at no angle more than chance has it")
    click.echo()
