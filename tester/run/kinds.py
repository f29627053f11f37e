"""What the kind of a rig brings: the one place, beside the commands, that looks a kind up."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar

from tester.base.source import InvalidSource, Problem
from tester.kinds import find
from tester.rig import Rig

if TYPE_CHECKING:
    from tester.machine.run_parts import KindRun
    from tester.machine.served import ServedKind
    from tester.recipe.part import RecipePart

Part = TypeVar("Part")


def to_be_run(rig: Rig) -> Rig:
    """Return the rig; raises InvalidSource, as all here, where its kind brings nothing to run a recipe with."""
    _brought(rig, "runs", find(rig.kind).runs)
    return rig


def run_parts(rig: Rig) -> KindRun:
    """Return how runs on a rig are built, and what goes with them."""
    return _brought(rig, "runs", find(rig.kind).runs)()


def served_kind(rig: Rig) -> ServedKind:
    """Return what the kind of a rig answers a service."""
    return _brought(rig, "service", find(rig.kind).served)()


def recipe_part(rig: Rig) -> RecipePart:
    """Return what the kind of a rig says about recipes."""
    return _brought(rig, "recipes", find(rig.kind).recipe)()


def _brought(rig: Rig, what: str, part: Callable[[], Part] | None) -> Callable[[], Part]:
    if part is None:
        said = f"kind: no recipe can be run on a rig of the kind {rig.kind}, for the kind brings no {what}"
        raise InvalidSource([Problem(f"rig {rig.name}", 1, 1, said)])
    return part
