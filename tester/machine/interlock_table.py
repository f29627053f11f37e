"""The interlock table of a kind of machine: its rows in order, their bits, and the table as people read it.

Rows are in order of importance: if several trip in one scan, the first becomes the cause. A row's bit is its position.
``python docs/interlocks.py`` writes the table of a kind's safety page and the section ``interlocks`` of its rig files.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from math import inf
from types import FunctionType
from typing import Any, Final, TypeAlias

from tester.inputs.rig.parameter import SECTION, Parameter, Values, key_line
from tester.machine.inputs import ScanInputs
from tester.machine.row import ALWAYS, ENDING, LOADED, SELDOM, WARN, Form, Interlock, Watch, When

Asked: TypeAlias = Callable[[Any], bool]
Applies: TypeAlias = Asked | None
Read: TypeAlias = Callable[[Any], float]


def parameters_of(rows: Iterable[Interlock[Any]]) -> tuple[Parameter, ...]:
    """Return the parameters that rows declare, each once, at the first row that declares it."""
    return tuple(dict.fromkeys(parameter for row in rows for parameter in row.declared()))


class Loops:
    """The comparisons of rows in loops, the quickest way where they are compiled: a number costs one call a scan, and
    its limit at most one more.
    """

    def __init__(self, rows: Sequence[Interlock[Any]], values: Values) -> None:
        """Take rows, and the rig's values of the parameters."""
        self._rows = rows
        # No scan looks a fixed limit up: a rig's values never change.
        self._numbers = self._fixed(Form.AT_MOST, values)
        """For each row: the number, the value that it may not exceed, and whether the row applies."""
        self._floors = self._fixed(Form.AT_LEAST, values)
        """The same for the value below which the number may not fall."""
        self._most = self._moving(Form.AT_MOST)
        """The same for limits that are functions of the inputs."""
        self._least = self._moving(Form.AT_LEAST)
        self._spans: tuple[tuple[Callable[[Any], tuple[float, float, float]], Applies], ...] = tuple(
            (watch.parts[0], applies) for watch, applies in self._of(Form.WITHIN)
        )
        self._states: tuple[tuple[Asked, Applies], ...] = tuple(
            (watch.holds, applies) for watch, applies in self._of(Form.STATE)
        )

    def _of(self, form: Form) -> list[tuple[Watch[Any], Applies]]:
        return [(row.watch, row.applies) for row in self._rows if row.watch.form is form]

    def _fixed(self, form: Form, values: Values) -> tuple[tuple[Read, float, Applies], ...]:
        return tuple(
            (watch.parts[0], limit, applies)
            for watch, applies in self._of(form)
            if (limit := watch.fixed(values)) is not None
        )

    def _moving(self, form: Form) -> tuple[tuple[Read, Read, Applies], ...]:
        return tuple(
            (watch.parts[0], watch.parts[1], applies) for watch, applies in self._of(form) if watch.limit is None
        )

    def any_holds(self, v: Any) -> bool:
        """Return whether any of the rows holds."""
        for number, limit_value, applies in self._numbers:
            if not (number(v) <= limit_value) and (applies is None or applies(v)):
                return True
        for holds, applies in self._states:
            if holds(v) and (applies is None or applies(v)):
                return True
        for number, limit, applies in self._most:
            if not (number(v) <= limit(v)) and (applies is None or applies(v)):
                return True
        for span, applies in self._spans:
            low, value, high = span(v)
            if not (low <= value <= high) and (applies is None or applies(v)):
                return True
        for number, limit_value, applies in self._floors:
            if not (number(v) >= limit_value) and (applies is None or applies(v)):
                return True
        for number, limit, applies in self._least:
            if not (number(v) >= limit(v)) and (applies is None or applies(v)):
                return True
        return False


def written(rows: Iterable[Interlock[Any]], values: Values) -> Asked:
    """Return the same comparisons as one Python function without loops, from text: the quickest way where nothing is
    compiled. A number that several rows compare is computed once.
    """
    names: dict[str, Any] = {}
    places: dict[Any, str] = {}
    lines = ["def any_holds(v):"]
    kept: set[str] = set()

    def name(thing: Any) -> str:
        place = places.setdefault(thing, f"x{len(places)}")
        names[place] = thing
        return place

    for row in rows:
        watch, form, limit = row.watch, row.watch.form, row.watch.fixed(values)
        applies = f" and {name(row.applies)}(v)" if row.applies is not None else ""
        if form is Form.STATE:
            comparison = f"{name(watch.holds)}(v)"
        elif form is Form.WITHIN:
            lines.append(f" low, value, high = {name(watch.parts[0])}(v)")
            comparison = "not low <= value <= high"
        else:
            place = name(watch.parts[0])
            number = f"n{place}" if place in kept else f"(n{place} := {place}(v))"
            kept.add(place)
            bound = f"{name(watch.parts[1])}(v)" if limit is None else name(limit)
            comparison = f"not {number} {'<=' if form is Form.AT_MOST else '>='} {bound}"
        lines.append(f" if {comparison}{applies}: return True")
    exec("\n".join((*lines, " return False")), names)
    any_holds: Asked = names["any_holds"]
    return any_holds


COMPILED: Final = not isinstance(parameters_of, FunctionType)


class Group:
    """Rows of a rig that are evaluated together, with their bits.

    Nearly always no condition holds, so a row's condition comes first, and whether the row applies only where it holds.
    """

    __slots__ = ("any_holds", "members")

    def __init__(self, members: Iterable[tuple[int, Interlock[Any]]], values: Values) -> None:
        """Take (bit, row) pairs, and the rig's values of the parameters."""
        self.members: tuple[tuple[int, Interlock[Any]], ...] = tuple(members)
        rows = [row for _, row in self.members]
        self.any_holds: Asked = Loops(rows, values).any_holds if COMPILED else written(rows, values)
        """Whether any of the rows holds."""

    def held(self, v: ScanInputs) -> int:
        """Return the bits of the rows that hold. Nearly always none holds; the search for the row begins only when one
        does.
        """
        any_holds = self.any_holds
        return self._which(v) if any_holds(v) else 0

    def _which(self, v: ScanInputs) -> int:
        held = 0
        for bit, row in self.members:
            if row.holds(v):
                held |= bit
        return held


class RigTable:
    """The rows with the values of a rig: it evaluates a scan, and never changes."""

    __slots__ = ("after_change", "always", "in_contact", "while_ending", "while_loaded")

    def __init__(self, table: InterlockTable, values: Values) -> None:
        """Take the rows of ``table``, and the rig's value of each of its parameters."""

        def group(when: When) -> Group:
            return Group(((table.bit(row.name), row) for row in table.rows if row.when is when), values)

        self.always, self.while_loaded, self.while_ending = group(ALWAYS), group(LOADED), group(ENDING)
        self.after_change = group(SELDOM)
        self.in_contact = Group((*self.always.members, *self.while_loaded.members), values)
        """Those of every scan, and those of a loaded one, in one pass."""

    def __deepcopy__(self, memo: dict[int, object]) -> RigTable:
        """Return itself: copies of a running machine share its table."""
        return self

    def held(self, v: ScanInputs) -> int:
        """Return the bits of the rows that hold in a scan; every row that can apply is evaluated."""
        seldom = v.seldom()
        if seldom is None or seldom != v.seen:
            v.seen, v.seen_held = seldom, self.after_change.held(v)
        found = v.seen_held | (self.in_contact if v.loaded and not v.unpowered else self.always).held(v)
        if v.lifting_s >= 0.0 or v.resting or v.unpowered:
            found |= self.while_ending.held(v)
        return found


class InterlockTable:
    """The rows, and the bounds that belong to no row. A table never changes."""

    def __init__(self, rows: Iterable[Interlock[Any]], operation: Iterable[Parameter] = ()) -> None:
        """Take the rows in their order; ``operation``: parameters of the section ``interlocks`` that belong to no
        row.
        """
        self.rows: tuple[Interlock[Any], ...] = tuple(rows)
        self.operation: tuple[Parameter, ...] = tuple(operation)
        self.parameters: tuple[Parameter, ...] = (*parameters_of(self.rows), *self.operation)
        """Every key of the rig file's section ``interlocks``, in its order."""
        self.channels: tuple[str, ...] = tuple(dict.fromkeys(name for row in self.rows for name in row.channels))
        """Channels of further sensors that rows read."""
        self._bits = {row.name: 1 << i for i, row in enumerate(self.rows)}
        self._unseen = tuple(
            (self.bit(row.name), there) for row in self.rows if (there := row.still_there()) is not None
        )
        self.at_rest = sum(self.bit(row.name) for row in self.rows if row.at_rest is not None)
        """Rows that also trip at rest."""
        self.warnings = sum(self.bit(row.name) for row in self.rows if row.reaction is WARN)
        """Rows that stop nothing, and do not prevent arming or acknowledging."""

    def __deepcopy__(self, memo: dict[int, object]) -> InterlockTable:
        """Return itself: copies of a running machine share its table."""
        return self

    def bit(self, name: str) -> int:
        """Return the bit of a row; raises KeyError for a name that is not in the table."""
        return self._bits[name]

    def names_of(self, bits: int) -> list[str]:
        """Return the names of the rows whose bits are set."""
        return [row.name for i, row in enumerate(self.rows) if bits >> i & 1]

    def still_there(self, v: ScanInputs) -> int:
        """Return the bits of rows that apply only to a demand and whose cause remains, evaluated without it."""
        return sum(bit for bit, there in self._unseen if there(v))

    def delays_s(self, values: Values) -> tuple[float, ...]:
        """Return how long each row's condition must hold on a rig, s."""
        return tuple(row.delay_s(values) for row in self.rows)

    def nothing_pending(self) -> list[float]:
        """Return the list of times since when each row has held (s), for a scan in which no row holds."""
        return [inf] * len(self.rows)


HEADER = (
    "# Level and delay of each interlock: it trips when the level has stood for the delay. What is not known counts as",
    "# tripped. A key that is missing takes the packaged value; `tester rig upgrade THIS_FILE` writes it in.",
)


@dataclass(frozen=True, slots=True)
class InterlockSheet:
    """A kind's interlocks, written as text."""

    rows: Sequence[Interlock[Any]]
    """The table, in its order."""
    others: Sequence[Parameter] = ()
    """Parameters of the section ``interlocks`` that belong to no row."""
    others_are: str = ""
    """Purpose of these other parameters, in a few words."""

    def table(self) -> str:
        """Return the table as Markdown, a line for each row; names like ``stale_cell`` are keys of the rig file's
        section.
        """
        lines = ["| interlock | cause | level | after | reaction | reset |", "|---|---|---|---|---|---|"]
        for row in self.rows:
            after = row.delay.default if row.delay is not None and row.delay.value > 0.0 else "at once"
            cells = (row.name, row.cause, row.watch.level, after, row.reaction.value, row.reset)
            lines.append(f"| {' | '.join(cells)} |")
        return "\n".join(lines) + "\n"

    def section(self) -> str:
        """Return the section ``interlocks`` with its comments: every parameter is under the first row that declares
        it.
        """
        lines = [*HEADER, f"{SECTION}:"]
        listed: set[Parameter] = set()
        for row in self.rows:
            new = [parameter for parameter in dict.fromkeys(row.declared()) if parameter not in listed]
            listed.update(new)
            lines += [f"  # {row.name}"] * bool(new) + [key_line(one) for one in new]
        lines += [f"  # no row's: {self.others_are}"] * bool(self.others) + [key_line(one) for one in self.others]
        return "\n".join(lines) + "\n"
