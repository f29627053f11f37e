"""The hardness that a person reads at mounting: asked with the question to mount, recorded, held against the belief."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final

from tester.base.units import SHORE_A
from tester.inputs.recipe.hardness import BelievedHardness
from tester.machine.prompts import DONE, Prompt

if TYPE_CHECKING:
    from tester.machine.context import AnyContext

NO_PERSON: Final = "automatic"
"""Who read a hardness in the record of a question that answered itself."""


@dataclass(frozen=True, slots=True)
class HardnessBelief:
    """What a run believes of its compounds' hardness, and how a simulated person reads one."""

    of_compound: Mapping[str, BelievedHardness] = field(default_factory=dict[str, BelievedHardness])
    """By the compound's name; those whose file states none are missing."""
    read: Callable[[int, float], float] | None = None
    """Returns a reading, Shore A, of the piece with this number and this true hardness; None at a real machine."""

    def by_itself(self, piece: int, compound: str) -> str:
        """Return the answer without a person: a reading of the compound's own hardness, DONE where that is unknown."""
        believed = self.of_compound.get(compound)
        if believed is None or self.read is None:
            return DONE
        return f"{self.read(piece, believed.shore_a):.1f} {SHORE_A}"


def with_hardness(text: str) -> str:
    """Return the question to mount with the request for a hardness."""
    return f"{text}; answer with its hardness, such as 64.5 {SHORE_A} (yes: not measured)"


def keep_hardness(ctx: AnyContext, prompt: Prompt, piece: int, compound: str) -> None:
    """Record the hardness in a prompt's answer for a mounted piece; a doubt where the compound's file has another."""
    shore_a = prompt.quantity
    if shore_a is None:
        ctx.journal.event(ctx.now, "hardness", f'no hardness read at piece {piece}: "{prompt.answer}"')
        return
    ctx.journal.hardness(piece, shore_a, NO_PERSON if prompt.by_itself else prompt.by)
    ctx.journal.event(ctx.now, "hardness", f"{shore_a:g} {SHORE_A} read at piece {piece}")
    believed = ctx.hardness.of_compound.get(compound)
    doubt = believed.doubt(compound, shore_a) if believed is not None else ""
    if doubt:
        ctx.journal.event(ctx.now, "doubt", f"hardness of piece {piece}: {doubt}", "warning")
