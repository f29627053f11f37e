"""Late scans on a rig whose drives tolerate them: control alone must detect and report them.

The drives' own watchdogs are as quick as the limit for late scans, and mostly act first. Here they are disabled, and a
late scan must itself be the first cause of the trip.
"""

from __future__ import annotations

from tests.campaigns.faults.campaign import Tally
from tests.campaigns.faults.judge import Case, Judge, Verdict
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.stage import Stage

NAME = "short"
"""The recipe (tests.campaigns.faults.recipes)."""
FAULT, CAUSE = "scan stalled while sliding", "scan late"
PATIENT = (
    "can.consumer_heartbeat=2 s", "arming.watchdog_proof=false", "axes.wheel.rpdo_deadline=0 s",
    "axes.belt.rpdo_deadline=0 s", "axes.press.rpdo_deadline=0 s",
)  # fmt: skip
"""The rig whose drives wait for us."""


def conduct() -> Tally:
    """Stall the scan at begin, middle and end of every step in which the drives are on."""
    tally = Tally("late scans")

    def look(moment: Moment, twins: Twins) -> None:
        if twins.stage.running and twins.stage.run.engine.ctx.demand.enabled:
            case = Case(NAME, moment.tick, moment.place, (FAULT,))
            tally.verdicts.append(twins.do(lambda twin: first_up(twin, case)))

    visit(NAME, rehearse(NAME, PATIENT)[0], look, PATIENT)
    return tally


def first_up(stage: Stage, case: Case) -> Verdict:
    """Judge a case; its first cause must be the late scan."""
    verdict = Judge(stage, case).run()
    if not verdict.failures and verdict.tripped_by != CAUSE:
        verdict.failures.append(f"tripped by {verdict.tripped_by or 'nothing'}, not by {CAUSE}")
    return verdict
