"""A recipe that is being written: answers so far, each checked against a rig."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeVar

from tester.base.axes import Axis
from tester.base.source import InvalidSource, Problem
from tester.base.units import expected

if TYPE_CHECKING:
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.rig import Rig

Answer = TypeVar("Answer")
_PLAIN = re.compile(r"[\w.+-][\w .+/%^-]*")
"""A value that needs no quotes in YAML."""


class Draft:
    """The answers so far. Each ``with_...`` takes an answer, or raises InvalidSource and keeps the former one."""

    def __init__(self, source: str, rig: Rig, part: RecipePart) -> None:
        self.source, self.rig, self.part = source, rig, part
        self.name = "new recipe"
        self.compounds: list[str] = []
        self.repeats = "3"
        self.values: dict[str, list[str]] = {}

    @classmethod
    def on(cls, rig: str) -> Draft:
        """Return an empty recipe for a rig, given by name or file; raises InvalidSource."""
        from tester.run.kind_lookup import load_rig, recipe_part

        loaded = load_rig(rig)
        return cls(rig, loaded, recipe_part(loaded))

    @property
    def axes(self) -> Sequence[Axis]:
        """The axes to ask for, in the order of the kind's table."""
        return [axis for axis in self.part.axes if not axis.in_measure]

    def hint(self, axis: Axis) -> str:
        """Return an axis with the form of its answer: ``load (a load such as "100 N"; units accepted: N, kN)``."""
        texts = ", ".join(axis.choices) or "a name"
        return f"{axis.name} ({texts if axis.textual else expected(axis.recipe_unit)})"

    def default_of(self, axis: Axis) -> str:
        """Return the value of an axis that a recipe may leave out, "" for any other."""
        default = axis.recipe_default
        if default is None or isinstance(default, str):
            return default or ""
        return f"{default:g} {axis.recipe_unit}"

    def suggested_name(self) -> str:
        """Return a name made of the varied axes."""
        varied = [name.replace("_", " ") for name, values in self.values.items() if len(values) > 1]
        return f"{', '.join(self.compounds)}: {' and '.join(varied) or 'one condition'}"

    def with_compounds(self, text: str) -> None:
        """Take the compounds."""
        self.compounds = self._tried("compounds", _listed(text), "  - compound:")

    def with_axis(self, axis: Axis, text: str) -> None:
        """Take the values of an axis."""
        values = self.values | {axis.name: _listed(text)}
        self.values = self._tried("values", values, f"    {axis.name}:")

    def with_repeats(self, text: str) -> None:
        """Take the number of repeats."""
        self.repeats = self._tried("repeats", text.strip(), "measure:")

    def with_name(self, text: str) -> None:
        """Take the recipe's name."""
        self.name = self._tried("name", text.strip(), "recipe:")

    def checked(self) -> Sequence[Problem]:
        """Return the doubts about the whole recipe; raises InvalidSource if the rig cannot run it."""
        from tester.run.kind_lookup import checked_recipe

        return checked_recipe(self.text(), self.rig, "the new recipe").doubts

    def text(self) -> str:
        """Return the recipe as YAML; an axis at its default is left out."""
        lines = [f"recipe: {json.dumps(self.name, ensure_ascii=False)}", f"kind: {self.part.kind}", "specimens:"]
        lines += [f"  - compound: {json.dumps(compound, ensure_ascii=False)}" for compound in self.compounds]
        lines += self.part.begins.replace("REPEATS", _quoted(self.repeats)).splitlines()
        lines += ["grids:", "  - name: conditions"]
        for axis in self.axes:
            values = self.values.get(axis.name, [])
            if values and values != [self.default_of(axis)]:
                lines.append(f"    {axis.name}: [{', '.join(map(_quoted, values))}]")
        return "\n".join(lines) + "\n"

    def _tried(self, attribute: str, answer: Answer, line: str) -> Answer:
        former = getattr(self, attribute)
        setattr(self, attribute, answer)
        try:
            self._refuse(line)
        finally:
            setattr(self, attribute, former)
        return answer

    def _refuse(self, begins: str) -> None:
        """Raise InvalidSource with the problems on the lines that begin so; other answers may still be missing."""
        from tester.inputs.recipe.loader import check

        text = self.text()
        lines = [number for number, line in enumerate(text.splitlines(), 1) if line.startswith(begins)]
        problems = [one for one in check(text, self.rig, self.part) if one.line in lines]
        if problems:
            raise InvalidSource(problems)


def _listed(text: str) -> list[str]:
    """Return the texts between commas; raises ValueError if there are none."""
    found = [part.strip() for part in text.split(",") if part.strip()]
    if not found:
        raise ValueError("expected at least one value")
    return found


def _quoted(text: str) -> str:
    return text if _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)
