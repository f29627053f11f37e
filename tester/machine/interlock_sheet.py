"""Interlocks as people read them: the table of a kind's safety page, and the section ``interlocks`` of a rig file.

``python docs/interlocks.py`` writes both where they stand in the repository.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from tester.inputs.rig.parameter import SECTION, Parameter, key_line
from tester.machine.row import Interlock

HEADER = (
    "# Level and delay of each interlock: it trips when the level has stood for the delay. What is not known counts as",
    "# tripped. A key that is missing takes the packaged value; `tester rig upgrade THIS_FILE` writes it in.",
)


@dataclass(frozen=True, slots=True)
class InterlockSheet:
    """A kind's interlocks, for writing down."""

    rows: Sequence[Interlock[Any]]
    """The table, in its order."""
    others: Sequence[Parameter] = ()
    """Parameters of the section that belong to no row."""
    others_are: str = ""
    """Their purpose, in a few words."""

    def table(self) -> str:
        """Return the table as Markdown, a line a row; names like ``stale_cell`` are keys of the rig file's section."""
        lines = ["| interlock | cause | level | after | reaction | reset |", "|---|---|---|---|---|---|"]
        for row in self.rows:
            after = row.delay.default if row.delay is not None and row.delay.value > 0.0 else "at once"
            cells = (row.name, row.cause, row.watch.level, after, row.reaction.value, row.reset)
            lines.append(f"| {' | '.join(cells)} |")
        return "\n".join(lines) + "\n"

    def section(self) -> str:
        """Return the section ``interlocks`` with its comments: every parameter under the first row that has it."""
        lines = [*HEADER, f"{SECTION}:"]
        listed: set[Parameter] = set()
        for row in self.rows:
            new = [parameter for parameter in dict.fromkeys(row.declared()) if parameter not in listed]
            listed.update(new)
            lines += [f"  # {row.name}"] * bool(new) + [key_line(one) for one in new]
        lines += [f"  # no row's: {self.others_are}"] * bool(self.others) + [key_line(one) for one in self.others]
        return "\n".join(lines) + "\n"
