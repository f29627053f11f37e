"""Write the glossary's table of flags from the one list of them, ``tester/analysis/flags.py``.

``python docs/flags.py`` writes it, ``--check`` only says that it is out of date and exits 1.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tester.analysis.flags import FLAGS

PAGE = Path(__file__).with_name("glossary.md")
BEGIN, END = "<!-- flags: begin -->\n", "<!-- flags: end -->"


def flag_table() -> str:
    """Return the table: doubts first, as they are mended, then notes."""
    lines = ["| flag | weight | means | what helps |", "|---|---|---|---|"]
    for flag in sorted(FLAGS.values(), key=lambda one: not one.doubt):
        weight = "doubt" if flag.doubt else "note"
        lines.append(f"| {flag.word} | {weight} | {flag.meaning} | {flag.remedy} |")
    return "\n".join(lines) + "\n"


def page_text(text: str) -> str:
    """Return the glossary with its table anew."""
    before, _, rest = text.partition(BEGIN)
    return before + BEGIN + flag_table() + END + rest.partition(END)[2]


def main(arguments: list[str]) -> int:
    """Write, or with ``--check`` only look."""
    text = PAGE.read_text(encoding="utf-8")
    due = page_text(text)
    if due == text:
        return 0
    check = "--check" in arguments
    if not check:
        PAGE.write_text(due, encoding="utf-8", newline="\n")
    print(f"{PAGE.name}: {'out of date' if check else 'written'}")
    return int(check)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
