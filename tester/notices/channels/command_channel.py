"""A command of the user: JSON on its standard input, the main values in its environment; no shell."""

from __future__ import annotations

import os
import shlex
import subprocess
from typing import Final

from pydantic_core import to_json

from tester.base.trouble import in_words
from tester.notices.channels.letter import Letter, NotDeliveredError
from tester.notices.notice_settings import CommandSection
from tester.notices.secrets_file import without_secrets

COMMAND_WITHIN_S: Final = 30.0
"""Time after which the command is killed, s [A]."""


class CommandChannel:
    """Runs the command."""

    def __init__(self, section: CommandSection) -> None:
        """Run nothing yet."""
        self.section = section

    def send(self, letter: Letter, place: str) -> None:
        """Run the command for a letter; its exit code 0 confirms it. Raises NotDeliveredError."""
        notice = letter.notice
        shown = {"event": notice.cause.value, "text": notice.what, "run": notice.run, "folder": notice.folder}
        more = {"utc": notice.since_utc, "subject": letter.subject, "message": letter.text, "rig": notice.rig}
        variables = {f"TESTER_{key.upper()}": value.replace("\0", "") for key, value in shown.items()}
        try:
            arguments = shlex.split(self.section.run)
            done = subprocess.run(
                arguments, input=to_json(shown | more), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                env=without_secrets(os.environ) | variables, timeout=COMMAND_WITHIN_S, check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired as error:
            raise NotDeliveredError(f"the command was ended after {COMMAND_WITHIN_S:g} s", final=True) from error
        except (OSError, ValueError) as error:
            raise NotDeliveredError(f"the command does not start: {in_words(error)}", final=True) from error
        if done.returncode:
            words = done.stderr.decode("utf-8", "replace").strip()[-200:]
            raise NotDeliveredError(f"the command ends with exit code {done.returncode} {words}".strip(), final=True)
