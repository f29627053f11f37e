"""``python -m tests.campaigns.forgery``: 20 forgeries, a line each; exit code 1 if one that must be detected is not."""

from __future__ import annotations

import sys
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path
from tempfile import TemporaryDirectory

from tester.results.verify import verify
from tests.campaigns.forgery.forge import FORGERIES, detected
from tests.campaigns.forgery.run import finished_run


def main() -> int:
    """Forge, print which forgeries were detected, return the exit code."""
    with TemporaryDirectory(prefix="forgery-") as home:
        with redirect_stdout(StringIO()):
            run, other = finished_run(Path(home) / "one", 1), finished_run(Path(home) / "two", 2)
        found = verify(run)
        for problem in found.problems:
            print(f"the run itself: {problem}")
        rows = [(one.name, *detected(run, other, one, Path(home) / "forged")) for one in FORGERIES]
    print(f"{'':40}  chain unmade        all made anew")
    print(f"{'forgery':40}  head kept  without  head kept  without")
    for name, *shown in rows:
        kept, without, kept_anew, without_anew = ("told" if one else "-" for one in shown)
        print(f"{name:40}  {kept:9}  {without:7}  {kept_anew:9}  {without_anew}")
    with_head = sum(row[1] and row[3] for row in rows)
    alone = sum(row[2] for row in rows)
    print(f"with the head kept {with_head} of {len(rows)}, chain unmade without it {alone} of {len(rows)}; "
          f"{found.coefficients} coefficients recomputed")  # fmt: skip
    missed = with_head < len(rows) or alone < len(rows)
    return 1 if found.problems or missed or not found.coefficients else 0


if __name__ == "__main__":
    sys.exit(main())
