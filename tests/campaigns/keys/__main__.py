"""`python -m tests.campaigns.keys [--sample] [--seed N] [--jobs N]`: nonsense for every key of a real rig's file.

Draws values over all keys of the packaged rigs, as in the file of a real machine: each is refused there, or does no
harm: runs at the limits, with control believing the value, on a machine as packaged, without a fault and with faults.
`--set` accepts only free keys and tighter values. Prints a line a figure; exit status 1 where one misses.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator

from tester.inputs.rig.key_classes import Free
from tests.campaigns.acceptance.figure import Figure, at_least, equal
from tests.campaigns.keys.harm import Tried, tried
from tests.campaigns.keys.nonsense import Nonsense, drawn

VALUES, SAMPLE_VALUES = 400, 200
ASKED_FOR = 200
TRIED_IN_SAMPLE = 4
CASES, SAMPLE_CASES = 12, 3
"""Faults that begin in the runs with one accepted value."""


def overridable(nonsense: Nonsense) -> bool:
    """Return whether ``--set`` may accept the value on a real rig: the key is free, or the value is tighter."""
    if isinstance(nonsense.key.classes[0], Free):
        return True
    value, stated, ceilings = nonsense.value, nonsense.stated, nonsense.key.ceilings
    return bool(ceilings) and not any(one.looser(float(value), float(stated)) for one in ceilings)


def figures(values: list[Nonsense], runs: int, cases: int, jobs: int) -> Iterator[Figure]:
    """Yield the results of all values; ``runs``: how many of those that a file may have are tried in runs."""
    refusals = [(one, one.in_file()) for one in values]
    yield at_least("nonsense values over all keys", len(values), ASKED_FOR)
    unplaced = [f"{one.text}: {why}" for one, why in refusals if why and not re.search(r"yaml:(?!1:1:)\d+:", why)]
    yield equal("refusals without a place in the file", unplaced, [])
    wrong = [one.text for one in values if not overridable(one) and not one.by_override()]
    yield equal("described or loosened by --set on a real rig", wrong, [])
    in_file = [one for one, why in refusals if not why]
    accepted = [one for one in in_file if not one.at_start()]
    print(f"     {len(values) - len(in_file)} of {len(values)} refused in the file of a real rig,"
          f" {len(in_file) - len(accepted)} at a start: commissioned with other values", flush=True)  # fmt: skip
    found: list[Tried] = []
    chosen = accepted[:: max(1, len(accepted) // runs)][:runs] if runs else []
    for one in tried(chosen, cases, jobs):
        found.append(one)
        print(f"     {one.nonsense.rig}: {one.nonsense.text} ({one.nonsense.class_name}): {one.ended},"
              f" {one.cases} faults", *one.harm, sep="\n       ! ", flush=True)  # fmt: skip
    harmful = [one.nonsense.text for one in found if one.harm]
    yield equal(f"{len(found)} of {len(accepted)} accepted values tried at the limits: harm", harmful, [])


def main(arguments: list[str] | None = None) -> int:
    """Measure the requested figures; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.keys", description=(__doc__ or "").partition("\n")[2])
    parser.add_argument("--sample", action="store_true", help="the short form, for every change")
    parser.add_argument("--values", type=int, metavar="N", help=f"values to draw (default {VALUES})")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="of the draw (default 0)")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="runs side by side (default 1)")
    given = parser.parse_args(arguments)
    count: int = given.values or (SAMPLE_VALUES if given.sample else VALUES)
    values = list(drawn(count, given.seed))
    missed = 0
    cases = SAMPLE_CASES if given.sample else CASES
    for figure in figures(values, TRIED_IN_SAMPLE if given.sample else count, cases, given.jobs):
        missed += not figure.ok
        print(figure, flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
