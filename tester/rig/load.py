"""A rig file, with `--set` overrides, to a checked RigConfig."""

from __future__ import annotations

from collections.abc import Sequence
from copy import deepcopy
from importlib.resources import files
from pathlib import Path

from tester.config_reader import read
from tester.rig.checks import problems_of
from tester.rig.config import RigConfig
from tester.rig.press import with_torque_limit
from tester.source import InvalidSource, Problem, Tree, Value, load_tree

SIMULATED = "sim"
"""Name of the packaged simulated rig."""

_AXES = ("wheel", "belt", "press", "sideslip", "camber")
_MAY_BE_MANUAL = ("sideslip", "camber")


def load_rig(name_or_path: str | Path = SIMULATED, overrides: Sequence[str] = ()) -> RigConfig:
    """Return the rig of a file, or the packaged simulated one for "sim".

    ``overrides`` are ``a.b.c=value`` texts, each replacing one key of the file; the value is read as in the file.
    Raises InvalidSource with every problem; one that an override brought in is named by it.
    """
    tree = load_tree(packaged_text(), "sim/rig.yaml") if name_or_path == SIMULATED else load_tree(Path(name_or_path))
    texts = tuple(overrides)
    if not texts:
        return _checked(tree)
    _checked(deepcopy(tree))  # what is wrong with the file itself is told first, and as such
    problems = [problem for number, text in enumerate(texts) for problem in _override(tree, text, number)]
    if problems:
        raise InvalidSource(problems)
    try:
        return _checked(tree)
    except InvalidSource as error:
        raise InvalidSource([_attributed(problem, texts) for problem in error.problems]) from error


def load_rig_text(text: str, name: str = "rig.yaml") -> RigConfig:
    """Return the rig of a file's text, such as a run has stored; raises InvalidSource with every problem."""
    return _checked(load_tree(text, name))


def _checked(tree: Tree) -> RigConfig:
    """Return a tree as a rig whose sections fit together; changes the tree."""
    _complete(tree)
    rig = with_torque_limit(read(RigConfig, tree))
    problems = problems_of(rig, tree)
    if problems:
        raise InvalidSource(problems)
    return rig


def packaged_text() -> str:
    """Return the file of the simulated rig as it is shipped."""
    return (files("sim") / "rig.yaml").read_text(encoding="utf-8")


def _override(tree: Tree, text: str, number: int) -> list[Problem]:
    """Put one override into the tree, at positions that lead back to it; return what is wrong with it."""
    path, equals, value_text = text.partition("=")
    keys = [key.strip() for key in path.split(".")]
    if not equals or not all(keys):
        return [_problem(text, "expected key.key=value")]
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
        # A section that refuses a value is named by its own place: that, too, leads to the override.
        tree.positions[here] = tree.keys[here] = (-1 - number, 1)
        if depth == len(keys) - 1:
            section[key] = value
            break
        inner = section.setdefault(key, {})
        if not isinstance(inner, dict):
            return [_problem(text, f"{'.'.join(here)} is a value, it has no keys below it")]
        section = inner
    return []


def _complete(tree: Tree) -> None:
    """Write into every axis what the file says once for all: its name and the heartbeats; ``manual`` becomes None."""
    if not isinstance(tree.data, dict):
        return
    axes, can = tree.data.get("axes"), tree.data.get("can")
    if not isinstance(axes, dict) or not isinstance(can, dict):
        return
    for name in _AXES:
        axis = axes.get(name)
        if not isinstance(axis, dict):
            continue
        if name in _MAY_BE_MANUAL and axis.get("manual") is True and len(axis) == 1:
            axes[name] = None
            continue
        axis.setdefault("name", name)
        for key, source in (("heartbeat", "drive_heartbeat"), ("consumer_heartbeat", "consumer_heartbeat")):
            if source in can:
                axis.setdefault(key, can[source])


def _attributed(problem: Problem, overrides: Sequence[str]) -> Problem:
    """Return a problem under the name of the override that it comes from."""
    return _problem(overrides[-1 - problem.line], problem.message) if problem.line < 0 else problem


def _problem(override: str, message: str) -> Problem:
    return Problem(f"--set {' '.join(override.split())[:80]}", 1, 1, message)
