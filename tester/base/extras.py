"""What comes with an extra of the package: how a command says which one to install."""

from __future__ import annotations


class MissingExtraError(Exception):
    """A library that comes with an extra is not installed; the message gives the command that installs it."""


def needs(what: str, library: str, extra: str) -> str:
    """Return the message: ``what`` needs ``library``, and the command that installs it."""
    return f'{what} needs {library}: pip install "friction-tester[{extra}]" (in a clone: pip install ".[{extra}]")'
