"""The moments of a recipe at which the campaign injects: begin, middle and end of every step."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from math import inf
from typing import TypeVar

from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY, KnownRatio
from tests.campaigns.faults.apart import FORKS, Post, apart
from tests.campaigns.faults.recipes import TRACKS, setting_of
from tests.campaigns.faults.stage import STANDING, Place, Stage

Order = TypeVar("Order")
Result = TypeVar("Result")
PHASES = ("begin", "middle", "end")
WARM_S = 10.0
"""Observed part of a cool-down if its end is not awaited, s."""


@dataclass(frozen=True, slots=True)
class Moment:
    """A tick of a recipe's run, and what happens there."""

    recipe: str
    tick: int
    step: str
    phase: str

    @property
    def place(self) -> str:
        """As text."""
        return f"{self.step}, {self.phase}"


@cache
def rehearse(recipe: str, overrides: tuple[str, ...] = (), cooled: bool = True) -> tuple[list[Moment], Stage]:
    """Run a recipe to its end, once; return begin, middle and end of every step, and the stage at the end.

    Without ``cooled`` the end is WARM_S after the last step: a hot wheel takes most of an hour to cool.
    """
    stage = stage_of(recipe, overrides)
    return moments_of(recipe, stage, cooled=cooled), stage


def moments_of(recipe: str, stage: Stage, *, cooled: bool, most_s: float = inf) -> list[Moment]:
    """Run a stage to its end, or until a rig time, s; return begin, middle and end of every step."""
    stretches: list[tuple[Place, str, int, int]] = []
    while not stage.run.finished and stage.next_s < most_s:
        if not cooled and stage.mode == "cooldown" and stage.next_s - stage.mode_since_s > WARM_S:
            break
        first = stage.ticks
        stage.tick()
        place = (stage.place[0], stage.place[1] if stage.running or not stage.run.engine.scans else stage.mode)
        if stretches and stretches[-1][0] == place:
            stretches[-1] = (*stretches[-1][:3], first)
        else:
            title = stage.run.engine.ctx.progress.title.partition(" ")[0] if place[0] else "connect"
            stretches.append((place, f"{place[0]} {title} {place[1]}", first, first))
    return list(_moments(recipe, stretches))


def stage_of(
    recipe: str, overrides: tuple[str, ...] = (), heat: KnownRatio = NO_HISTORY, believed: tuple[str, ...] = ()
) -> Stage:
    """Return a stage at the beginning of a recipe, on its rig with ``overrides`` besides and its history ``heat``.

    ``believed``: overrides of the rig file that control has, besides; the machine is without them.
    """
    setting = setting_of(recipe)
    if recipe in TRACKS:
        from tests.campaigns.faults.track import TrackStage

        return TrackStage(TRACKS[recipe].rig, setting.text, (*setting.overrides, *overrides), believed=believed)
    return Stage(setting.text, (*setting.overrides, *overrides), heat=heat, believed=believed)


def _moments(recipe: str, stretches: list[tuple[Place, str, int, int]]) -> Iterator[Moment]:
    """Choose, for each place, its longest stretch among the first ten."""
    chosen: dict[Place, tuple[str, int, int]] = {}
    seen: dict[Place, int] = {}
    for place, name, first, last in stretches:
        if place[1] in STANDING:
            continue
        seen[place] = seen.get(place, 0) + 1
        if seen[place] <= 10 and (place not in chosen or last - first > chosen[place][2] - chosen[place][1]):
            chosen[place] = (name, first, last)
    for name, first, last in chosen.values():
        ticks = {first: "begin", (first + last) // 2: "middle", last: "end"}
        for tick, phase in sorted(ticks.items()):
            yield Moment(recipe, tick, name, phase)


def visit(
    recipe: str, moments: Iterable[Moment], look: Callable[[Moment, Twins], None], overrides: tuple[str, ...] = (),
    heat: KnownRatio = NO_HISTORY, believed: tuple[str, ...] = (),
) -> None:
    """Run a recipe once and yield, before each of the moments' ticks, an object that works with twins of its stage."""
    stage = stage_of(recipe, overrides, heat, believed)
    for moment in sorted(moments, key=_tick):
        while stage.ticks < moment.tick:
            stage.tick()
        look(moment, Twins(stage, recipe, overrides, heat, believed))


@dataclass(frozen=True, slots=True)
class Twins:
    """Lets work be done with a stage and leaves it unchanged. Without forks it uses a copy or, if the stage cannot be
    copied, a run of its own up to there.
    """

    stage: Stage
    recipe: str
    overrides: tuple[str, ...]
    heat: KnownRatio
    believed: tuple[str, ...] = ()

    def do(self, work: Callable[[Stage], Result]) -> Result:
        """Return the result of work on a twin. Raises ApartError."""
        if FORKS:
            return apart(lambda: work(self.stage))
        return work(self.copy())

    def stay(self, work: Callable[[Stage, Order], Result]) -> Callable[[Order], Result]:
        """Return a function that executes each order on a twin of its own, now and later. Raises ApartError."""
        if FORKS:
            post: Post[Order, Result] = Post(lambda order: work(self.stage, order))
            return post.do
        kept = self.copy()
        return lambda order: work(kept.copy(), order)

    def copy(self) -> Stage:
        """Return a twin in this process."""
        if self.stage.copyable:
            return self.stage.copy()
        twin = stage_of(self.recipe, self.overrides, self.heat, self.believed)
        while twin.ticks < self.stage.ticks:
            twin.tick()
        return twin


def _tick(moment: Moment) -> int:
    return moment.tick
