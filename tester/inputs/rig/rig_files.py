"""A rig file's tree, with `--set` overrides, to a checked rig of its kind."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from functools import cache
from pathlib import Path
from typing import TypeVar

from drivers.drives import reader
from sim.physics import laws
from tester.base.config_reader import read
from tester.base.source import InvalidSource, Problem, Tree, Value, load_tree
from tester.inputs.rig.checks import problems_of
from tester.inputs.rig.config import Rig
from tester.inputs.rig.packaged import complete, new_tree, resolve
from tester.inputs.rig.profiles import (
    LAW_KEYS,
    NO_COPIES,
    LawCopies,
    extension_drive,
    extension_law,
    is_law_file,
    take_copies,
)
from tester.inputs.rig.risks import Risk, apart, beyond, counts_as_simulated, loosened, redescribed

OneRig = TypeVar("OneRig", bound=Rig)
laws.look_up_with(extension_law)
reader.look_up_with(extension_drive)
MISSING = "only those who built the machine know it: no packaged value can replace it"
"""Message for a key that must be in the file."""
_MAY_TIGHTEN = "and --set may only tighten the file of a real rig"
_DESCRIBES = "and only the file of a real rig describes the machine"


def load(
    kind: type[OneRig], tree: Tree, overrides: Sequence[str] = (), accept_risk: str = "", copies: LawCopies = NO_COPIES
) -> OneRig:
    """Return the rig of a file's tree; changes the tree.

    ``overrides`` are ``a.b.c=value`` texts, each replacing one key of the file; the value is read as in the file.
    ``accept_risk``: why keys may be as ``risks_of`` lists them, "" = they may not. On a real rig only its file loosens
    safety keys and describes the machine: ``overrides`` can tighten, and set what is free. Raises InvalidSource with
    every problem; a problem of an override carries its name.
    """
    texts = tuple(overrides)
    if not texts:
        rig = checked(kind, tree, copies)
        return _accepted(rig, None, tree, accept_risk)
    stated = checked(kind, deepcopy(tree), copies)  # faults of the file itself come first, under its own name
    problems = [problem for number, text in enumerate(texts) for problem in _override(tree, text, number)]
    if problems:
        raise InvalidSource(problems)
    try:
        rig = checked(kind, tree, copies)
        return _accepted(rig, stated, tree, accept_risk)
    except InvalidSource as error:
        raise InvalidSource([_attributed(problem, texts) for problem in error.problems]) from error


def risks_of(rig: Rig) -> tuple[Risk, ...]:
    """Return the keys that a person must accept: looser than the packaged values, or too far from them (``Held``).

    On a harmless rig (``counts_as_simulated``) only those looser than their hardest values.
    """
    if counts_as_simulated(rig):
        return beyond(rig)
    packaged = _packaged(type(rig), rig.like)
    return (*loosened(rig, packaged, packaged=True), *apart(rig, packaged))


@cache
def _packaged(kind: type[OneRig], like: str) -> OneRig:
    tree = new_tree(kind, like)
    return checked(kind, tree)


def _accepted(rig: OneRig, stated: OneRig | None, tree: Tree, reason: str) -> OneRig:
    """Return a rig whose risks are accepted; ``stated``: the file's rig without overrides."""
    if stated is None or (counts_as_simulated(rig) and counts_as_simulated(stated)):
        stated = rig
    loose, another = loosened(rig, stated), redescribed(rig, stated)
    refusals = [(risk, _MAY_TIGHTEN, ", and run with --accept-risk REASON") for risk in loose]
    refusals += [(risk, _DESCRIBES, "") for risk in another]
    problems = [
        tree.problem(risk.location, f"{risk.key}: {risk.compared}, {why} ({risk.because}): write it there{further}")
        for risk, why, further in refusals
    ]
    reported = {risk.location for risk in (*loose, *another)}
    if not reason:
        problems += [
            tree.problem(
                risk.location,
                f"{risk.key}: {risk.compared} ({risk.because}): change it, or accept it: --accept-risk REASON",
            )
            for risk in risks_of(rig)
            if risk.location not in reported
        ]
    if problems:
        raise InvalidSource(problems)
    return rig


def checked(kind: type[OneRig], tree: Tree, copies: LawCopies = NO_COPIES) -> OneRig:
    """Return a tree as a rig with consistent sections, risks or not; changes the tree. Raises InvalidSource."""
    take_copies(tree, copies)
    unstated = complete(kind, tree)
    resolve(kind, tree)
    unstated_keys = [tree.problem(place[:-1], f"{place[-1]} is missing; {MISSING}") for place in unstated]
    try:
        rig = read(kind, tree, MISSING).settled()
    except InvalidSource as error:
        raise InvalidSource([*error.problems, *unstated_keys]) from error
    problems = [*unstated_keys, *problems_of(rig, tree)]
    if problems:
        raise InvalidSource(problems)
    return rig


def _override(tree: Tree, text: str, number: int) -> list[Problem]:
    """Put one override into the tree, at positions that lead back to it; return its faults."""
    path, equals, value_text = text.partition("=")
    keys = [key.strip() for key in path.split(".")]
    if not equals or not all(keys):
        return [_problem(text, "expected key.key=value")]
    if keys[0] == "kind":
        return [_problem(text, "only its file sets the kind of a rig")]
    try:
        value = load_tree(value_text).data if value_text.strip() else None
    except InvalidSource as error:
        return [_problem(text, f"the value: {error.problems[0].message}")]
    if value is None:
        return [_problem(text, "expected a value after =")]
    assert isinstance(tree.data, dict)  # the file has been read as a rig
    section: dict[str, Value] = tree.data
    for depth, key in enumerate(keys):
        here = tuple(keys[: depth + 1])
        # A section that refuses a value is reported at its own place: that must lead to the override as well.
        tree.positions[here] = tree.keys[here] = (-1 - number, 1)
        if depth == len(keys) - 1:
            # Absolute: a run records it, and resumes from any folder.
            law_file = tuple(keys) in LAW_KEYS and isinstance(value, str) and is_law_file(value)
            section[key] = str(Path(value).resolve()) if law_file and isinstance(value, str) else value
            break
        inner = section.setdefault(key, {})
        if not isinstance(inner, dict):
            return [_problem(text, f"{'.'.join(here)} is a value, it has no keys below it")]
        section = inner
    return []


def _attributed(problem: Problem, overrides: Sequence[str]) -> Problem:
    """Return a problem under the name of its override."""
    return _problem(overrides[-1 - problem.line], problem.message) if problem.line < 0 else problem


def _problem(override: str, message: str) -> Problem:
    return Problem(f"--set {' '.join(override.split())[:80]}", 1, 1, message)
