"""A person's hand on a kind's axes, in manual mode."""

from __future__ import annotations

from typing import Any

from tester.machine.motions import ZeroOfCell


class Hand:
    """Moves a kind's axes for a person. Methods return "", or the reason for refusing; ``ctx`` is the kind's own."""

    def __init__(self) -> None:
        """Begin with nothing requested."""
        self.taring: ZeroOfCell | None = None
        """The zero of the load cell that is being taken."""
        self.tare_text = ""
        """The newest zero of the load cell in words, "" before the first."""

    @property
    def busy(self) -> str:
        """Why no step is possible at present; "" if a step is possible."""
        return "the load cell is being tared" if self.taring is not None else ""

    def follow(self, ctx: Any) -> None:
        """Write the demand, and advance a tare under way; called in every scan."""
        self.demand(ctx)
        taring = self.taring
        if taring is not None and taring.step(ctx):
            self.taring = None
            if taring.failed:
                self.tare_text = f"not taken: {taring.failed}"
            else:
                self.tare_text = f"zero from {taring.count} readings: {self.zero(ctx)}"
            ctx.journal.event(ctx.now, "tare", self.tare_text)

    def demand(self, ctx: Any) -> None:
        """Write the demand that results from the steps so far."""
        raise NotImplementedError

    def step(self, ctx: Any, axis: str, sign: float) -> str:
        """Take one step of an axis from the kind's table, up (+1) or down (-1)."""
        raise NotImplementedError

    def tare(self, ctx: Any) -> str:
        """Begin to zero the load cell."""
        raise NotImplementedError

    def zero(self, ctx: Any) -> str:
        """Return the zero of the load cell in words, once it has been taken."""
        raise NotImplementedError
