"""`python -m tests.campaigns.install [NAME ...] [--sample] [--keep FOLDER]`: cost of the README's commands.

Fresh copies and environments, no package cache. Prints a line a figure; exit code 1 where one misses. Needs bash and a
package index. CPU time limits are scaled by the time of `python3 -c pass` in the same run; wall times are not.
"""

from __future__ import annotations

import argparse
import sys
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.install.topics import SAMPLE, TOPICS, whole_test_command


def main(arguments: list[str] | None = None) -> int:
    """Measure the named topics; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.install", description="What the README takes.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="topics, all unless named: " + ", ".join(TOPICS))
    parser.add_argument("--sample", action="store_true", help="only " + ", ".join(SAMPLE))
    parser.add_argument(
        "--keep", type=Path, metavar="FOLDER",
        help="leave the copies in this folder; the tests go to their end, and their output is shown",
    )  # fmt: skip
    read = parser.parse_args(arguments)
    if unknown := [name for name in read.names if name not in TOPICS]:
        parser.error(f"no topic {', '.join(unknown)}; there are {', '.join(TOPICS)}")
    if read.keep is not None and (there := [name for name in read.names if (read.keep / name).exists()]):
        parser.error(f"--keep {read.keep}: it has {', '.join(there)} already; expected a folder without a copy")
    topics = TOPICS | ({"tests": whole_test_command} if read.keep is not None else {})
    missed = 0
    for name in read.names or (SAMPLE if read.sample else TOPICS):
        print(f"== {name}: {topics[name].__doc__}", flush=True)
        with _place(read.keep) as folder:
            try:
                for figure in topics[name](Path(folder)):
                    missed += not figure.ok
                    print(figure, flush=True)
            except (LookupError, ValueError, OSError) as error:
                missed += 1
                print(f"MISS {name}: {type(error).__name__}: {error}  [can be measured]", flush=True)
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


def _place(kept: Path | None) -> AbstractContextManager[Path | str]:
    """Return the folder for copies: a permanent one, or one that is removed after the measurement."""
    if kept is not None:
        return nullcontext(kept)
    return TemporaryDirectory(prefix="install-", ignore_cleanup_errors=True)


if __name__ == "__main__":
    sys.exit(main())
