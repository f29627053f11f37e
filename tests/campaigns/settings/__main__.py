"""`python -m tests.campaigns.settings [--sample] [--seeds N] [--jobs N]`: one setting, four times over two wheels.

Counts how often U of a difference contains it, on one wheel and between wheels, one pair a seed; how often a run
reports that a setting disagrees, with no change and with a change of friction by 8 % between two measurements on one
wheel. Wear, diameter and heat differ from the beliefs about them. Prints a line a figure; exit status 1 where one
misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from math import ceil, comb, sqrt

from tester.analysis.repeated_settings import LEVEL
from tests.campaigns.acceptance.figure import Figure, at_least, holds
from tests.campaigns.settings.twin import SettingCase, SettingFound, found_of

SEEDS, SAMPLE_SEEDS = 300, 2
COVERED = (91.0, 98.0)
"""Share of differences within U, per cent."""
SAID = 0.95
"""Required share of runs that report a change."""
WHOLE = 0.95
"""Share of runs in which all four measurements have a value."""
SURE = 0.99
"""Probability that false alarms at the stated level do not exceed the allowed number."""


def alarms_allowed(count: int) -> int:
    """Return the number of false alarms that the level allows in so many runs."""
    allowed, total = 0, (1.0 - LEVEL) ** count
    while total < SURE:
        allowed += 1
        total += comb(count, allowed) * LEVEL**allowed * (1.0 - LEVEL) ** (count - allowed)
    return allowed


def covered(name: str, pairs: list[tuple[float, float]]) -> Figure:
    """Return how many differences, which are truly 0, are within U; the limits of few pairs allow for the scatter of
    the count."""
    count = len(pairs)
    low, high = COVERED
    room = 0.0 if count >= WHOLE * SEEDS else 250.0 * sqrt(0.25 / max(count, 1))
    share = 100.0 * sum(abs(off) <= u for off, u in pairs) / count if count else 0.0
    u = sum(u for _, u in pairs) / max(count, 1)
    limit = f"{low:g} to {high:g} %" + (f" +- {room:.0f} for {count}" if room else "")
    return holds(name, low - room <= share <= high + room, f"{share:.1f} % of {count}, U {u:.1f} % in the mean", limit)


def figures(found: list[SettingFound]) -> Iterator[Figure]:
    """Yield the results of all runs."""
    for changed in (False, True):
        ours = [one for one in found if one.case.changed is changed]
        whole = [one for one in ours if one.whole]
        reported = sum(one.disagrees for one in whole)
        what = "friction changes by 8 %" if changed else "nothing changes"
        yield at_least(f"{what}: runs with four values, of {len(ours)}", len(whole), ceil(WHOLE * len(ours)))
        if changed:
            yield at_least(f"{what}: reported, of {len(whole)}", reported, ceil(SAID * len(whole)))
            right = sum(one.stands_out in (1, 2) for one in whole)
            yield at_least(f"{what}: a value of that wheel is named, of {len(whole)}", right, ceil(SAID * len(whole)))
            continue
        yield covered("U of a difference on one wheel holds it", [one.on_one for one in whole])
        yield covered("U of a difference between wheels holds it", [one.between for one in whole])
        allowed = alarms_allowed(len(whole))
        yield holds(f"{what}: false alarms, of {len(whole)}", reported <= allowed, str(reported), f"at most {allowed}")


def main(arguments: list[str] | None = None) -> int:
    """Measure the requested figures; return the exit status."""
    parser = argparse.ArgumentParser(
        "python -m tests.campaigns.settings", description=(__doc__ or "").partition("\n")[2]
    )
    parser.add_argument("--sample", action="store_true", help="the short form, for every change")
    parser.add_argument("--seeds", type=int, metavar="N", help=f"runs of each sort (default {SEEDS})")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    given = parser.parse_args(arguments)
    seeds: int = given.seeds if given.seeds is not None else SAMPLE_SEEDS if given.sample else SEEDS
    cases = [SettingCase(seed, changed) for seed in range(seeds) for changed in (False, True)]
    found: list[SettingFound] = []
    for one in found_of(cases, given.jobs):
        found.append(one)
        what = "changed" if one.case.changed else "as it was"
        (off, u), (off_2, u_2) = one.on_one, one.between
        text = f"{off:+.2f} ± {u:.2f} %, {off_2:+.2f} ± {u_2:.2f} % between, chi2 {one.chi2:.1f} of {one.limit:.1f}"
        print(f"     seed {one.case.seed}, {what}: {text}{'  DISAGREES' if one.disagrees else ''}", flush=True)
    missed = 0
    for figure in figures(found):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
