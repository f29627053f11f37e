"""The parts of a kind of rig: everything that the rest of the program asks a kind for.

A kind is a package: ``tester.kinds.<name>``, or a laboratory's own. Its ``KIND`` is found by name in one place
(tester.kinds.find), and ``tester.run.kind_lookup`` asks it for the rest of the program. Making a ``KIND`` imports
nothing: a large object is named by its place and imported when it is needed::

    KIND = Kind(name="sledge", ..., rig=found_at("lab_sledge.rig:SledgeRig"), runs=found_at("lab_sledge.runs:RUNS"))
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from tester.analysis.fit.fit_part import FitPart
    from tester.analysis.master_curve.points import MasterPart
    from tester.analysis.papers import Paper
    from tester.base.axes import Axis
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.rig import Rig
    from tester.machine.commission.person import CommissionPart
    from tester.machine.interlock_table import InterlockSheet
    from tester.machine.row import Interlock
    from tester.machine.run_parts import KindRun
    from tester.machine.served import ServedKind
    from tester.results.run_results import RingPart


def found_at(place: str) -> Callable[[], Any]:
    """Return a function that imports an object and returns it; ``place``: ``package.module:OBJECT``."""
    return partial(_object, *place.split(":"))


def _object(module: str, name: str) -> object:
    return getattr(import_module(module), name)


@dataclass(frozen=True, slots=True, kw_only=True)
class Kind:
    """One kind of rig.

    A kind that runs no recipe needs only its rig file and interlocks.
    """

    name: str
    """Its name in the key ``kind`` of a rig file."""
    title: str
    """Its name for people, in a few words."""
    measurand: str = ""
    """Meaning of its coefficient for people, in words that follow "measured was"; "" for none."""
    rigs: Mapping[str, str]
    """Rig files that ship with it, as ``package:file`` by the names that ``--rig`` takes; the first is the default."""
    rig: Callable[[], type[Rig]]
    """The rules for reading its rig file: sections, optional keys, safety keys, checks, and the table of its channels
    (tester.inputs.rig.Rig)."""
    interlocks: Callable[[], InterlockSheet]
    """The rows of its interlock table, as its page and its rig files show them."""
    page: str
    """Its page of interlocks and safety keys, whose tables ``python docs/interlocks.py`` writes."""
    runs: Callable[[], KindRun] | None = None
    """The builder of its runs, and their other parts."""
    served: Callable[[], ServedKind] | None = None
    """Its answers to a service."""
    recipe: Callable[[], RecipePart] | None = None
    """Its part of the recipe reader; None: it has no recipes."""
    fits: Callable[[], FitPart] | None = None
    """The laws that can be fitted to its conditions; None: none."""
    papers: Callable[[], tuple[Paper, ...]] | None = None
    """Papers behind its machine or its laws, each item with a verdict; None: none."""
    masters: Callable[[], MasterPart] | None = None
    """Its conditions for a master curve, or reasons against one; None: they have no speed and temperature."""
    commissions: Callable[[], CommissionPart] | None = None
    """The guided commissioning of its rigs; None: there is none."""
    ring: Callable[[], RingPart] | None = None
    """The slip ring between the PC and a device on a turning part; None: there is none."""

    def extended(
        self, name: str, title: str, *, rows: Iterable[Interlock[Any]] = (), axes: Iterable[Axis] = (), **parts: Any
    ) -> Kind:
        """Return a laboratory's own kind: this kind with further interlock rows and axes ahead of its own.

        ``name``: of the new kind, ``module:KIND`` or an extension's; ``parts``: other members in place of this kind's.
        A rig file states the rows' keys, or takes their defaults; control evaluates the rows in every scan::

            KIND = wheel_on_belt.KIND.extended("lab_wheel:KIND", "wheel, its bearing watched", rows=[BEARING_HOT])
        """
        rows, axes = tuple(rows), tuple(axes)
        changed: dict[str, Any] = {"name": name, "title": title, "rigs": {}}
        if rows:
            changed["rig"] = lambda: _extended("rig_with", name, self.rig(), rows)
            changed["interlocks"] = lambda: _extended("sheet_with", self.interlocks(), rows)
        recipe, served = parts.pop("recipe", self.recipe), parts.pop("served", self.served)
        if axes and recipe is not None and served is not None:
            recipe, of_kind = partial(_extended_part, recipe, name, axes), served
            served = lambda: _extended("served_with", of_kind(), recipe())  # noqa: E731
        return replace(self, **changed, recipe=recipe, served=served, **parts)


def _extended(function: str, *arguments: Any) -> Any:
    return getattr(import_module("tester.kinds.extended"), function)(*arguments)


def _extended_part(recipe: Callable[[], RecipePart], name: str, axes: tuple[Axis, ...]) -> Any:
    return _extended("recipe_with", name, recipe(), axes)
