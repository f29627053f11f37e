"""`python -m tests.campaigns.report RUN`: size and processor time of `tester report`, as a user calls it.

RUN: the folder of a stored run; the limits are for one of the whole Table 2 (`tester run table2 --yes`), and any
smaller run keeps them. Prints a line a figure; exit code 1 where one misses. Needs the extra `report`; posix.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from tests.campaigns.acceptance.figure import at_most, equal
from tests.campaigns.install.place import PASS_S, pass_s

MEGABYTES = 5.0
CPU_S = 30.0
"""Where `python3 -c pass` takes PASS_S; a slower machine may take longer."""
ELSEWHERE = re.compile(r"""(src|href)\s*=\s*["'](?!#|data:)|url\(\s*["']?(?!#|data:)|@import|<script""", re.IGNORECASE)
"""Anything that a page loads from elsewhere, or runs."""


def main(arguments: list[str] | None = None) -> int:
    """Make a report and measure it; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.report", description="What a report takes.")
    parser.add_argument("run", type=Path, help="the folder of a stored run")
    run = parser.parse_args(arguments).run
    unit = pass_s(Path(sys.executable))
    with TemporaryDirectory() as folder:
        page = Path(folder) / "report.html"
        code = "from tester.cli.main import main; main()"
        process = subprocess.Popen([sys.executable, "-P", "-c", code, "report", str(run), "--out", str(page)])
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        text = page.read_text(encoding="utf-8") if page.is_file() else ""
    note = f" (`python3 -c pass` {1e3 * unit:.1f} ms)"
    limit = round(CPU_S * max(1.0, unit / PASS_S), 1)
    figures = [
        equal("exit code", process.returncode, 0),
        at_most("size", len(text.encode()) / 1e6, MEGABYTES, "MB", 2),
        at_most("CPU time", usage.ru_utime + usage.ru_stime, limit, "s", 1, note=note),
        equal("fetched from elsewhere, or run", ELSEWHERE.findall(text), []),
    ]
    for figure in figures:
        print(figure)
    return 0 if all(figure.ok for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())
