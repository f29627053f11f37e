"""Write what is made from interlock rows and safety keys: tables of each kind's page, ``interlocks`` of its rig files.

``python docs/interlocks.py`` writes those of every packaged kind, ``python docs/interlocks.py KIND`` those of one.
``--check`` only says what is out of date and exits 1.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tester.inputs.rig.ceilings import ceiling_table
from tester.kinds import PACKAGED, find
from tester.kinds.kind import Kind
from tester.machine.interlock_table import HEADER

ROOT = Path(__file__).resolve().parents[1]


def page_text(kind: Kind, text: str) -> str:
    """Return a kind's page with its tables anew."""
    for name, table in (("interlocks", kind.interlocks().table()), ("ceilings", ceiling_table(kind.rig().ceilings))):
        begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
        before, _, rest = text.partition(begin)
        text = before + begin + table + end + rest.partition(end)[2]
    return text


def rig_text(kind: Kind, text: str) -> str:
    """Return a packaged rig file with its section anew: from its header to the blank line after it."""
    before, _, rest = text.partition(HEADER[0])
    return before + kind.interlocks().section() + "\n" + rest.partition("\n\n")[2]


def outdated(kinds: tuple[str, ...] = PACKAGED) -> list[tuple[Path, str]]:
    """Return the files that are out of date, each with the text that belongs there."""
    found: list[tuple[Path, str]] = []
    for kind in map(find, kinds):
        made = [(ROOT / kind.page, page_text)]
        made += [(ROOT / place.partition(":")[0].replace(".", "/") / place.partition(":")[2], rig_text)
                 for place in kind.rigs.values()]  # fmt: skip
        for path, anew in made:
            text = path.read_text(encoding="utf-8")
            due = anew(kind, text)
            found += [(path, due)] * (due != text)
    return found


def main(arguments: list[str]) -> int:
    """Write, or with ``--check`` only look."""
    found = outdated(tuple(one for one in arguments if one != "--check") or PACKAGED)
    for path, text in found:
        if "--check" not in arguments:
            path.write_text(text, encoding="utf-8", newline="\n")
        print(f"{path.relative_to(ROOT)}: {'out of date' if '--check' in arguments else 'written'}")
    return 1 if found and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
