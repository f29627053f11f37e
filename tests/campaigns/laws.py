"""`python -m tests.campaigns.laws [--sample]`: the cost of materials' laws, and the accuracy of their tables.

Prints a line a figure and exits 1 where one misses. Times are processor time of this process on this core; their limits
are for a core of 2.5 GHz.
"""

from __future__ import annotations

import argparse
import gc
import os
import sys
from collections.abc import Callable, Iterator
from math import exp, inf, log
from random import Random
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time, thread_time
from typing import NamedTuple

from sim.physics import laws
from sim.physics.lookup import TableSpan, TabulatedLaw
from sim.physics.tabulated import ALLOWED, POINTS, build, build_at
from sim.physics.track import table_span
from tester.base.user_folders import CACHE
from tester.inputs.materials.library import Library
from tests.tester.kinds.specimen_on_track.bench import GROSCH, TrackBench

PAIRS = (("persson", "SBR", "S0"), ("persson", "NBR", "silicon carbide"), ("greta", "tread", "road"))
POINT_MS, TABLE_S, SPEED = 1.0, 10.0, 0.9
"""Limits: a value from the table, ms; a table of 40 x 20 x 5 points, s; the simulated rig's speed with a table relative
to its speed with the wheel paper's law."""
TABLED, ASKED = "persson", "paper"
OTHERS = {ASKED: "1#", "wlf_bell": "SBR"}
"""Laws to compare with, each with a compound it covers."""


class LawFigure(NamedTuple):
    """A measured figure, and whether it is within its limit."""

    name: str
    value: str
    asked: str
    met: bool = True


def setting_of(surface: str) -> laws.LawSetting:
    """Return the packaged materials."""
    return laws.LawSetting(Library.beside(), surface, 100.0)


def at_random(span: TableSpan, number: int, seed: int) -> Iterator[tuple[float, float, float]]:
    """Yield temperatures, loads and speeds of a table."""
    draw = Random(seed)
    for _ in range(number):
        load_n, slip_m_s = (exp(draw.uniform(log(low), log(high))) for low, high in (span.loads_n, span.speeds_m_s))
        yield draw.uniform(*span.temperatures_c), load_n, slip_m_s


def of_table(name: str, compound: str, surface: str, points: int) -> Iterator[LawFigure]:
    """Make a table and compare it with its law at random points."""
    setting = setting_of(surface)
    slow = laws.with_parts(name, laws.make(name, compound, setting=setting))
    span = table_span(setting, compound)
    began_s = process_time()
    plain = build_at(slow, span, POINTS)[0]
    plain_s = process_time() - began_s
    size = " x ".join(map(str, POINTS))
    yield LawFigure(f"table of {size}", f"{plain_s:.2f} s", f"< {TABLE_S:g} s", plain_s < TABLE_S)
    began_s = process_time()
    table = build(slow, span)[0]
    took_s = process_time() - began_s
    yield LawFigure(f"as the rig has it, {' x '.join(map(str, table.points))}", f"{took_s:.2f} s", "said")
    for what, one, asked in ((f"off the law, {size}", plain, False), ("off the law, as the rig has it", table, True)):
        errors = [abs(one.mu(*at) / slow.mu(*at) - 1.0) for at in at_random(span, points, 7)]
        text = f"{100.0 * max(errors):.3f} %, median {100.0 * median(errors):.4f} %, told {100.0 * one.error:.3f} %"
        met = max(errors) < ALLOWED or not asked
        yield LawFigure(f"{what}, worst of {points}", text, f"< {100.0 * ALLOWED:g} %" if asked else "said", met)
    yield from of_calls(table, list(at_random(span, 4000, 8)))


def of_calls(table: TabulatedLaw, places: list[tuple[float, float, float]]) -> Iterator[LawFigure]:
    """Time a value, and a value split into its parts."""
    calls: tuple[tuple[str, Callable[..., object]], ...] = (("a value", table.mu), ("its parts", table.components))
    for what, call in calls:
        began_s = process_time()
        for at in places:
            call(*at)
        each_ms = 1e3 * (process_time() - began_s) / len(places)
        yield LawFigure(f"{what} after the table", f"{each_ms:.4f} ms", f"< {POINT_MS:g} ms", each_ms < POINT_MS)


def of_rig(turns: int) -> Iterator[LawFigure]:
    """Compare the simulated rig's speed with a table and with other laws, by the quickest run of each. They run in
    turns, and each turn begins with another rig: other work on the machine can only slow a run, and the quickest of ten
    scatters half as much as a median of ratios.
    """
    with TemporaryDirectory() as folder:
        os.environ[CACHE] = folder
        rigs = [(TABLED, "SBR", ("sim.law=persson", "sim.surface=S0"))]
        rigs += [(name, compound, (f"sim.law={name}",)) for name, compound in OTHERS.items()]
        quickest = {name: inf for name, _, _ in rigs}
        for _, compound, overrides in rigs:
            tick_s(compound, overrides)  # makes the table, and warms up
        for turn in range(turns):
            first = turn % len(rigs)
            for name, compound, overrides in [*rigs[first:], *rigs[:first]]:
                quickest[name] = min(quickest[name], tick_s(compound, overrides))
    for name in OTHERS:
        speed, asked_for = quickest[name] / quickest[TABLED], name == ASKED
        yield LawFigure(f"simulated rig with {TABLED}, speed in that with {name}", f"{speed:.3f}",
                        f">= {SPEED:g}" if asked_for else "said", speed >= SPEED or not asked_for)  # fmt: skip


def tick_s(compound: str, overrides: tuple[str, ...]) -> float:
    """Return this thread's time for a tick of a run, in which a specimen is put in and slides at four speeds, s."""
    recipe = GROSCH.replace("compound: SBR", f'compound: "{compound}"').replace("[0.1", "[0.1 mm/s, 0.3 mm/s, 1")
    bench = TrackBench("grosch", recipe, overrides)
    bench.until(lambda one: one.world.track_m_s != 0.0, 1e4)
    gc.collect()  # or it would happen in the next run
    ticks, began_s = 0, thread_time()
    while not bench.run.finished:
        bench.tick()
        ticks += 1
    return (thread_time() - began_s) / ticks


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.laws", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="fewer points and turns, persson on one surface alone")
    sample = parser.parse_args(arguments).sample
    missed = 0
    for name, compound, surface in PAIRS[:1] if sample else PAIRS:
        for one in of_table(name, compound, surface, 500 if sample else 5000):
            missed += not one.met
            print(f"{'ok  ' if one.met else 'MISS'} {name}, {compound} on {surface}: {one.name}: {one.value}"
                  f" (asked: {one.asked})", flush=True)  # fmt: skip
    for one in of_rig(10 if sample else 20):
        missed += not one.met
        print(f"{'ok  ' if one.met else 'MISS'} {one.name}: {one.value} (asked: {one.asked})", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
