"""`python -m tests.campaigns.crash [--kills N] [--powercuts N] [--sample] [--seed N]`: kills, power cuts."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.crash import kills, powercuts

SAMPLE_KILLS, SAMPLE_CUTS = 6, 150


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.crash", description=__doc__)
    parser.add_argument("--kills", type=int, default=200, metavar="N", help="kill -9 that often (200)")
    parser.add_argument("--powercuts", type=int, default=1000, metavar="N", help="cut the power that often (1000)")
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_KILLS} kills, {SAMPLE_CUTS} power cuts")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the random moments (1)")
    parser.add_argument("--kind", choices=tuple(kills.SCENARIOS), default="wheel_on_belt",
                        help="of machine (wheel_on_belt); power is cut on the first one, whose record is the same")
    read = parser.parse_args(arguments)
    if read.sample:
        read.kills, read.powercuts = SAMPLE_KILLS, SAMPLE_CUTS
    if read.kind != "wheel_on_belt":
        read.powercuts = 0
    missed = 0
    with TemporaryDirectory(prefix="crash-", ignore_cleanup_errors=True) as temporary:
        cuts = powercuts.measure(_folder(temporary, "powercuts"), read.powercuts, read.seed) if read.powercuts else ()
        for name, figures in (
            ("power cuts", cuts),
            ("kills", kills.measure(_folder(temporary, "kills"), read.kills, read.seed, read.kind)),
        ):
            print(f"== {name}", flush=True)
            for figure in figures:
                missed += not figure.ok
                print(figure, flush=True)
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


def _folder(temporary: str, name: str) -> Path:
    folder = Path(temporary) / name
    folder.mkdir()
    return folder


if __name__ == "__main__":
    sys.exit(main())
