"""A fault script for a simulated rig in progress: planned faults, and faults in action."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import inf

from sim.faults.language import Injection
from sim.faults.scene import Effect, Scene


@dataclass(slots=True)
class Planned:
    """An event at a known time: the begin or the end of an effect."""

    at_s: float
    effect: Effect
    begins: bool
    text: str
    lasts_s: float = inf


@dataclass(slots=True)
class FaultScript:
    """The faults of one run, applied during the run. Plain data; ``due_s`` is the time of the next event.

    ``happened`` collects (time in s, text) of the effects that began and ended, until it is fetched.
    """

    waiting: list[Injection] = field(default_factory=list[Injection])
    """Faults that wait for a scan or a step."""
    planned: list[Planned] = field(default_factory=list[Planned])
    renewed: list[Effect] = field(default_factory=list[Effect])
    active: list[Planned] = field(default_factory=list[Planned])
    """Effects that have begun and not ended."""
    happened: list[tuple[float, str]] = field(default_factory=list[tuple[float, str]])
    due_s: float = inf

    def add(self, injections: Iterable[Injection]) -> FaultScript:
        """Add more faults."""
        for injection in injections:
            if injection.when.at_s < inf:
                self._plan(injection, injection.when.at_s)
            else:
                self.waiting.append(injection)
        return self

    def notice(self, now: float, scans: int, steps: Iterable[str]) -> None:
        """Start the faults that waited for this scan number or for the begin of one of these steps."""
        names = tuple(steps)
        for injection in tuple(self.waiting):
            when = injection.when
            if (when.scan and scans >= when.scan) or (when.step and when.step in names):
                self.waiting.remove(injection)
                self._plan(injection, now + when.after_s)

    def act(self, scene: Scene, now: float) -> None:
        """Begin and end every effect that is due by ``now`` s."""
        while self.due_s <= now:
            planned = min(self.planned, key=_at)
            self.planned.remove(planned)
            try:
                self._do(planned, scene, now)
            finally:  # the rig may lack the device of the fault
                self.due_s = min((one.at_s for one in self.planned), default=inf)

    def renew(self, scene: Scene, now: float) -> None:
        """Renew the effects that need it before each step of the rig."""
        for effect in self.renewed:
            effect.renew(scene, now)

    def clear(self, scene: Scene, now: float) -> None:
        """End every effect in action, the last first, and forget the planned faults."""
        self.waiting.clear()
        self.planned.clear()
        self.due_s = inf
        for planned in self.active[::-1]:
            self._do(Planned(now, planned.effect, False, planned.text), scene, now)

    def _plan(self, injection: Injection, at_s: float) -> None:
        effect = injection.kind.effect(injection.value)
        text = injection.text or injection.kind.phrase
        self.planned.append(Planned(at_s, effect, True, text, injection.lasts_s))
        self.due_s = min(self.due_s, at_s)

    def _do(self, planned: Planned, scene: Scene, now: float) -> None:
        effect = planned.effect
        if planned.begins:
            effect.begin(scene, now)
            self.active.append(planned)
            if effect.every_step:
                self.renewed.append(effect)
            if planned.lasts_s < inf:
                self.planned.append(Planned(planned.at_s + planned.lasts_s, effect, False, planned.text))
        else:
            self.active = [one for one in self.active if one.effect is not effect]
            if effect.every_step:
                self.renewed.remove(effect)
            effect.end(scene, now)
        self.happened.append((now, f"{planned.text}: {'begins' if planned.begins else 'is over'}"))


def _at(planned: Planned) -> float:
    return planned.at_s
