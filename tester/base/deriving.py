"""What lets a class that stays Python derive from a compiled one: a laboratory's own kind of rig, from its bases.

In plain Python both decorators change nothing that a program can notice.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar, dataclass_transform

if TYPE_CHECKING:
    from mypy_extensions import mypyc_attr as mypyc_attr
else:

    def mypyc_attr(**_: object):
        """Return a decorator that leaves a class as it is: only the compiler reads the keywords."""
        return lambda cls: cls


T = TypeVar("T")


@dataclass_transform()
def derivable(cls: type[T]) -> type[T]:
    """Make a dataclass that lists the fields of its compiled base as slots, for what derives from it.

    ``dataclass(slots=True)`` makes a slot for every field that no base lists, and a compiled base lists none: the
    base's code would then read its own empty fields, not the new slots. Without ``slots`` nothing hides them.
    """
    made = dataclass(cls)
    made.__slots__ = tuple(made.__dataclass_fields__)  # type: ignore[attr-defined]
    return made
