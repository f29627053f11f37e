"""Who is here: the user and the computer, as people name them."""

from __future__ import annotations

import platform

from tester.base.lock import user
from tester.base.words import harmless

LONGEST = 60
"""Most characters of each name."""


def who_here(role: str, person: str = "") -> str:
    """Return the name under which a program joins a service for a person ("": its user), such as ``ada at lab-pc
    (screen)``.
    """
    host = platform.node().partition(".")[0] or "this computer"
    name, place = (" ".join(harmless(text).split())[:LONGEST] for text in (person or user(), host))
    return f"{name} at {place} ({role})"
