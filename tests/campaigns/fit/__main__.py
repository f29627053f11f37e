"""`python -m tests.campaigns.fit [--sample] [--jobs N] [--whole N]`: does a fit return the true parameters, and does it
give no intervals where it must not?

Prints a line a figure and exits 1 where one misses. Synthetic conditions: held-out ones predicted, redundant sets of
parameters, the paper's own table. Records drawn from the budget of grosch and of table2: wrong laws are refused or have
no intervals, the right one is accepted, and intervals contain the truth. Some whole runs of both.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from itertools import chain

from tests.campaigns.fit import silence, synthetic, whole


def main(arguments: Sequence[str] | None = None) -> int:
    """Print every figure; return 1 if one misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.fit", description=__doc__)
    parser.add_argument("--sample", action="store_true", help="few sets and records, no whole run")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="processes")
    parser.add_argument("--whole", type=int, default=1, metavar="N", help="whole runs of each law of grosch [1]")
    read = parser.parse_args(arguments)
    missed = 0
    sets = synthetic.SAMPLE if read.sample else synthetic.SETS
    found = [synthetic.figures(sets), silence.figures(sample=read.sample, jobs=read.jobs)]
    if not read.sample:
        found.append(whole.figures(read.whole, read.jobs))
    for text, met in chain.from_iterable(found):
        missed += not met
        print(f"{'ok  ' if met else 'MISS'} {text}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
