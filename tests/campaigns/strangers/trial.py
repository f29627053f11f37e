"""The outcome of a case: harm in the plant, and what the machine noticed before or after it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from math import inf

from sim.faults import Injection
from sim.faults.cabinet import operator
from sim.faults.kinds import Expected, Exposure, FaultKind
from sim.faults.language import FaultTime
from tests.campaigns.faults.stage import Stage
from tests.campaigns.faults.wheel_harm import SAFE_S
from tests.campaigns.strangers.defect import Defect
from tests.campaigns.strangers.draw import Case, Drawn

WATCHED_S, SLOW_S = 25.0, 900.0
"""How long an unending case is watched, s of rig time; a slow one SLOW_S."""
STANDS, ENDED = "motion where everything must stand", ("latched", "idle", "cooldown")
ENDED_S = 12.0
"""How long a case is watched after its run ends, s."""


@dataclass(slots=True)
class Outcome:
    """Harm by name, when it came (s after the defect), and which interlock noticed the defect, when."""

    harm: dict[str, str] = field(default_factory=dict[str, str])
    harmed_s: float = inf
    noticed: str = ""
    noticed_s: float = inf
    broken: dict[str, str] = field(default_factory=dict[str, str])
    """Invariants of control that were broken."""

    @property
    def unseen(self) -> bool:
        """Undetected harm."""
        return bool(self.harm) and not self.noticed

    def __str__(self) -> str:
        """Return harm and what noticed the defect."""
        harm = "; ".join([*self.harm.values(), *self.broken.values()])
        noticed = f"{self.noticed} after {self.noticed_s:.2f} s" if self.noticed else "unnoticed"
        return f"{harm or 'no harm'} ({noticed})"


def _injection(one: Drawn, now: float) -> Injection:
    make = partial(Defect, one.place, one.size, one.course)
    kind = FaultKind(str(one), make, Exposure.ALWAYS, Expected.MAY)
    return Injection(FaultTime(at_s=now + one.after_s), kind, text=kind.phrase)


def tried(stage: Stage, case: Case) -> Outcome:
    """Start the case's defects on this stage and watch the outcome."""
    outcome, began_s = Outcome(), stage.next_s
    stage.inject(*(_injection(one, began_s) for one in case.defects))
    if case.stop:
        kind = FaultKind(case.stop, partial(operator, case.stop), Exposure.ALWAYS, Expected.MAY)
        stage.inject(Injection(FaultTime(at_s=began_s + case.stop_s), kind, text=f"operator {case.stop}"))
    stage.run.stays_latched = True
    until_s = began_s + (SLOW_S if case.slow else WATCHED_S)
    ended_s, now = inf, began_s
    while now < min(until_s, ended_s + ENDED_S):
        now = stage.tick()
        if not outcome.noticed and stage.trip:
            outcome.noticed, outcome.noticed_s = stage.trip, now - began_s
        if stage.ended and ended_s == inf:
            ended_s = now
        if stage.observer.found and outcome.harmed_s == inf:
            outcome.harmed_s = now - began_s
            until_s = max(min(until_s, now + 60.0), now + SAFE_S)  # later detection of harm is too late
    outcome.noticed = outcome.noticed or stage.run.reason
    outcome.harm = _harm(stage, began_s, now)
    outcome.broken = dict(stage.invariants.broken)
    return outcome


def _harm(stage: Stage, began_s: float, now: float) -> dict[str, str]:
    """Return the harm done, and what the safe state lacks long after the end.

    An axis with false data may turn for its stop's time and a second after control believes that it is at rest.
    """
    harm = dict(stage.observer.found)
    if STANDS in harm and "press" not in harm[STANDS]:
        del harm[STANDS]
    if stage.ended and now - max(stage.mode_since_s, began_s) >= SAFE_S and stage.mode in ENDED:
        missing = stage.missing(())
        if missing:
            harm["not safe"] = f"{', '.join(missing)} in {stage.mode}"
    return harm
