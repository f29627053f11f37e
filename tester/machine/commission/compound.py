"""The compound of the first specimen, and whether a coefficient can be that of its compound."""

from __future__ import annotations

from collections.abc import Generator, Iterable
from dataclasses import dataclass
from typing import Any, Final

from tester.machine.commission.commission_step import Notes, StepRefused, Waits, choose, line

WARNED_SHARE: Final = 0.25
REFUSED_SHARE: Final = 0.5
"""Deviation of a first coefficient from its compound's model that gives a warning, or a refusal [A]: the paper's
compounds are a quarter to a third apart."""
LEAST_MU, MOST_MU = 0.1, 3.0
"""Range for rubber on an abrasive, of any composition [A]: the wheel's paper has 0.31 to 2.59."""


def ask_compound(notes: Notes, known: Iterable[str], piece: str) -> Generator[Waits, str, str]:
    """Return the compound, as given on the command line or by the person; ``piece``: what is made of it."""
    named = notes.given.get("compound", "")
    if named:
        answer = yield from choose("compound given", f"is the {piece} of the compound {named}?", "yes", "no")
        if answer == "yes":
            return named
    text = f"which compound is the {piece} of? The expected coefficient is known for {', '.join(known)}"
    return (yield from line("compound", f"{text}; any other name will do"))


@dataclass(frozen=True, slots=True)
class FirstCoefficient:
    """The first coefficient of a rig."""

    compound: str
    mu: float
    expected: float | None
    """What the compound's model gives; None: it has none."""
    causes: str
    """Likely causes of an impossible coefficient, for people."""
    weaker_causes: str
    """Likely causes of a doubtful one."""

    def plausible(self, notes: Notes) -> dict[str, Any]:
        """Compare with the model, and return what to record; raises StepRefused for an impossible coefficient.

        A counterface of another grade, or another laboratory's mix of the compound, changes it by some tens of per
        cent. A wrong scale or zero that passed the earlier steps, or a wrong compound, changes it more.
        """
        mu, compound, expected = self.mu, self.compound, self.expected
        if expected is None:
            if not LEAST_MU <= mu <= MOST_MU:
                raise StepRefused(f"coefficient {mu:.3f}: rubber on an abrasive has {LEAST_MU:g} to {MOST_MU:g}")
            notes.tell(f"  {compound} is unknown: its coefficient must be between {LEAST_MU:g} and {MOST_MU:g}")
            return {"expected_mu": None}
        off = mu / expected - 1.0
        text = f"coefficient {mu:.3f} of {compound} is {100 * off:+.0f} % off what its model gives, {expected:.3f}"
        if not abs(off) <= REFUSED_SHARE:
            raise StepRefused(f"{text} (more than {100 * REFUSED_SHARE:g} %): {self.causes}")
        if abs(off) > WARNED_SHARE:
            notes.tell(f"  {text}: {self.weaker_causes}")
        return {"expected_mu": expected, "off_share": off}


def first_text(compound: str, results: Any) -> str:
    """Return the result of a first condition in words; ``results``: of the run (tester.run.commission_run)."""
    row: dict[str, Any] = results["conditions"][0]
    spread = f"{100 * row['s'] / row['mu']:.1f} % between its {row['n']} repeats" if row["s"] is not None else ""
    uncertain = f", U {row['expanded']:.3f} (95 %)" if row["expanded"] is not None else ""
    return f"coefficient of {compound} {row['mu']:.3f}{uncertain}; {spread}; run {results['run']}"
