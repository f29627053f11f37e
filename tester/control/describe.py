"""The interlock table as people read it: the same rows, with the delays of a rig."""

from __future__ import annotations

from tester.control.interlocks import INTERLOCKS
from tester.rig import RigConfig


def interlock_table(rig: RigConfig) -> str:
    """Return the table as Markdown, a line a row; names like ``stale_cell`` are keys of the rig file's interlocks."""
    lines = ["| interlock | cause | level | after | reaction | reset |", "|---|---|---|---|---|---|"]
    for row in INTERLOCKS:
        delay = row.delay_s(rig)
        after = f"{delay * 1000:g} ms" if 0.0 < delay < 1.0 else f"{delay:g} s" if delay else "at once"
        lines.append(f"| {row.name} | {row.cause} | {row.level} | {after} | {row.reaction.value} | {row.reset} |")
    return "\n".join(lines) + "\n"
