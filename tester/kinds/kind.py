"""What a kind of rig brings: the list of everything that the rest of the program asks a kind for.

A kind is a package: ``tester.kinds.<name>``, or a laboratory's own. Its ``KIND`` is found by name in one place
(tester.kinds.find), and ``tester.run.kind_lookup`` asks it for the rest of the program. Making a ``KIND`` imports
nothing: what is large is named by its place and imported when it is asked for::

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
    from tester.analysis.papers.item import Paper
    from tester.base.axes import Axis
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.inputs.rig import Rig
    from tester.machine.commission.commission_step import CommissionPart
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

    A kind of which no recipe can be run has a rig file and interlocks to look at; the rest it may leave out.
    """

    name: str
    """As the key ``kind`` of a rig file says it."""
    title: str
    """What people call it, in a few words."""
    measurand: str = ""
    """What its coefficient is, for people, in words that follow "measured was"; "" where nothing is to be said."""
    rigs: Mapping[str, str]
    """Rig files that ship with it, by the names that ``--rig`` takes: ``package:file``, the first for a start."""
    rig: Callable[[], type[Rig]]
    """How its rig file is read: its sections, the keys that a file may lack, safety keys, checks, and the table of
    its channels (tester.inputs.rig.Rig)."""
    interlocks: Callable[[], InterlockSheet]
    """The rows of its interlock table, as its page and its rig files show them."""
    page: str
    """Its page of interlocks and safety keys, whose tables ``python docs/interlocks.py`` writes."""
    runs: Callable[[], KindRun] | None = None
    """How its runs are built, and what goes with them."""
    served: Callable[[], ServedKind] | None = None
    """What it answers a service."""
    recipe: Callable[[], RecipePart] | None = None
    """What it says about recipes; None: none can be read for it."""
    fits: Callable[[], FitPart] | None = None
    """Which laws can be fitted to its conditions; None: none."""
    papers: Callable[[], tuple[Paper, ...]] | None = None
    """Papers that its machine or its laws come from, each item with a verdict; None: none."""
    masters: Callable[[], MasterPart] | None = None
    """How its conditions stand on a master curve, and when not; None: they have no speed and temperature."""
    commissions: Callable[[], CommissionPart] | None = None
    """How a rig of it is commissioned; None: nobody is guided."""
    ring: Callable[[], RingPart] | None = None
    """The ring over which a device on a turning part is reached; None: there is none."""

    def extended(
        self, name: str, title: str, *, rows: Iterable[Interlock[Any]] = (), axes: Iterable[Axis] = (), **parts: Any
    ) -> Kind:
        """Return a kind of a laboratory's own: this one with further interlock rows and axes, ahead of its own.

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
