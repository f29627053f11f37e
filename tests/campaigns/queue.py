"""`python -m tests.campaigns.queue [--sample] [--schedules N] [--twin N] [--measure RUNS]`: random lives of a queue.

A life is a schedule of adds, moves, skips, drops, starts, stops, answers, alarms and changes of the rig, cut by kills
and power cuts at any byte of the record. The service, its queue and the record are real; the run is a fast fake, which
begins, asks, waits for the answer, and ends as drawn. ``--twin``: also lives of `tester serve` with runs on the twin
(``queue_twin``). The ends of undisturbed queues are sums of durations measured on the twin, with recipes that no
constant of the prediction was fitted to (``queue_measured``; ``--measure`` measures them again).
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time

from tester.queue.check import night_check, window
from tester.queue.events import ItemAdded
from tester.queue.items import Needs, PersonAsk
from tester.queue.predict import BETWEEN_S, PlannedItem, predicted
from tester.queue.view import view_of
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal, holds
from tests.campaigns.queue_life import Life, fault_figures
from tests.campaigns.queue_measured import HELD_OUT, HOLD_OUT, Measured, in_worlds, measure, read
from tests.campaigns.queue_twin import twin_lives
from tests.tester.queue.made import UTC, item, queue_of

SCHEDULES, SAMPLE = 1000, 60
QUIET = 200
"""Undisturbed queues on each rig whose end is predicted at the start."""
LEAST_ITEMS, MOST_ITEMS = 12, 24
"""Items of such a queue: a week-end of recipes of an hour. One run alone scatters by a sixth on the twin, so five items
have a half-width of 15 %: the machine causes that, and no better sum can narrow it."""


def lives(count: int) -> list[Figure]:
    """Return the figures of random lives."""
    misses: list[str] = []
    totals = {"items": 0, "runs": 0, "kills": 0, "refused starts": 0, "waits": 0}
    with TemporaryDirectory(prefix="queue-") as folder:
        for seed in range(count):
            life = Life(Path(folder) / str(seed), Random(seed))
            life.live()
            misses += [f"seed {seed}: {miss}" for miss in life.misses]
            for name, number in life.counts.items():
                totals[name] += number
    words = ", ".join(f"{number:,} {name}" for name, number in totals.items())
    return [
        holds(f"{count} schedules on a fast fake of the run", totals["runs"] > count // 2, words, "runs in them"),
        *fault_figures(misses),
    ]


def ends() -> list[Figure]:
    """Return the figures of predicted ends, over queues composed of held-out runs."""
    with TemporaryDirectory(prefix="queue-") as folder:
        known, stale = by_rig(HELD_OUT, HOLD_OUT, Path(folder))
    runs = sum(len(took_s) for entries in known.values() for _, took_s in entries)
    found = [equal("measured entries whose recipe or rig has changed since", stale, 0)]
    shares, widths = list[float](), list[float]()
    for rig, entries in known.items():
        share, halves = judged(entries, Random(32))
        shares.append(share)
        widths += halves
        words = f"{share:.1f} %, median half-width {median(halves):.1f} %"
        plans = len(entries)
        found.append(holds(f"queues on {rig}, {plans} plans: ends inside the interval", share >= 90.0, words, "90 %"))
    share = sum(shares) / len(shares)
    name = f"{QUIET * len(shares)} queues of {LEAST_ITEMS} to {MOST_ITEMS} items, of {runs} held-out runs"
    return [
        *found,
        holds(f"{name}: ends inside the interval", 90.0 <= share <= 98.0, f"{share:.1f} %", "90 to 98 %"),
        at_most(f"{name}: median half-width", median(widths), 10.0, "%", 1),
    ]


def by_rig(
    path: Path, measured: Sequence[Measured], folder: Path
) -> tuple[dict[str, list[tuple[Needs, tuple[float, ...]]]], int]:
    """Return the plans of measured recipes with their runs' durations, s, by rig, and the number of stale entries."""
    kept, stale = read(path), 0
    known: dict[str, list[tuple[Needs, tuple[float, ...]]]] = {}
    for one in in_worlds(measured):
        made_of, took_s = kept.get((one.name, one.world), ("", ()))
        stale += bool(made_of) and made_of != one.made_of
        if took_s:
            estimate = one.expected(folder)
            needs = Needs(estimate.rig_seconds, estimate.rig_seconds_low, estimate.rig_seconds_high, 1, 1)
            known.setdefault(one.rig, []).append((needs, took_s))
    return known, stale


def judged(entries: Sequence[tuple[Needs, tuple[float, ...]]], random: Random) -> tuple[float, list[float]]:
    """Return in how many of ``QUIET`` queues the interval contains the end, per cent, and its half-widths, per cent."""
    inside, halves = 0, list[float]()
    for _ in range(QUIET):
        drawn = random.choices(entries, k=random.randint(LEAST_ITEMS, MOST_ITEMS))
        last = predicted([PlannedItem(number, needs) for number, (needs, _) in enumerate(drawn)])[-1]
        took_s = sum(random.choice(took) for _, took in drawn) + BETWEEN_S * (len(drawn) - 1)
        inside += last.low_s <= took_s <= last.high_s
        halves.append(50.0 * (last.high_s - last.low_s) / last.end_s)
    return 100.0 * inside / QUIET, halves


def speed() -> list[Figure]:
    """Return the duration of a prediction and of a check of 20 items."""
    mount = (PersonAsk(0.0, "mount"),)
    items = (item(number, seconds=600.0 * number, asks=mount if number % 3 else ()) for number in range(1, 21))
    queue = queue_of(*map(ItemAdded, items))
    began_s = process_time()
    view = view_of(queue, "standing", UTC)
    between_s = process_time()
    night_check(view, UTC, *window("18:00", "08:00", UTC))
    return [
        at_most("a new prediction of 20 items", between_s - began_s, 2.0, "s"),
        at_most("check of 20 items", process_time() - between_s, 2.0, "s"),
    ]


def main(arguments: list[str] | None = None) -> int:
    """Print every figure; return 1 if one misses."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE} schedules instead of {SCHEDULES}")
    parser.add_argument("--schedules", type=int, default=0)
    parser.add_argument("--twin", type=int, default=0, metavar="N", help="N schedules with runs on the twin, too")
    parser.add_argument("--measure", type=int, default=0, metavar="RUNS", help="measure durations on the twin first")
    read = parser.parse_args(arguments)
    if read.measure:
        measure(read.measure)
    found = [*lives(read.schedules or (SAMPLE if read.sample else SCHEDULES)), *ends(), *speed()]
    found += twin_lives(read.twin) if read.twin else []
    found.append(at_least("figures", len(found), 13))
    for figure in found:
        print(figure)
    missed = sum(not figure.ok for figure in found)
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
