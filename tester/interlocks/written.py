"""The rows as people read them: the table of docs/safety.md, and the section ``interlocks`` of a rig file.

``python docs/interlocks.py`` writes both where they stand in the repository.
"""

from __future__ import annotations

from collections.abc import Iterable

from tester.interlocks import operation
from tester.interlocks.parameter import Parameter
from tester.interlocks.row import Interlock
from tester.interlocks.table import INTERLOCKS, parameters_of

WIDTH = 36
"""Column at which a comment begins."""
SECTION = "interlocks"
HEADER = (
    "# Level and delay of each interlock: it trips when the level has stood for the delay. What is not known counts as",
    "# tripped. A key that is missing takes the packaged value; `tester rig upgrade THIS_FILE` writes it in.",
)


def interlock_table(rows: Iterable[Interlock] = INTERLOCKS) -> str:
    """Return the table as Markdown, a line a row; names like ``stale_cell`` are keys of the rig file's section."""
    lines = ["| interlock | cause | level | after | reaction | reset |", "|---|---|---|---|---|---|"]
    for row in rows:
        after = row.delay.default if row.delay is not None and row.delay.value > 0.0 else "at once"
        lines.append(f"| {row.name} | {row.cause} | {row.level} | {after} | {row.reaction.value} | {row.reset} |")
    return "\n".join(lines) + "\n"


def rig_section(rows: Iterable[Interlock] = INTERLOCKS) -> str:
    """Return the section ``interlocks`` with its comments: every parameter under the first row that has it."""
    lines = [*HEADER, f"{SECTION}:"]
    said: set[Parameter] = set()
    for row in rows:
        new = [one for one in parameters_of([row]) if one not in said]
        said.update(new)
        lines += [f"  # {row.name}"] * bool(new) + [key_line(one) for one in new]
    lines += ["  # no row's: what may begin, holds, zero checks, the cool-down, a wheel's first contact"]
    lines += [key_line(one) for one in operation.PARAMETERS]
    return "\n".join(lines) + "\n"


def key_line(parameter: Parameter, indent: str = "  ") -> str:
    """Return a parameter's line of a rig file: key, packaged value, comment."""
    return f"{indent}{parameter.key}: {parameter.default}".ljust(WIDTH - 1) + f" # {parameter.text}"
