"""`tester slip-ring`: errors of the line through the slip ring against angle, speed and age of the ring."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING

import click

from tester.cli.formatting import dump
from tester.cli.run_lookup import run_folder

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.ring_record import RingRun


@click.command("slip-ring")
@click.argument("runs", metavar="RUN...", nargs=-1, required=True)
@click.option("--before", type=float, default=0.0, metavar="TURNS", help="What the ring had turned before the first.")
@click.option("--json", "as_json", is_flag=True, help="As JSON.")
def slip_ring(runs: Sequence[str], before: float, as_json: bool) -> None:
    """Show how requests over the slip ring failed in each RUN: time-outs, bad checksums, late replies of the jacket.

    Of each: how many of a thousand, at which speed of the wheel, and whether they gather at an angle of it, which
    speaks of a worn place or a brush. The angle counts from where the wheel stood when it was put on. Several runs are
    put in order of time, with the turns of the ring until then: errors that grow with its age call for new brushes.
    """
    from tester.kinds.wheel_on_belt.ring_record import ring_of, trend_of

    found = sorted((ring_of(run_folder(name), name) for name in dict.fromkeys(runs)), key=lambda one: one.started)
    if as_json:
        dump([{**one.as_json(), "age_turns": age} for one, age in zip(found, _ages(found, before), strict=True)])
        return
    for one in found:
        _tell(one)
    if len(found) > 1:
        click.echo("run                             turns of the ring  requests  errors  of 1000")
        for one, age in zip(found, _ages(found, before), strict=True):
            click.echo(f"{one.name:<32}{age:>17.0f}{one.requests:>10}{one.errors:>8}{one.per_thousand:>9.2f}")
        ages = _ages(found, before)
        trend = trend_of([(age, one.requests, one.errors) for one, age in zip(found, ages, strict=True)])
        if isfinite(trend.per_thousand_turns):
            grows = "grows" if trend.grows else "no trend beyond chance"
            slope = f"{trend.per_thousand_turns:+.3f} errors of 1000 for every 1000 turns"
            click.echo(f"{slope} (z {trend.z:.1f}): {grows}")


def _ages(found: Sequence[RingRun], before: float) -> list[float]:
    ages: list[float] = []
    for one in found:
        before += one.turns
        ages.append(before)
    return ages


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
