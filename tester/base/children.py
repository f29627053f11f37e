"""How a process of ours is started: with this Python, and with no module of the working folder in the way of ours.

``-P`` (Python 3.11) leaves the working folder out of the search path: a stray ``hmac.py`` or ``types.py`` in a folder
of recipes is nobody's module.
"""

from __future__ import annotations

import sys

_COMMAND = "from tester.cli.main import main; main()"


def tester_command(*arguments: str) -> list[str]:
    """Return the command line of ``tester ARGUMENTS`` as a process of its own."""
    return [sys.executable, "-P", "-c", _COMMAND, *arguments]


def module_command(module: str, *arguments: str) -> list[str]:
    """Return the command line that runs one of our modules as a process of its own."""
    return [sys.executable, "-P", "-m", module, *arguments]
