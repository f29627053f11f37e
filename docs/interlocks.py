"""Write what is made from interlock rows and ceilings: tables of docs/safety.md, ``interlocks`` of sim/rig.yaml.

``python docs/interlocks.py`` writes, ``--check`` only says what is out of date and exits 1.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tester.interlocks.written import HEADER, interlock_table, rig_section
from tester.rig.ceilings import ceiling_table

ROOT = Path(__file__).resolve().parents[1]
SAFETY, RIG = ROOT / "docs" / "safety.md", ROOT / "sim" / "rig.yaml"


def safety_text(text: str) -> str:
    """Return the page with its tables anew."""
    for name, table in (("interlocks", interlock_table()), ("ceilings", ceiling_table())):
        begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
        before, _, rest = text.partition(begin)
        text = before + begin + table + end + rest.partition(end)[2]
    return text


def rig_text(text: str) -> str:
    """Return the packaged rig file with its section anew: from its header to the blank line after it."""
    before, _, rest = text.partition(HEADER[0])
    return before + rig_section() + "\n" + rest.partition("\n\n")[2]


def outdated() -> list[tuple[Path, str]]:
    """Return the files that are out of date, each with the text that belongs there."""
    texts = [(path, path.read_text(encoding="utf-8")) for path in (SAFETY, RIG)]
    due = [(SAFETY, safety_text(texts[0][1])), (RIG, rig_text(texts[1][1]))]
    return [new for old, new in zip(texts, due, strict=True) if old != new]


def main(arguments: list[str]) -> int:
    """Write, or with ``--check`` only look."""
    found = outdated()
    for path, text in found:
        if "--check" not in arguments:
            path.write_text(text, encoding="utf-8", newline="\n")
        print(f"{path.relative_to(ROOT)}: {'out of date' if '--check' in arguments else 'written'}")
    return 1 if found and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
