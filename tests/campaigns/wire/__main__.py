"""`python -m tests.campaigns.wire [--sample] [--seed N] [--skip-run]`: are wrong frames accepted on a wire?

200,000 spoiled frames each of Modbus RTU, Modbus TCP through a gateway that cuts, merges, repeats and delays, and CAN
(SDO answers and process data): no detectably wrong value is accepted, no exception. Then the quickstart with replies
delayed by 16 ms, as by a USB adapter's latency timer: at least 40 readings of the load cell a second while it slides;
and with a delay so long that the line must be refused, with the setting named. Prints a line a figure; exit status 1 if
one misses.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from itertools import chain

from tests.campaigns.acceptance.figure import Figure
from tests.campaigns.wire import can, held, modbus
from tests.campaigns.wire.tally import spoiled

FRAMES, SAMPLE_FRAMES = 200_000, 10_000


def figures(count: int, seed: int) -> Iterator[Figure]:
    """Yield the figures of every wire."""
    yield from spoiled("RTU", modbus.rtu(), count, seed)
    yield from spoiled("TCP", modbus.tcp(), count, seed)
    yield from spoiled("CAN, SDO", can.sdo, count // 2, seed)
    yield from spoiled("CAN, PDO", can.ProcessData(), count - count // 2, seed)


def main(arguments: list[str] | None = None) -> int:
    """Measure the requested figures; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.wire", description=(__doc__ or "").partition("\n")[2])
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_FRAMES} frames a wire, and a short recipe")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the spoiling (default 1)")
    parser.add_argument("--skip-run", action="store_true", help="frames alone")
    given = parser.parse_args(arguments)
    sample: bool = given.sample
    runs = iter(()) if given.skip_run else chain(held.refused(), held.run(whole=not sample))
    missed = 0
    for figure in chain(figures(SAMPLE_FRAMES if sample else FRAMES, given.seed), runs):
        print(figure, flush=True)
        missed += not figure.ok
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
