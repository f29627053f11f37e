"""Write docs/papers.md, the papers' first table, and the stored list of items, from what `tester paper --all` computes.

``python docs/papers.py`` writes both (half a minute); ``--check`` only reports whether one is out of date and exits 1.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tester.analysis.papers import items_text, judged_papers, table_text
from tester.kinds import packaged_papers

DOCS = Path(__file__).parent
PAGE = DOCS / "papers.md"
ITEMS = DOCS.parent / "tests" / "tester" / "analysis" / "papers.txt"


def main(arguments: list[str]) -> int:
    """Write, or with ``--check`` only compare."""
    result = judged_papers(packaged_papers())
    out_of_date = False
    for path, text in ((PAGE, table_text(result)), (ITEMS, items_text(result))):
        fresh = path.is_file() and path.read_text(encoding="utf-8") == text
        out_of_date |= not fresh
        if "--check" not in arguments:
            path.write_text(text, encoding="utf-8", newline="\n")
        print(f"{path.relative_to(DOCS.parent)}: {'up to date' if fresh else 'out of date'}")
    return 1 if out_of_date and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
