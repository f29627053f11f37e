"""Every command of the protocol, in every role: a page may send the listed ones, all others are refused."""

from __future__ import annotations

from dataclasses import MISSING, fields
from typing import Any, get_args

import pytest

from tester.page.allowed import ACTION, ALLOWED, TERMINAL_ONLY, NotAllowedError, in_words, outside, rule_of
from tester.page.roles import ROLES, Role, includes
from tester.service import commands
from tester.service.commands import Acknowledge, ResumeRun, RunRecipe, ShowPlan, TakeControl


def classes() -> list[type[Any]]:
    """Return every command of the protocol."""
    union = get_args(commands.Action)[0]
    return list(get_args(union))


FILLED = {
    "recipe": "quickstart", "run": "r", "axis": "press", "direction": 1, "number": 1, "id": 1, "revision": 1,
    "start": "18:00", "end": "08:00", "condition": 1,
}  # fmt: skip


def made(command: type[Any]) -> Any:
    """Return a command with its required keys filled."""
    given: dict[str, Any] = {"command": command.__dataclass_fields__["command"].default}
    for field in fields(command):
        if field.default is MISSING and field.default_factory is MISSING:
            given[field.name] = FILLED.get(field.name, "x")
    return ACTION.validate_python(given)


NEVER = {"arm", "attend", "jog", "tare", "answer", "frames"}
"""Commands that only the terminal may send."""
BY_ROLE = {
    "look": {"check", "plan", "recipes", "runs"},
    "stop": {"stop"},
    "control": {"hold", "release", "control", "run", "resume", "ack", "note", "exclude"},
}


@pytest.mark.parametrize("role", ROLES)
@pytest.mark.parametrize("command", classes(), ids=lambda command: command.__name__)
def test_every_command_in_every_role(command: type[Any], role: Role) -> None:
    action = made(command)
    may = {name for one in ROLES if includes(role, one) for name in BY_ROLE[one]}
    queued = action.command.startswith("queue_")
    if action.command in may or (queued and includes(role, ALLOWED[action.command].role)):
        assert includes(role, rule_of(action, role).role)
    else:
        with pytest.raises(NotAllowedError, match="terminal" if action.command in NEVER else "needs the role"):
            rule_of(action, role)


def test_a_command_that_the_table_does_not_know_is_refused() -> None:
    class Tomorrow:
        command = "spin_up"

    with pytest.raises(NotAllowedError, match="terminal"):
        rule_of(Tomorrow(), "control")


@pytest.mark.parametrize(
    ("action", "code"),
    [
        (RunRecipe("quickstart"), True), (ResumeRun("r"), True), (Acknowledge(), True), (Acknowledge(3), True),
        (TakeControl(force=True), True), (TakeControl(), False), (commands.Hold(), False), (commands.Stop(), False),
    ],
)  # fmt: skip
def test_which_commands_need_a_code_from_the_machines_screen(action: Any, code: bool) -> None:
    assert rule_of(action, "control").code(action) is code


@pytest.mark.parametrize(
    "action",
    [
        RunRecipe("quickstart", overrides=("limits.load=1 N",)), RunRecipe("quickstart", yes=True),
        RunRecipe("quickstart", rig="other.yaml"), ResumeRun("r", yes=True), ShowPlan("quickstart", rig="/etc/passwd"),
    ],
)  # fmt: skip
def test_options_that_loosen_something_belong_to_the_terminal(action: Any) -> None:
    assert any(getattr(action, option, None) for option in TERMINAL_ONLY)
    with pytest.raises(NotAllowedError, match="terminal"):
        rule_of(action, "control")


@pytest.mark.parametrize(
    "action",
    [ShowPlan("/etc/passwd"), RunRecipe("../x.yaml"), ResumeRun("../r"), ResumeRun(".."), ResumeRun("a\\b")],
)
def test_a_page_names_no_file_of_the_machine(action: Any) -> None:
    assert outside(action, ["quickstart"])


@pytest.mark.parametrize("action", [ShowPlan("quickstart"), ShowPlan("mine", text="recipe: x"), ResumeRun("r-1")])
def test_a_page_names_recipes_of_the_list_and_runs(action: Any) -> None:
    assert not outside(action, ["quickstart"])


def test_the_screen_shows_what_a_code_allows() -> None:
    assert in_words(RunRecipe("quickstart", seed=3)) == "run, recipe quickstart, seed 3, speed 1.0"
