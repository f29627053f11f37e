"""Write what is made from interlock rows and safety keys: tables of each kind's page, ``interlocks`` of its rig files.

``python docs/interlocks.py`` writes those of every packaged kind, ``python docs/interlocks.py KIND`` those of one.
``--check`` only says what is out of date and exits 1.
"""

from __future__ import annotations

import sys
from pathlib import Path

from tester.inputs.rig.key_classes import class_of
from tester.inputs.rig.key_table import ceiling_table, classed
from tester.inputs.rig.parameter import SECTION, Parameter
from tester.inputs.rig.plain_rig import PlainRig
from tester.kinds import PACKAGED, find
from tester.kinds.kind import Kind
from tester.machine import wires
from tester.machine.interlock_table import HEADER

ROOT = Path(__file__).resolve().parents[1]
EVERY_KIND = list(classed(PlainRig))
EVERY_KIND += [
    ([f"{SECTION}.{one.key}"], bound)
    for one in vars(wires).values()
    if isinstance(one, Parameter)
    for bound in class_of(one)
]
"""The classes of the keys that every kind has."""


def page_text(kind: Kind, text: str) -> str:
    """Return a kind's page with its tables anew."""
    text = _with(text, "interlocks", kind.interlocks().table())
    return _with(text, "ceilings", ceiling_table(classed(kind.rig()), EVERY_KIND))


def _with(text: str, name: str, table: str) -> str:
    """Return a page with one table anew, between its two marks."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    before, _, rest = text.partition(begin)
    return before + begin + table + end + rest.partition(end)[2]


def safety_text(text: str) -> str:
    """Return the page of safety with the ceilings that every kind has."""
    return _with(text, "ceilings", ceiling_table(EVERY_KIND))


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
    safety = ROOT / "docs" / "safety.md"
    text = safety.read_text(encoding="utf-8")
    due = safety_text(text)
    return found + [(safety, due)] * (due != text)


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
