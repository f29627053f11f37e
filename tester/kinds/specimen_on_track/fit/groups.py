"""Which conditions are fitted together: those of one compound, one interface and one surface."""

from __future__ import annotations

import re
from typing import Final, NamedTuple

from tester.kinds.specimen_on_track.axes import INTERFACES

_TEXT: Final = re.compile(rf"(.*), ({'|'.join(INTERFACES)})(?: on (.*))?", re.DOTALL)


class TrackGroup(NamedTuple):
    """A group; ``surface`` is the name of the track's covering, "" where the run does not say it."""

    compound: str
    interface: str
    surface: str

    @property
    def text(self) -> str:
        """Return it as people read it."""
        return f"{self.compound}, {self.interface}" + (f" on {self.surface}" if self.surface else "")


def group_of(text: str) -> TrackGroup:
    """Return the group that ``TrackGroup.text`` has told."""
    found = _TEXT.fullmatch(text)
    if found is None:
        return TrackGroup(text, INTERFACES[0], "")
    compound, interface, surface = found.groups()
    return TrackGroup(compound, interface, surface or "")
