"""Defects that begin while a wheel's machine is commissioned: in any step that uses its wires."""

from __future__ import annotations

import random
from math import inf
from pathlib import Path
from tempfile import TemporaryDirectory

from sim.faults.scene import Scene
from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds.wheel_on_belt.commission.commission_steps import STEPS
from tester.machine.commission.step_engine import Ended
from tests.campaigns.faults.wheel_harm import HarmObserver, Truth
from tests.campaigns.strangers.defect import Defect
from tests.campaigns.strangers.draw import Case, defect
from tests.campaigns.strangers.places import WHEEL
from tests.campaigns.strangers.scenes import Moment
from tests.campaigns.strangers.trial import STANDS, Outcome
from tests.tester.kinds.wheel_on_belt.commission.twin_bench import Bench

NAME = "commissioning"
LASTS_S = {"cell": 260.0, "thermometer": 300.0, "watchdogs": 20.0, "spring": 20.0, "relay": 15.0}
"""Duration of a step on a sound machine, s; others USUAL_S."""
USUAL_S = 35.0
OF_STEP = {
    "cell": "load cell", "spring": "press", "home": "press", "relay": "belt", "touch": "press", "rolling": "belt",
    "thermometer": "thermometer",
}  # fmt: skip
"""The parts that a step uses: the first defect of a case is in them. A jog uses its own axis, the others any part."""
PLANNED_W = 120.0
"""Maximum slip speed times load in commissioning, W: 200 N at 0.6 m/s."""
GIVEN_UP_S = 600.0
"""A commissioning that waits for a person this long is ended, s of rig time."""
_OF_FRAMES = ("frames lost", "frozen", "commands lost", "off the bus", "computer late")


class GivenUpError(Exception):
    """The machine waits for a person who does nothing: a guard that stays open."""


class Watched:
    """Gives each world of a commissioning its defects, and watches it for harm."""

    def __init__(self, case: Case) -> None:
        """No world yet."""
        self.case, self.outcome = case, Outcome()
        self._observer: HarmObserver | None = None
        self._defects: list[tuple[float, Defect]] = []
        self._begun: list[Defect] = []

    def look(self, world: WheelRig) -> None:
        """Check the world in one of its ticks."""
        now = world.now_s
        if self._observer is None or self._observer.rig is not world:
            self._observer = HarmObserver(world, PLANNED_W)
            begin_s = 1e-3 * self.case.moment.tick
            self._defects = [
                (begin_s + one.after_s, Defect(one.place, one.size, one.course)) for one in self.case.defects
            ]
            self._begun = []
        if now > GIVEN_UP_S:
            raise GivenUpError
        scene = Scene(world, None)
        while self._defects and self._defects[0][0] <= now:
            begun = self._defects.pop(0)[1]
            begun.begin(scene, now)
            self._begun.append(begun)
        for begun in self._begun:
            begun.renew(scene, now)
        self._observer.look(must_stand=False)
        harm = {name: text for name, text in self._observer.found.items() if name != STANDS}
        if harm and self.outcome.harmed_s == inf:
            self.outcome.harmed_s = now - 1e-3 * self.case.moment.tick
        self.outcome.harm |= harm

    def end(self) -> None:
        """Record what the safe state lacks after commissioning; a press that is held keeps its load."""
        if self._observer is not None:
            world = self._observer.rig
            for _ in range(300):
                world.advance(world.now_s + 0.01)
            held = "press held" in self.case.places
            if missing := Truth.of(world).unsafe(force_stays=held):
                self.outcome.harm["not safe"] = ", ".join(missing)


def cases(chooser: random.Random, count: int) -> list[Case]:
    """Return cases: a step of commissioning, a time in it (ms), a defect or two."""
    places = [place for place in WHEEL if not place.name.endswith(_OF_FRAMES)]
    steps = [step.name for step in STEPS if step.seat is not None]
    drawn: list[Case] = []
    for _ in range(count):
        step = chooser.choice(steps)
        at_s = chooser.uniform(0.0, LASTS_S.get(step, USUAL_S))
        part = OF_STEP.get(step, step.removeprefix("jog "))
        own = [place for place in places if place.name.startswith(part)] or places
        defects = [defect(chooser, own), defect(chooser, places)][: chooser.choice((1, 2))]
        if len({one.place.name for one in defects}) < len(defects):
            del defects[1]
        drawn.append(Case(Moment(NAME, round(1e3 * at_s), step, f"at {at_s:.1f} s"), tuple(defects)))
    return drawn


def conduct(count: int, seed: int) -> list[tuple[Case, Outcome]]:
    """Draw cases and commission a machine up to the end of each case's step."""
    return [(case, _tried(case, seed)) for case in cases(random.Random(f"{seed} {NAME}"), count)]


def _tried(case: Case, seed: int) -> Outcome:
    watched = Watched(case)
    with TemporaryDirectory() as folder:
        steps = tuple(step for step in STEPS if step.name == case.moment.step)
        try:
            outcome = Bench(Path(folder) / "record.jsonl", seed, steps=steps, look=watched.look).run()
            watched.outcome.noticed = "" if outcome.ended is Ended.DONE else outcome.text
        except GivenUpError:
            watched.outcome.noticed = "it waits for a person"
    watched.end()
    return watched.outcome
