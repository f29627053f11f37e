"""`python -m tests.crash [--kills N] [--powercuts N] [--sample] [--seed N]`: kills and power cuts with figures."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.crash import kills, powercuts

SAMPLE_KILLS, SAMPLE_CUTS = 6, 150


def main(arguments: list[str] | None = None) -> int:
    """Measure; 1 where a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.crash", description=__doc__)
    parser.add_argument("--kills", type=int, default=200, metavar="N", help="kill -9 that often (200)")
    parser.add_argument("--powercuts", type=int, default=1000, metavar="N", help="cut the power that often (1000)")
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_KILLS} kills, {SAMPLE_CUTS} power cuts")
    parser.add_argument("--seed", type=int, default=1, metavar="N", help="of the random moments (1)")
    read = parser.parse_args(arguments)
    if read.sample:
        read.kills, read.powercuts = SAMPLE_KILLS, SAMPLE_CUTS
    missed = 0
    with TemporaryDirectory(prefix="crash-", ignore_cleanup_errors=True) as temporary:
        for name, figures in (
            ("power cuts", powercuts.measure(_folder(temporary, "powercuts"), read.powercuts, read.seed)),
            ("kills", kills.measure(_folder(temporary, "kills"), read.kills, read.seed)),
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
