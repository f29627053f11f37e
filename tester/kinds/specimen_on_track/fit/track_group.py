"""Groups of conditions that are fitted together, and their text."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from tester.kinds.specimen_on_track.axes import INTERFACES

_TEXT: Final = re.compile(rf"(.*), ({'|'.join(INTERFACES)})(?: on (.*))?", re.DOTALL)


class TrackGroup(NamedTuple):
    """Conditions that are fitted together: one compound, interface and surface ("" if the run names none)."""

    compound: str
    interface: str
    surface: str

    @property
    def text(self) -> str:
        """Return the group as people read it."""
        return f"{self.compound}, {self.interface}" + (f" on {self.surface}" if self.surface else "")


def group_of(text: str) -> TrackGroup:
    """Return the group of a text that ``TrackGroup.text`` made."""
    match = _TEXT.fullmatch(text)
    if match is None:
        return TrackGroup(text, INTERFACES[0], "")
    compound, interface, surface = match.groups()
    return TrackGroup(compound, interface, surface or "")
