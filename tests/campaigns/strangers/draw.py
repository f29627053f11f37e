"""Cases, drawn by seed: a moment of a recipe, one or two defects there, and an operator's stop in some of them."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import exp, log

from tests.campaigns.strangers.defect import Course, Place
from tests.campaigns.strangers.scenes import Moment

PAIRS = 0.5
"""Share of the cases with two defects."""
STOPS = 0.15
"""Share of the cases in which the operator stops the run soon after the defect begins."""
APART_S = 20.0
"""The second defect begins up to this long after the first, in half of the pairs; otherwise both begin together."""
LONGEST_RISE_S = 900.0


@dataclass(frozen=True, slots=True)
class Drawn:
    """A defect of a case; ``after_s``: from the case's moment."""

    place: Place
    size: float
    course: Course
    after_s: float = 0.0

    def __str__(self) -> str:
        """Return the defect as text."""
        size = "" if self.place.whole else f" {self.size:+.3g} {self.place.unit}".rstrip()
        later = f" {self.after_s:.3g} s later" if self.after_s else ""
        return f"{self.place.name}{size} ({self.course}){later}"


@dataclass(frozen=True, slots=True)
class Case:
    """Defects at a moment of a recipe. ``stop``: the operator's request, "" for none, ``stop_s`` after the moment."""

    moment: Moment
    defects: tuple[Drawn, ...]
    stop: str = ""
    stop_s: float = 0.0

    @property
    def places(self) -> tuple[str, ...]:
        """Return the names of the places."""
        return tuple(one.place.name for one in self.defects)

    @property
    def slow(self) -> bool:
        """Whether temperatures follow."""
        return any(one.place.slow or one.course.rises_s > 10.0 for one in self.defects)

    def __str__(self) -> str:
        """Return the case as text."""
        stop = f", {self.stop} after {self.stop_s:.2f} s" if self.stop else ""
        where = f"{self.moment.recipe}, tick {self.moment.tick} ({self.moment.place})"
        return f"{where}: {' + '.join(map(str, self.defects))}{stop}"


def _between(chooser: random.Random, low: float, high: float) -> float:
    """Return a number, evenly drawn by its logarithm."""
    return exp(chooser.uniform(log(low), log(high)))


def _course(chooser: random.Random, place: Place) -> Course:
    """Draw a course: at once, a rise, an intermittent contact, or a single short event."""
    if place.rises_s > 0.0:
        return Course(_between(chooser, place.rises_s, LONGEST_RISE_S))
    form = chooser.choice(("at once", "rises", "intermittent", "once", "rises and flickers"))
    rises_s = _between(chooser, 1.0, LONGEST_RISE_S) if form.startswith("rises") and not place.whole else 0.0
    if form in ("intermittent", "rises and flickers"):
        return Course(rises_s, _between(chooser, 0.1, 20.0), chooser.uniform(0.05, 0.95))
    return Course(rises_s, lasts_s=_between(chooser, 0.03, 10.0)) if form == "once" else Course(rises_s)


def defect(chooser: random.Random, places: Sequence[Place], after_s: float = 0.0) -> Drawn:
    """Draw a defect."""
    place = chooser.choice(places)
    return Drawn(place, chooser.uniform(place.low, place.high), _course(chooser, place), after_s)


def cases(chooser: random.Random, moments: Sequence[Moment], places: Sequence[Place], count: int) -> Iterator[Case]:
    """Yield ``count`` cases: all steps are equally likely, whatever their number of moments."""
    steps: dict[str, list[Moment]] = {}
    for moment in moments:
        steps.setdefault(moment.step.rpartition(" ")[2], []).append(moment)
    names = list(steps)
    for _ in range(count):
        moment = chooser.choice(steps[chooser.choice(names)])
        defects = [defect(chooser, places)]
        while chooser.random() < PAIRS and len(defects) < 2:
            other = defect(chooser, places, chooser.choice((0.0, chooser.uniform(0.0, APART_S))))
            defects += [other] if other.place.name != defects[0].place.name else []
        stop = chooser.choice(("stop", "fast stop", "abort", "hold")) if chooser.random() < STOPS else ""
        yield Case(moment, tuple(defects), stop, chooser.uniform(0.0, 2.0) if stop else 0.0)
