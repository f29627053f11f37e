"""`python -m tests.campaigns.aftertrip [--sample]`: after a trip no axis stays under power, whatever datum is frozen.

Each case freezes one process datum of one drive, or one sensor, before, during or after a stop, at any moment of a
recipe. In half of the cases the axis with the frozen datum also runs away while it has power. The twin's own power
stage is judged: each axis must lose its power within a second after the time allowed for its stop. Prints a line a
figure; exit code 1 where one misses.
"""

from __future__ import annotations

import argparse
import random
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from math import inf

from sim.faults import Injection
from sim.faults.language import FaultTime
from sim.nodes.drive_power import ENERGISED
from tests.campaigns.acceptance.figure import at_least, equal
from tests.campaigns.faults.judge import fault_of
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.recipes import TRACKS
from tests.campaigns.faults.stage import Stage
from tests.campaigns.faults.track import fits
from tests.campaigns.faults.wheel_harm import UNLOADED_N

RECIPES = {"wheel_on_belt": ("heated", "reversed", "sideslip"), "specimen_on_track": ("slow track", "disc")}
SAMPLE = {"wheel_on_belt": ("heated",), "specimen_on_track": ("slow track",)}
OVERRIDES = {"wheel_on_belt": ("interlocks.cooldown_hub=35 degC",), "specimen_on_track": ()}
"""A wheel heated to 40 degC turns while it cools down."""
CASES, SAMPLE_CASES = 1500, 110
"""Cases of each kind of rig."""
BEFORE_S, AFTER_S = 2.0, 3.0
"""The datum freezes at most this long before or after the beginning of the stop."""
WATCHED_S = 14.0
"""A stop that does not end is watched for this long: "stop not ended" trips after ten seconds."""
POWER_S = 1.0
"""Power may last this much longer than a stop."""
SHOWN_S = 1.0
"""A creeping wheel with a frozen speed is detected after this time (``interlocks.frozen_wheel``)."""
ENDING, ENDING_SHARE = ("stopping", "cooldown"), 0.3
"""Modes of a stop, with the number of cases that begin in each; in half of the cases nothing else causes a stop."""
GOING = frozenset({"run", "hold", "armed"})
DATA = ("statusword", "reading", "torque", "feedback", "inputs")
SENSORS = {
    "wheel_on_belt": ("load cell", "thermometer", "hub sensor"), "specimen_on_track": ("load cell", "chamber sensor"),
}  # fmt: skip
STUCK = {
    "wheel_on_belt": ("jacket output stuck on", "jacket output stuck off", "contactor welded", "contactor dead"),
    "specimen_on_track": ("chamber runs away",),
}  # fmt: skip
"""Outputs, and a contactor with its feedback, that freeze."""
RUNAWAYS = {
    "wheel": ("wheel runs away", 10.0, "rad/s"), "belt": ("belt runs away", 0.5, "m/s"),
    "track": ("track overspeeds", 5.0, "mm/s"),
}  # fmt: skip
"""Fault of an axis that moves by itself while it has power; its greatest magnitude of either sign, and the unit."""
STOPS = {
    "wheel_on_belt": (
        "operator stop", "operator fast stop", "operator abort", "belt drive fault", "wheel drive torque off",
        "load cell silent", "guard opened", "safety chain opened", "jacket silent", "press drive fault",
        "sideslip drive heartbeat lost",
    ),
    "specimen_on_track": (
        "operator stop", "operator fast stop", "operator abort", "load cell silent", "guard opened",
        "safety chain opened", "lift drive fault", "track drive in local mode", "lift drive heartbeat lost",
    ),
}  # fmt: skip
"""What begins a stop."""
UNCOMMANDED = ("fault", "torque off", "heartbeat lost", "in local mode")
"""Faults after which a drive accepts no command, or has no power, so it cannot lift its load."""


@dataclass(frozen=True, slots=True)
class Case:
    """A moment, the datum that freezes, its delay after the beginning of the stop (s), and what else happens."""

    moment: Moment
    frozen: str
    after_s: float
    begins: str
    runaway: str

    def __str__(self) -> str:
        also = f", {self.runaway}" if self.runaway else ""
        place = f"{self.moment.recipe}, tick {self.moment.tick} ({self.moment.place})"
        return f"{place}: {self.frozen} at {self.after_s:+.2f} s, {self.begins or 'no further cause'}{also}"


@dataclass(slots=True)
class Verdict:
    """The result of a case: the mode in which the datum froze, the axes that kept power for too long, harm."""

    case: Case
    mode: str = ""
    stopped: bool = False
    failures: list[str] = field(default_factory=list[str])


def _axes(stage: Stage) -> dict[str, bool]:
    return {name: drive.state in ENERGISED for name, drive in stage.rig.axes.items()}


class Watch:
    """Watches the power of each axis of one stage from the beginning of its stop."""

    def __init__(self, stage: Stage, case: Case) -> None:
        """Start the case's faults; the stop begins ``BEFORE_S`` from now."""
        self.stage, self.case, self.verdict = stage, case, Verdict(case)
        self.begun_s, self.stopped_s = stage.next_s, inf
        self.frozen_s = stage.next_s + BEFORE_S + case.after_s
        self._inject(case.frozen, self.frozen_s)
        if case.begins:
            self._inject(case.begins, stage.next_s + BEFORE_S)
        if case.runaway:
            self._inject(case.runaway, self.frozen_s + 0.05)
        self._due_s: dict[str, float] = {}
        self._powered: dict[str, bool] = _axes(stage)
        stage.run.stays_latched = True

    def _inject(self, text: str, at_s: float) -> None:
        fault = fault_of(text, self.case.moment.recipe)
        self.stage.inject(Injection(FaultTime(at_s=at_s), fault.kind, fault.value, text=text))

    def run(self) -> Verdict:
        """Tick until every axis has had its time."""
        stage, verdict = self.stage, self.verdict
        while stage.next_s < self.begun_s + WATCHED_S and not (verdict.failures or stage.run.finished):
            now = stage.tick()
            if not verdict.mode and now >= self.frozen_s:
                verdict.mode = stage.mode or "connect"
            if not verdict.stopped and stage.run.engine.scans and stage.mode not in GOING:
                verdict.stopped, self.stopped_s = True, now
                self._due_s = {name: now + self._stop_s(name) + POWER_S for name in stage.rig.axes}
            if verdict.stopped:
                self._look(now)
        return verdict

    def _look(self, now: float) -> None:
        powered = _axes(self.stage)
        for name, on in powered.items():
            if self._powered[name] and not on and name == "press":
                self._look_at_load(now)
            if on and now > self._due(name):
                at_s = now - self.stopped_s
                self.verdict.failures.append(f"{name} has power {at_s:.2f} s after the stop began, {self.stage.mode}")
        self._powered = powered

    def _look_at_load(self, now: float) -> None:
        """Check that a working press lifts before it loses its power."""
        obeys = not any(what in self.case.begins for what in (*UNCOMMANDED, "safety chain"))
        loaded = self.stage.rig.plant.force_z_n >= UNLOADED_N
        if obeys and loaded and "press" not in self.case.frozen and now - self.stopped_s < self._lift_s():
            at_s = now - self.stopped_s
            self.verdict.failures.append(f"press under load lost its power {at_s:.2f} s after the stop began")

    def _lift_s(self) -> float:
        return 1.0 + 0.8

    def _due(self, name: str) -> float:
        """Return until when an axis may have power, s. Only a wheel whose data show that it turns slowly may
        continue."""
        stage = self.stage
        if name != "wheel" or not stage.run.engine.control.state.setpoints.creeps:
            return self._due_s[name]
        shows = self.case.frozen not in ("wheel drive feedback frozen", "wheel drive reading frozen")
        return inf if shows else max(self._due_s[name], max(self.frozen_s, stage.mode_since_s) + SHOWN_S + POWER_S)

    def _stop_s(self, name: str) -> float:
        """Return the maximum stopping time of an axis, from docs/safety.md and its kind's page, s."""
        control = self.stage.run.engine.control
        if self.case.moment.recipe in TRACKS:
            limits, speed = control.view.limits, abs(self.stage.rig.track_m_s)
            margin_s = 0.6
            if name != "track":
                speed = limits.fastest_m_s
            speed = max(speed, abs(control.view.stop_start.speed_m_s))
            return 2.0 * margin_s + speed / limits.deceleration_m_s2 + speed / limits.quick_stop_m_s2
        limits = control.view.limits
        speed = max(abs(self.stage.rig.rim_m_s), abs(self.stage.rig.belt_m_s), control.view.stop_start.speed_m_s)
        turning_s = 1.5 + speed / limits.deceleration_m_s2 + speed / limits.quick_stop_m_s2
        start = control.view.stop_start
        way_mm = max(start.press_mm - start.lifted_mm, 0.0) if start.press_mm < inf else 0.0
        return max(turning_s, self._lift_s() + way_mm / limits.lift_mm_s)


def cases(kind: str, moments: Sequence[Moment], count: int, seed: int, axes: Iterable[str]) -> Iterator[Case]:
    """Yield cases drawn by seed."""
    chooser = random.Random(f"{seed} {kind}")
    io = "press" if kind == "wheel_on_belt" else "track"
    frozen = [f"{axis} drive {what} frozen" for axis in axes for what in DATA[:3]]
    frozen += [f"{axis} drive feedback frozen" for axis in axes if axis not in ("sideslip", "camber")]
    frozen += [f"{io} drive inputs frozen", *(f"{name} frozen" for name in SENSORS[kind]), *STUCK[kind]]
    ending = [moment for moment in moments if moment.step.endswith(ENDING)]
    while count:
        what = chooser.choice(frozen)
        runaway = RUNAWAYS.get(what.partition(" ")[0])
        also = ""
        if runaway is not None and chooser.random() < 0.5:
            phrase, most, unit = runaway
            also = f"{phrase} {chooser.choice((-1, 1)) * chooser.uniform(0.05, 1.0) * most:.3g} {unit}"
        moment = chooser.choice(ending if ending and chooser.random() < ENDING_SHARE else moments)
        begins = chooser.choice(STOPS[kind])
        if moment.recipe in TRACKS and not (fits(moment.recipe, what) and fits(moment.recipe, begins)):
            continue  # a disc's arm has no drive
        if moment in ending and chooser.random() < 0.5:
            begins = ""  # the stop is under way
        if any(begins == f"{what.partition(' ')[0]} drive {deaf}" for deaf in UNCOMMANDED):
            also = ""  # safe torque off stops a drive that accepts no command
        count -= 1
        yield Case(moment, what, chooser.uniform(-BEFORE_S, AFTER_S), begins, also)


def conduct(drawn: Sequence[Case], overrides: tuple[str, ...] = ()) -> Iterator[Verdict]:
    """Judge every case; each recipe runs once, on its rig with ``overrides``."""
    recipes = dict.fromkeys(case.moment.recipe for case in drawn)
    for recipe in recipes:
        by_moment: dict[Moment, list[Case]] = {}
        for case in drawn:
            if case.moment.recipe == recipe:
                by_moment.setdefault(case.moment, []).append(case)
        verdicts: list[Verdict] = []

        def look(moment: Moment, twins: Twins, mine: dict[Moment, list[Case]] = by_moment) -> None:
            for case in mine[moment]:
                verdicts.append(twins.do(lambda twin, case=case: Watch(twin, case).run()))  # noqa: B023

        visit(recipe, by_moment, look, overrides)
        yield from verdicts


def main(arguments: list[str] | None = None) -> int:
    """Draw cases and judge them; return the exit status."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.aftertrip", description=__doc__)
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE_CASES} cases of one recipe of each kind")
    parser.add_argument("--cases", type=int, default=0, metavar="N", help=f"of each kind of rig ({CASES})")
    parser.add_argument("--seed", type=int, default=29, metavar="N")
    parser.add_argument("--kind", choices=tuple(RECIPES), help="of rig; without it both")
    options = parser.parse_args(arguments)
    kinds = [options.kind] if options.kind else list(RECIPES)
    count = options.cases or (SAMPLE_CASES if options.sample else CASES)
    met = [judged(kind, (SAMPLE if options.sample else RECIPES)[kind], count, options.seed) for kind in kinds]
    return 0 if all(met) else 1


def judged(kind: str, recipes: Sequence[str], count: int, seed: int) -> bool:
    """Draw and judge the cases of a kind of rig; print its figures and return whether all are within their limits."""
    moments: list[Moment] = []
    axes: dict[str, None] = {}
    for recipe in recipes:
        found, stage = rehearse(recipe, OVERRIDES[kind], cooled=False)
        moments += [moment for moment in found if not moment.step.startswith("0 ")]
        axes |= dict.fromkeys(stage.rig.axes)
    drawn = list(cases(kind, moments, count, seed, list(axes)))
    verdicts = list(conduct(drawn, OVERRIDES[kind]))
    failed = [verdict for verdict in verdicts if verdict.failures]
    modes = Counter(verdict.mode or "none, the run had ended" for verdict in verdicts)
    figures = [
        at_least(f"{kind}: cases", len(verdicts), count),
        at_least(f"{kind}: cases that stop", sum(verdict.stopped for verdict in verdicts), round(0.8 * count)),
        equal(f"{kind}: axes with power after their stop, presses not lifted", len(failed), 0),
    ]
    for figure in figures:
        print(figure, flush=True)
    print(f"     froze in: {', '.join(f'{mode} {n}' for mode, n in modes.most_common())}", flush=True)
    for verdict in failed:
        print(f"       {verdict.case}: {'; '.join(verdict.failures)}", flush=True)
    return all(figure.ok for figure in figures)


if __name__ == "__main__":
    sys.exit(main())
