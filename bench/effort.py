"""How much is measured."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

T = TypeVar("T")


class TopicFailedError(Exception):
    """A topic has nothing to measure: what it runs did not do what it should. The message says so."""


@dataclass(frozen=True, slots=True)
class Effort:
    """``runs`` of every figure; ``quick``: shorter ones, for a look."""

    runs: int = 3
    quick: bool = False

    def pick(self, full: T, quick: T) -> T:
        """Return the one that is meant."""
        return quick if self.quick else full
