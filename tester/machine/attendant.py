"""The attendant of a real rig."""

from __future__ import annotations

from collections.abc import Callable


class NoAttendant:
    """Does nothing, whatever a kind asks of the hands at its rig: people have answered the prompts."""

    def __getattr__(self, name: str) -> Callable[..., None]:
        """Return a call that does nothing, for any public name."""
        if name.startswith("_"):
            raise AttributeError(name)
        return _nothing


def _nothing(*_: object, **__: object) -> None:
    """Do nothing."""
