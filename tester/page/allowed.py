"""What a page may command: one table by the command's name. A command that is not in it is refused.

Manual mode, commissioning, overrides, accepted risks, answers of a person at the rig and running without a person's
answers (``yes``) belong to the terminal at the machine: they are in no row, or excluded by ``TERMINAL_ONLY``.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields, is_dataclass
from pathlib import PurePath
from typing import Final

from pydantic import TypeAdapter

from tester.page.roles import Role, includes
from tester.service.commands import Action

ACTION: Final[TypeAdapter[Action]] = TypeAdapter(Action)
TERMINAL: Final = "not from a page: use the terminal at the machine (`tester tui`)"
TERMINAL_ONLY: Final = ("overrides", "yes", "rig", "accept_risk")
"""Options of any command that a page may not set: what they loosen is decided at the machine."""


def always(_action: object) -> bool:
    """Return True: the action needs a code each time."""
    return True


def never(_action: object) -> bool:
    """Return False: the action needs no code."""
    return False


def forced(action: object) -> bool:
    """Return whether control is taken by force from another client."""
    return bool(getattr(action, "force", True))


@dataclass(frozen=True, slots=True)
class PageRule:
    """Which role may send a command, and whether it needs a new code from the machine's screen."""

    role: Role
    code: Callable[[object], bool] = never


ALLOWED: Final[Mapping[str, PageRule]] = {
    "stop": PageRule("stop"),
    "hold": PageRule("control"),
    "release": PageRule("control"),
    "control": PageRule("control", forced),
    "run": PageRule("control", always),
    "resume": PageRule("control", always),
    "ack": PageRule("control", always),
    "check": PageRule("look"),
    "plan": PageRule("look"),
    "recipes": PageRule("look"),
    "runs": PageRule("look"),
    "note": PageRule("control"),
    "exclude": PageRule("control"),
    "queue_add": PageRule("control"),
    "queue_move": PageRule("control"),
    "queue_skip": PageRule("control"),
    "queue_drop": PageRule("control"),
    "queue_stand": PageRule("control"),
    "queue_start": PageRule("control", always),
    "queue_check": PageRule("look"),
    "queue_list": PageRule("look"),
}
"""The commands of a page (tester.service.commands). STOP goes to the stop door, every other one to the service."""


class NotAllowedError(Exception):
    """A page may not send this; the message gives the reason."""


def rule_of(action: object, role: Role) -> PageRule:
    """Return the rule of an action that a role may send. Raises NotAllowedError."""
    name = str(getattr(action, "command", ""))
    rule = ALLOWED.get(name)
    if rule is None:
        raise NotAllowedError(f"{name}: {TERMINAL}")
    for option in TERMINAL_ONLY:
        if getattr(action, option, None):
            raise NotAllowedError(f"{name} with {option}: {TERMINAL}")
    if not includes(role, rule.role):
        raise NotAllowedError(f"{name} needs the role {rule.role}, and this page has {role}")
    return rule


def outside(action: object, recipes: Collection[str]) -> str:
    """Return why an action names a file that a page may not name; "" if it does not.

    A page names a recipe of the service's list (``recipes``) or sends its text, and a run by its name: what else is on
    this machine's disk is no business of a browser, and an error message would quote it.
    """
    recipe, run = str(getattr(action, "recipe", "")), str(getattr(action, "run", ""))
    if recipe and not getattr(action, "text", "") and recipe not in recipes:
        return f"{recipe}: not a recipe of the service's list"
    if run and (run != PurePath(run).name or run in (".", "..") or "\\" in run):
        return f"{run}: a run is named without a folder here"
    return ""


def in_words(action: object) -> str:
    """Return an action in words for the machine's screen: its command and the options that are set."""
    words = [str(getattr(action, "command", ""))]
    if is_dataclass(action):
        for field in fields(action):
            value = getattr(action, field.name)
            if field.name not in ("command", "text") and value not in ("", None, (), False):
                words.append(f"{field.name} {value}")
    return ", ".join(words)[:200]
