"""`python -m tests.campaigns.liars [--sample] [--jobs N]`: lying temperature sensors, and honest heats.

Twins differ from the rig file in air, heater, hub, rubber and friction, drawn by seed. Each heats a wheel to the
hottest temperature that `tester check` accepts. The hub's sensor drifts or has another gain, alone, with the
thermometer, or beside a relay that is shorted or sticks: the true hub must stay below harm, except in the rows of
``docs/hardware-magnitudes.csv``. Honest heats in air of 10 to 40 degC must not trip. Prints a line a figure, and the
magnitudes that harm, and exits 1 where a figure misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import cache
from math import inf
from random import Random

from tester.kinds import load_rig
from tester.kinds.wheel_on_belt.interlocks.heat_balance import KnownRatio
from tester.kinds.wheel_on_belt.rig import RigConfig
from tests.campaigns.faults.corners import COMPOUNDS, corners
from tests.campaigns.faults.magnitudes import Written, written
from tests.campaigns.faults.wheel_harm import HUB_C
from tests.campaigns.liars.kiln import HONEST, SHORTED, STICKS, Heated, Kiln, Lie, Twin, history

CASES, HEATS, SAMPLE_CASES, SAMPLE_HEATS = 400, 200, 24, 8
AIR_C, NEAR_AIR_K = (10.0, 40.0), 5.0
"""Air of an honest heat, and its maximum difference from the file's in heats with a lying sensor."""
UNLIKE = {
    "hub_capacity": 0.05, "jacket_power": 0.05, "conductivity": 0.05, "film_rotating": 0.1, "film_sides": 0.1,
    "hub_to_shaft": 0.2, "hub_to_rubber": 0.1,
}  # fmt: skip
"""Greatest difference of a twin from the rig file's ``sim.thermal``, as a share."""
FRICTION = (0.7, 1.3)
MOST_K_MIN, SLOW_K_MIN, MOST_PERCENT = 10.0, (0.05, 1.0), 20.0
SLOW_SHARE = 0.4
"""Share of the drifts that are slow."""
HOT_S, HEAT_S, ASTRAY_K, LONGEST_S = 900.0, 1500.0, 35.0, 7200.0
"""Earliest beginning of some drifts; length of a heat; error up to which a drift is watched, K; the longest heat."""
EXTREMES: tuple[dict[str, float], ...] = (
    {}, {"hub_capacity": 0.95, "hub_to_shaft": 1.2}, {"hub_capacity": 0.95, "jacket_power": 1.05},
)  # fmt: skip
"""Twins for the table's bounds: as the file, and those that hide the most heat, at the ends of UNLIKE."""
NO_HISTORY = "without a history"
"""Column ``only`` of the table."""
NAMES = {
    (False, False): "hub sensor gain", (False, True): "common temperature supply gain",
    (True, False): "hub sensor drift", (True, True): "common temperature supply drift",
}  # fmt: skip
"""The catalogue's phrase by (drifts, common)."""


@dataclass(frozen=True, slots=True)
class Order:
    """One heat to make; ``lie`` is HONEST in an honest one."""

    twin: Twin
    lie: Lie
    seconds: float

    @property
    def text(self) -> str:
        """Return it as text."""
        lie, words = self.lie, f"{self.twin.compound}, air {self.twin.air_c:.1f} degC, seed {self.twin.seed}"
        if lie is HONEST:
            return words
        error = f"{lie.k_min:+.2f} K/min from {lie.at_s:.0f} s" if lie.k_min else f"{lie.percent:.1f} %"
        relay = f", {lie.relay} from {lie.relay_s:.0f} s" if lie.relay else ""
        return f"{words}: {NAMES[bool(lie.k_min), lie.common]} {error}{relay}"


def value_of(lie: Lie) -> float:
    """Return the magnitude in the catalogue's unit: K/s, %/min (1 % is 1 K) where both sensors drift, or percent."""
    if not lie.k_min:
        return lie.percent
    return lie.k_min if lie.common else lie.k_min / 60.0


def listed(lie: Lie) -> bool:
    """Return whether the written table of hardware lists this lie, on a rig with a history."""
    name, value = NAMES[bool(lie.k_min), lie.common], value_of(lie)
    return any(row.fault == name and row.least <= value <= row.most for row in written() if not row.only)


@cache
def rig() -> RigConfig:
    """Return the rig as its file states it."""
    return load_rig("sim")


@cache
def hottest_c() -> int:
    """Return the hottest temperature that the check of a recipe accepts, degC."""
    return max(one.temperature_c for one in corners().values())


def twin_of(number: int) -> Twin:
    """Return the twin of a number, in air evenly from AIR_C."""
    rng = Random(f"liars {number}")
    shares = {key: 1.0 + rng.uniform(-most, most) for key, most in UNLIKE.items()}
    return Twin(COMPOUNDS[number % len(COMPOUNDS)], rng.uniform(*AIR_C), shares, rng.uniform(*FRICTION), number)


def near(twin: Twin) -> Twin:
    """Return the twin in air at most NEAR_AIR_K off the file's."""
    middle_c, half_k = 0.5 * sum(AIR_C), 0.5 * (AIR_C[1] - AIR_C[0])
    return replace(twin, air_c=rig().ambient_c + (twin.air_c - middle_c) / half_k * NEAR_AIR_K)


def lie_of(number: int) -> Lie:
    """Return the lie of a number: every second one drifts."""
    rng = Random(f"lie {number}")
    slow, drifts = rng.random() < SLOW_SHARE, number % 2 == 0
    k_min = rng.choice((-1.0, 1.0)) * rng.uniform(*SLOW_K_MIN) if slow else rng.uniform(-MOST_K_MIN, MOST_K_MIN)
    percent = 100.0 + rng.uniform(-MOST_PERCENT, MOST_PERCENT)
    # A gain that changes during the heat is a jump, which "hub sensor jump" reports at once.
    at_s = HOT_S if drifts and rng.random() < 0.5 else 0.0
    relay = rng.choice(("", "", SHORTED, STICKS))
    relay_s = at_s + rng.uniform(0.0, HEAT_S)
    return Lie(percent, k_min if drifts else 0.0, at_s, rng.random() < 0.5, relay, relay_s)


def seconds_of(lie: Lie) -> float:
    """Return how long a lie is watched, s."""
    astray_s = ASTRAY_K / abs(lie.k_min) * 60.0 if lie.k_min else 0.0
    begun_s = lie.relay_s + 0.1 * HEAT_S if lie.relay else lie.at_s
    return max(begun_s, lie.at_s + min(max(HEAT_S, astray_s), LONGEST_S))


def orders(cases: int, heats: int) -> list[Order]:
    """Return every heat to make."""
    made = [Order(near(twin_of(number)), lie, seconds_of(lie)) for number in range(cases) for lie in (lie_of(number),)]
    return made + [Order(twin_of(number), HONEST, HEAT_S) for number in range(heats)]


def known(twin: Twin) -> KnownRatio:
    """Return the rig's knowledge of its heat from earlier heatings in the file's air."""
    earlier = replace(twin, air_c=rig().ambient_c, seed=-1)
    return history(rig(), Kiln(rig(), earlier, hottest_c()).heat(HONEST, HOT_S).ratio)


def carry_out(order: Order) -> tuple[Heated, ...]:
    """Heat on a rig with a history; an honest heat also on one without."""
    found = [Kiln(rig(), order.twin, hottest_c(), known(order.twin)).heat(order.lie, order.seconds)]
    if order.lie is HONEST:
        found.append(Kiln(rig(), order.twin, hottest_c()).heat(HONEST, order.seconds))
    return tuple(found)


@dataclass(frozen=True, slots=True)
class Bound:
    """The harmful magnitudes of a lie, of those tried on every twin of EXTREMES; none: (inf, -inf)."""

    fault: str
    only: str
    least: float
    most: float
    hub_c: float

    @property
    def harms(self) -> bool:
        """Return whether any magnitude harms."""
        return self.least <= self.most

    @property
    def row(self) -> Written | None:
        """Return the row of the written table for this lie."""
        return next((row for row in written() if (row.fault, row.only) == (self.fault, self.only)), None)

    @property
    def agrees(self) -> bool:
        """Return whether the written row has these bounds."""
        row = self.row
        return (row.least, row.most) == (self.least, self.most) if row is not None else not self.harms

    @property
    def text(self) -> str:
        """Return it as one line."""
        words = f"{self.fault}, {self.only or 'with a history'}: "
        words += f"{self.least:g} to {self.most:g}, hub {self.hub_c:.0f} degC" if self.harms else "none harms"
        row = self.row
        return words if row is None else f"{words}; the table has {row.least:g} to {row.most:g}"


def bounds(jobs: int) -> Iterable[Bound]:
    """Yield the harmful magnitudes of each lie, with and without a history."""
    wanted = [(drifts, common, only) for drifts, common in NAMES for only in ("", NO_HISTORY)]
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_bound, wanted)


def _bound(wanted: tuple[bool, bool, str]) -> Bound:
    drifts, common, only = wanted
    if drifts:
        tried = [Lie(k_min=-0.05 * 1.5**n, common=common) for n in range(14)]
    else:
        tried = [Lie(percent=float(n), common=common) for n in range(60, 100)]
    least, most, hub_c = inf, -inf, 0.0
    for unlike in EXTREMES:
        twin = Twin(COMPOUNDS[-1], rig().ambient_c, {**dict.fromkeys(UNLIKE, 1.0), **unlike}, 1.0, 0)
        past = None if only else known(twin)
        for one in tried:
            heat = Kiln(rig(), twin, hottest_c(), past).heat(one, seconds_of(one))
            if heat.hub_c > HUB_C:
                value = float(f"{value_of(one):.2g}")
                least, most = min(least, value), max(most, value)
                hub_c = max(hub_c, heat.hub_c)
    return Bound(NAMES[drifts, common], only, least, most, hub_c)


def main(arguments: Sequence[str] | None = None) -> int:
    """Conduct the campaign; return the exit status."""
    parser = argparse.ArgumentParser(prog="python -m tests.campaigns.liars", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_CASES} lies, {SAMPLE_HEATS} honest heats")
    parser.add_argument("--table", action="store_true", help="only the bounds of the table of hardware, computed")
    parser.add_argument("--every", action="store_true", help="print every heat")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processors to use")
    options = parser.parse_args(arguments)
    if options.table:
        return table(options.jobs)
    made = orders(*((SAMPLE_CASES, SAMPLE_HEATS) if options.sample else (CASES, HEATS)))
    with ProcessPoolExecutor(options.jobs) as pool:
        found = list(zip(made, pool.map(carry_out, made, chunksize=4), strict=True))
    for order, heats in found if options.every else ():
        for heat in heats:
            print(f"     {line(order, heat)}")
    missed = judged(found)
    return missed if options.sample else max(missed, table(options.jobs))


def table(jobs: int) -> int:
    """Print the computed bounds of the written table; return 1 if the table differs."""
    found = list(bounds(jobs))
    for one in found:
        print(f"{'ok  ' if one.agrees else 'MISS'} {one.text}")
    return 0 if all(one.agrees for one in found) else 1


def line(order: Order, heat: Heated) -> str:
    """Return a heat as one line."""
    end = f"{heat.trip} at {heat.at_s:.0f} s" if heat.trip else "no trip"
    return f"{order.text}: hub {heat.hub_c:.1f} degC, surface {heat.surface_c:.1f} degC, {end}"


def judged(found: Sequence[tuple[Order, tuple[Heated, ...]]]) -> int:
    """Print the figures; return the exit status."""
    lies = [(order, heats[0]) for order, heats in found if order.lie is not HONEST]
    harmed = [(order, heat) for order, heat in lies if heat.hub_c > HUB_C]
    unlisted = [one for one in harmed if not listed(one[0].lie)]
    hottest = max((heat.hub_c for order, heat in lies if heat.hub_c <= HUB_C), default=0.0)
    honest = [(order, heat) for order, heats in found if order.lie is HONEST for heat in heats]
    false = [one for one in honest if one[1].trip]
    cold = sum(heat.hot_s > HEAT_S for order, heat in honest)
    figure(f"hub above {HUB_C:g} degC outside the table of hardware", len(unlisted), len(lies), unlisted)
    print(f"     in the table: {len(harmed) - len(unlisted)}; hottest hub otherwise: {hottest:.1f} degC")
    figure("honest heats that trip", len(false), len(honest), false)
    print(f"     honest heats that do not reach {hottest_c()} degC in {HEAT_S:.0f} s: {cold}")
    return 1 if unlisted or false else 0


def figure(name: str, count: int, of: int, missed: Sequence[tuple[Order, Heated]]) -> None:
    """Print one figure, and its misses."""
    print(f"{'MISS' if missed else 'ok  '} {name}: {count} of {of} (asked: 0)")
    for order, heat in missed:
        print(f"       {line(order, heat)}")


if __name__ == "__main__":
    sys.exit(main())
