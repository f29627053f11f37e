"""The digital inputs and outputs at a drive: safety chain, guard, and the contactor it switches (docs/safety.md)."""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.digital_io import CONTACTOR, GUARD, REQUEST, SAFETY_CHAIN

PULL_IN_S: Final = 0.03
"""Time from the request to the feedback of a small power contactor, s [A]."""
DROP_OUT_S: Final = 0.02
"""Time from the end of the request or of the safety chain to the feedback, s [A]."""


class SafetyIo:
    """Inputs as levels, and a contactor that needs both the request and a healthy safety chain.

    ``contactor_closed`` is the state of its power contacts; ``due_s`` is the time of its next movement; ``welded``
    contacts do not open; ``requested``: the program requests a closed contactor.
    """

    def __init__(self) -> None:
        """Start with a healthy chain, a closed guard and the contactor open."""
        self._chain = True
        self._guard = True
        self.requested = False
        self._coil = True
        self.welded = False
        self.contactor_closed = False
        self.due_s = inf

    @property
    def inputs(self) -> int:
        """The word of 0x60FD."""
        return self._chain * SAFETY_CHAIN | self._guard * GUARD | self.contactor_closed * CONTACTOR

    def set_chain(self, healthy: bool, t: float) -> None:
        """Open or close the safety chain at ``t`` s."""
        self._chain = healthy
        self._aim(t)

    def set_guard(self, closed: bool) -> None:
        """Open or close the guard."""
        self._guard = closed

    def set_outputs(self, word: int, t: float) -> bool:
        """Apply the word of 0x60FE:01, masked by :02, at ``t`` s; return whether the request changed."""
        requested = bool(word & REQUEST)
        if requested == self.requested:
            return False
        self.requested = requested
        self._aim(t)
        return True

    def fire(self, t: float) -> bool:
        """Move the contactor when it is due by ``t`` s; return whether it moved."""
        if self.due_s > t:
            return False
        self.due_s = inf
        if self.welded and self.contactor_closed:
            return False
        self.contactor_closed = not self.contactor_closed
        return True

    def release(self, t: float) -> None:
        """Free welded contacts at ``t`` s."""
        self.welded = False
        self._aim(t)

    def break_coil(self, broken: bool, t: float) -> None:
        """Open the coil's circuit at ``t`` s, or repair it."""
        self._coil = not broken
        self._aim(t)

    def _aim(self, t: float) -> None:
        wanted = self.requested and self._chain and self._coil
        if wanted == self.contactor_closed:
            self.due_s = inf
        elif self.due_s == inf:
            self.due_s = t + (PULL_IN_S if wanted else DROP_OUT_S)
