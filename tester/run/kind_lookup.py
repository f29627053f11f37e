"""Looks up the parts that a rig's kind provides; only this module and the commands do that."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from tester import kinds
from tester.analysis.ring_errors import RingRun
from tester.base.source import InvalidSource, Problem, read_tree
from tester.inputs.rig import Rig
from tester.inputs.rig.profiles import LawCopies
from tester.kinds import PACKAGED, UnknownKindError, find
from tester.results.run_results import RingPart
from tester.store.run_reader import RunReader

if TYPE_CHECKING:
    from tester.inputs.recipe.loader import LoadedRecipe
    from tester.inputs.recipe.recipe_part import RecipePart
    from tester.machine.run_parts import KindRun
    from tester.machine.served import ServedKind


Part = TypeVar("Part")


def to_be_run(rig: Rig) -> Rig:
    """Return the rig. Raises InvalidSource, as every function here, if its kind cannot run recipes."""
    _brought(rig, "runs", find(rig.kind).runs)
    return rig


def run_parts(rig: Rig) -> KindRun:
    """Return the kind's part that builds runs."""
    return _brought(rig, "runs", find(rig.kind).runs)()


def served_kind(rig: Rig) -> ServedKind:
    """Return the kind's part for the service."""
    return _brought(rig, "service", find(rig.kind).served)()


def recipe_part(rig: Rig) -> RecipePart:
    """Return the kind's part for recipes."""
    return _brought(rig, "recipes", find(rig.kind).recipe)()


def checked_recipe(source: Path | str, rig: Rig, name: str | None = None) -> LoadedRecipe:
    """Return a recipe that a rig can carry out (tester.inputs.recipe.loader.load_checked).

    Raises InvalidSource with every problem. If a recipe does not name its kind, and is clearly written for a packaged
    kind other than the rig's, the error gives only that problem.
    """
    from tester.inputs.recipe.loader import load_checked

    try:
        return load_checked(source, rig, recipe_part(rig), name)
    except InvalidSource as error:
        other = _kind_written_for(source, rig, len(error.problems))
        if not other:
            raise
        first = error.problems[0]
        there = next(iter(find(other).rigs))
        meant = f"the keys are of a recipe for a rig of kind {other} (such as --rig {there})"
        text = f'{meant}, rig "{rig.name}" is of kind {rig.kind}'
        raise InvalidSource([Problem(first.file, first.line, first.column, text)]) from error


def _kind_written_for(source: Path | str, rig: Rig, problems: int) -> str:
    """Return the packaged kind whose schema finds less than half as many problems in a recipe; "" if there is none."""
    from tester.inputs.recipe.loader import validated
    from tester.inputs.recipe.pressures import with_loads

    try:
        tree, _ = read_tree(source)
    except InvalidSource:
        return ""
    if not isinstance(tree.data, dict) or "kind" in tree.data:
        return ""
    for kind in PACKAGED:
        part = find(kind).recipe if kind != rig.kind else None
        if part is not None and 2 * len(validated(with_loads(tree)[0], part())[1]) < problems:
            return kind
    return ""


def _brought(rig: Rig, what: str, part: Callable[[], Part] | None) -> Callable[[], Part]:
    if part is None:
        text = f"kind: a rig of the kind {rig.kind} cannot run recipes, because the kind has no {what}"
        raise InvalidSource([Problem(f"rig {rig.name}", 1, 1, text)])
    return part


def load_rig(
    source: str | Path = kinds.SIMULATED,
    overrides: Sequence[str] = (),
    accept_risk: str = "",
    copies: LawCopies | None = None,
) -> Rig:
    """Return the rig of a file, or the packaged rig of that name (tester.inputs.rig.rig_files.load).

    Raises InvalidSource, also for a valid rig whose kind cannot run recipes.
    """
    return to_be_run(kinds.load_rig(source, overrides, accept_risk, copies))


def load_rig_text(text: str | Path, copies: LawCopies | None = None) -> Rig:
    """Return the rig of a stored text or file; raises InvalidSource as ``load_rig``.

    ``copies``: the copies of kept laws in the run's folder (tester.run.run_materials.law_copies).

    Its risks are not checked here: they were accepted when the run began, and are checked when it resumes
    (tester.run.session).
    """
    return to_be_run(kinds.load_rig_text(text, copies=copies))


@dataclass(frozen=True, slots=True)
class RingFound:
    """A run's record of its ring; ``rig``: the file of its rig."""

    part: RingPart
    run: RingRun
    rig: str


def ring_part(kind: str) -> RingPart | None:
    """Return a kind's ring part; None if it has none, or is not installed."""
    try:
        part = find(kind).ring
    except UnknownKindError:
        return None
    return part() if part is not None else None


def ring_in(folder: Path) -> RingFound | None:
    """Return a run's record of its ring; None if its kind has no ring. Raises StoreError."""
    with RunReader(folder) as reader:
        info = reader.run().info
        part = ring_part(info.kind)
        return RingFound(part, part.of(reader, folder.name), info.rig_source) if part is not None else None


def of_one_rig(found: Sequence[RingFound], like: RingFound) -> list[RingFound]:
    """Return the records that belong to one rig, in order of time: rings of other rigs age separately."""
    return sorted((ring for ring in found if ring.rig == like.rig), key=lambda ring: ring.run.started)
