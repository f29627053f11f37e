"""The attendant of a real rig."""

from __future__ import annotations

from collections.abc import Callable


class NoAttendant:
    """Does nothing for every request of a kind: on a real rig, people do the work before they answer the prompt."""

    def __getattr__(self, name: str) -> Callable[..., None]:
        """Return a call that does nothing, for any public name."""
        if name.startswith("_"):
            raise AttributeError(name)
        return _nothing


def _nothing(*_: object, **__: object) -> None:
    """Do nothing."""
