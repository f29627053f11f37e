"""Roles of a paired page, weakest first, and what each of them may do in addition to the one before."""

from __future__ import annotations

from typing import Final, Literal, get_args

Role = Literal["look", "stop", "control"]
ROLES: Final[tuple[Role, ...]] = get_args(Role)
"""look: see the rig and stored runs. stop: also STOP. control: also hold, release, notes, exclusions, the queue."""


def includes(role: Role, needed: Role) -> bool:
    """Return whether a role may do what needs ``needed``."""
    return ROLES.index(role) >= ROLES.index(needed)


def up_to(greatest: Role) -> tuple[Role, ...]:
    """Return the roles up to ``greatest``."""
    return ROLES[: ROLES.index(greatest) + 1]
