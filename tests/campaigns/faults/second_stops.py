"""A second stop in the cool-down of the first: the wheel creeps, unloaded, and is stopped, killed or runs away."""

from __future__ import annotations

from sim.faults import Injection
from sim.faults.language import FaultTime
from sim.machines.wheel_on_belt.faults import CATALOGUE
from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tests.campaigns.faults.campaign import Tally
from tests.campaigns.faults.judge import Case, Judge, Verdict
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.stage import Stage

NAME, PHASE = "heated", "soak"
"""The recipe and the phase in whose middle the first stop comes: the hub is at 64 degC then."""
FIRST = "operator stop"
SECOND = (
    "operator stop", "operator fast stop", "operator abort", "operator release", "emergency stop pressed",
    "safety chain opened", "guard opened", "process killed", "scan stalled", "CAN adapter gone", "CAN bus off",
    "wheel drive fault", "belt drive fault", "wheel drive heartbeat lost", "wheel drive torque off", "wheel jammed",
    "belt jammed", "wheel runs away", "belt runs away", "press runs away", "load cell silent", "jacket silent",
    "hub sensor open", "contactor welded", "second master setpoint", "second master stops nodes",
)  # fmt: skip
CREEPS_S = 1.0
"""The cool-down has lasted this long when the second stop comes."""
GIVEN_UP_S = 20.0


def conduct(second: tuple[str, ...] = SECOND) -> Tally:
    """Stop a hot rig, and stop it again while it cools; only safety is judged."""
    tally = Tally("second stop in the cool-down")

    def look(moment: Moment, twins: Twins) -> None:
        tally.verdicts += twins.do(lambda twin: stopped_again(cooling(twin), moment))

    def stopped_again(stage: Stage, moment: Moment) -> list[Verdict]:
        here = Twins(stage, NAME, (), NO_HISTORY)
        cases = [Case(NAME, moment.tick, "cool-down", (name,)) for name in second]
        return [here.do(lambda twin, case=case: Judge(twin, case, budgets=False).run()) for case in cases]

    moment = next(m for m in rehearse(NAME)[0] if m.step.endswith(f" {PHASE}") and m.phase == "middle")
    visit(NAME, [moment], look)
    return tally


def cooling(stage: Stage) -> Stage:
    """Stop a stage, and run it to its cool-down. Raises RuntimeError if there is none."""
    stage.inject(Injection(FaultTime(at_s=stage.next_s), CATALOGUE[FIRST]))
    until_s = stage.next_s + GIVEN_UP_S
    while stage.next_s < until_s:
        stage.tick()
        if stage.mode == "cooldown" and stage.next_s - stage.mode_since_s >= CREEPS_S and stage.copyable:
            return stage
    raise RuntimeError(f"no cool-down after the first stop: {stage.mode}")
