"""The amount of measurement."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

T = TypeVar("T")


class TopicFailedError(Exception):
    """A topic has nothing to measure, because its run failed; the message gives the reason."""


@dataclass(frozen=True, slots=True)
class Effort:
    """``runs`` of every figure; ``quick``: shorter ones, for a first look."""

    runs: int = 3
    quick: bool = False

    def pick(self, full: T, quick: T) -> T:
        """Return the value for this effort."""
        return quick if self.quick else full
