"""``notices-secrets.yaml``: passwords and tokens, readable by their owner alone; or the environment.

No message here repeats a value, not even that of a mistake.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Final

from tester.base.source import InvalidSource, Problem, load_tree
from tester.base.trouble import in_words
from tester.base.user_folders import config_folder
from tester.notices.notice_settings import read_settings, settings_path

FILE: Final = "notices-secrets.yaml"
VARIABLES: Final = {
    "mail_password": "TESTER_MAIL_PASSWORD",
    "ntfy_token": "TESTER_NTFY_TOKEN",
    "apprise": "TESTER_APPRISE",
}
"""Environment variables by their keys in the file; a variable counts before the file."""
MODE: Final = 0o600
SHORTEST: Final = 4
"""Shortest secret that ``hidden`` looks for [A]: a shorter one would blot out parts of ordinary words."""


@dataclass(frozen=True, slots=True)
class NoticeSecrets:
    """What must not be shown; "" where there is none. ``apprise``: Apprise's addresses, separated by blanks."""

    mail_password: str = field(default="", repr=False)
    ntfy_token: str = field(default="", repr=False)
    apprise: str = field(default="", repr=False)

    def hidden(self, text: str) -> str:
        """Return a text, such as a server's answer, with every secret in it replaced."""
        for one in (self.mail_password, self.ntfy_token, *self.apprise.split()):
            if len(one) >= SHORTEST:
                text = text.replace(one, "(secret)")
        return text


def read_secrets(path: Path, environment: Mapping[str, str]) -> NoticeSecrets:
    """Return the secrets of a file, which need not exist, and of the environment.

    Raises InvalidSource for a file that others may read (POSIX), and for one with mistakes.
    """
    found = _read(path) if path.exists() else {}
    found |= {key: environment[name] for key, name in VARIABLES.items() if environment.get(name)}
    return NoticeSecrets(**found)


def secrets_path() -> Path:
    """Return the place of the secrets, which need not exist."""
    return config_folder() / FILE


def without_secrets(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment for a command that needs no secrets."""
    return {name: value for name, value in environment.items() if name not in VARIABLES.values()}


def settings_trouble(command: str = "") -> tuple[str, ...]:
    """Return why the user's settings or secrets cannot be used, a line each; none if they can."""
    try:
        read_settings(settings_path(), command)
        read_secrets(secrets_path(), os.environ)
    except InvalidSource as error:
        return tuple(map(str, error.problems))
    except OSError as error:
        return (in_words(error),)
    return ()


def _read(path: Path) -> dict[str, str]:
    if os.name == "posix":
        status = path.stat()
        if status.st_uid != os.getuid():
            raise _refused(path, "it belongs to another user", f"its owner to be you: chown {os.getuid()} {path}")
        wide = stat.S_IMODE(status.st_mode)
        if wide & ~MODE:
            raise _refused(path, f"others may read it (mode {wide:04o})", f"mode 0600: chmod 600 {path}")
    try:
        tree = load_tree(path)
    except InvalidSource as error:
        first = error.problems[0]
        raise InvalidSource([Problem(first.file, first.line, first.column, "not valid YAML")]) from None
    keys = [one.name for one in fields(NoticeSecrets)]
    if not isinstance(tree.data, dict):
        raise InvalidSource([Problem(tree.name, 1, 1, f"expected keys with values: {', '.join(keys)}")])
    problems: list[Problem] = []
    found: dict[str, str] = {}
    for key, value in tree.data.items():
        line, column = tree.key_position((key,))
        if key not in keys:
            problems.append(Problem(tree.name, line, column, f"unknown key (expected one of {', '.join(keys)})"))
        elif not isinstance(value, str) or not value or not value.isprintable():
            what = f"{key}: the value is not accepted (expected one line of text, in quotes)"
            problems.append(Problem(tree.name, *tree.position((key,)), what))
        else:
            found[key] = value
    if problems:
        raise InvalidSource(problems)
    return found


def _refused(path: Path, why: str, expected: str) -> InvalidSource:
    return InvalidSource([Problem(str(path), 1, 1, f"not read: {why} (expected {expected})")])
