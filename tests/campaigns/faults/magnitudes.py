"""Searches the magnitude of every fault that has one: the greatest magnitude that nothing detects, and its effect.

Of each fault and sign the worst place is found first (corner and step in which a moderate magnitude comes nearest to
harm), then there, by bisection, the smallest detected magnitude. Undetected means: neither trips nor ends the run while
it is watched. Every harmful magnitude, detected or not, must be in the written table of what hardware must prevent.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from time import process_time

from tester.kinds.wheel_on_belt.interlocks.heat_balance import FIRST, KnownRatio
from tester.kinds.wheel_on_belt.run.past_runs import known_from, ratios_of
from tests.campaigns.faults.judge import Case, Judge
from tests.campaigns.faults.moments import Moment, Twins, rehearse, visit
from tests.campaigns.faults.parametric import ASSEMBLY, PARAMETRIC, Parametric
from tests.campaigns.faults.stage import Stage
from tests.campaigns.faults.wheel_harm import CONTACT_C, FORCE_N, HUB_C, POWER_W, STANDING_J

WRITTEN = Path(__file__).resolve().parents[3] / "docs" / "hardware-magnitudes.csv"
"""Undetected harmful magnitudes, with the device that must prevent harm; docs/kinds/wheel-on-belt.md shows the
table."""
CORNERS = ("1#, stiffness -25%, friction heat +30%", "3#, stiffness +30%, friction heat +30%")
"""Corners searched for places: the softest and the stiffest rubber, least and most friction."""
UNLIKE = {CORNERS[0]: ("sim.thermal.hub_capacity=399 J/K",), CORNERS[1]: ("sim.thermal.hub_capacity=441 J/K",)}
"""Further differences between the twin's heat and the rig file: a hub of 5 % less, and of 5 % more capacity."""
STEPS = 6
"""Halvings of the range: magnitudes are known to a 64th of it."""
MODERATE = 0.25
"""Share of the range at which places are compared."""
ASSEMBLED, LOADED, HOT = "assembled", "loaded", "hot"
_PLACES = {
    ASSEMBLED: (("connect", "begin"),),
    LOADED: (("grind", "middle"), ("roll", "begin"), ("measure", "middle")),
    HOT: (("soak", "begin"), ("soak", "middle")),
}
"""Phases and parts of them in which faults begin: of the machine's assembly, of what needs load, of temperatures."""
STOPPING, FINISHED = "-> stopping: ", "recipe finished"
"""Journal entries of a stop, and of the stop that ends a recipe."""
_WATCHED_S = {ASSEMBLED: 120.0, LOADED: 150.0, HOT: 900.0}
"""How long they are watched, s of rig time: through pre-grinding; a soak under load; heating and the first bursts."""


@dataclass(frozen=True, slots=True)
class Trial:
    """One magnitude at one place: what detected it ("" for nothing), the harm, and the greatest figures after the
    onset."""

    value: float
    noticed: str
    harm: tuple[str, ...]
    force_n: float
    hub_c: float
    contact_c: float
    power_w: float
    standing_j: float
    cpu_s: float = 0.0
    """What it took."""

    @property
    def danger(self) -> float:
        """How near to harm it came: 1 and more is harm, except for brief slip power."""
        return max(self.force_n / FORCE_N, self.hub_c / HUB_C, self.contact_c / CONTACT_C, self.power_w / POWER_W,
                   self.standing_j / STANDING_J)  # fmt: skip

    @property
    def does(self) -> str:
        """Its effect, in figures."""
        return (
            f"{self.force_n:.0f} N, hub {self.hub_c:.0f} degC, contact {self.contact_c:.0f} degC, slip x force"
            f" {self.power_w:.0f} W, standing {self.standing_j:.0f} J"
        )


@dataclass(frozen=True, slots=True)
class Found:
    """A fault's range to one side: where it is worst, the greatest unnoticed magnitude, and the least that harms."""

    row: Parametric
    end: float
    place: str
    unnoticed: Trial | None
    harmed: tuple[Trial, ...]
    noticed_by: str
    cpu_s: float = 0.0

    @property
    def harming(self) -> Trial | None:
        """The least magnitude that harms."""
        return min(self.harmed, key=lambda trial: abs(trial.value - self.row.normal), default=None)

    @property
    def text(self) -> str:
        """The finding in a line."""
        phrase, seen = self.row.kind.phrase, self.noticed_by or "nothing"
        line = f"{phrase} towards {self.row.text(self.end).removeprefix(phrase).strip()} ({self.place}): "
        if self.unnoticed is None:
            line += f"none goes unnoticed ({seen})"
        else:
            line += f"unnoticed up to {self.row.text(self.unnoticed.value).removeprefix(phrase).strip()}"
            line += f" ({self.unnoticed.does}), then {seen}"
        if self.harming is not None:
            line += f"; HARM from {self.row.text(self.harming.value).removeprefix(phrase).strip()}"
            line += f" ({'; '.join(self.harming.harm)}; {self.harming.noticed or 'unnoticed'})"
        return line


def kind_of_place(phrase: str) -> str:
    """Return where a fault is looked for: ASSEMBLED, HOT or LOADED."""
    if phrase.startswith(ASSEMBLY):
        return ASSEMBLED
    together = phrase.startswith("common ") and PARAMETRIC[phrase].kind.slow
    return HOT if together or phrase.startswith(("hub", "thermometer")) else LOADED


@dataclass(frozen=True, slots=True)
class Order:
    """A fault of this phrase and magnitude is to be tried."""

    phrase: str
    value: float


@cache
def places(corner: str) -> dict[tuple[str, str], Callable[[Order], Trial]]:
    """Return a function that tries faults, for each place of a corner."""
    wanted = {place for places in _PLACES.values() for place in places}
    found: dict[tuple[str, str], Callable[[Order], Trial]] = {}
    by_moment: dict[Moment, tuple[str, str]] = {}
    unlike = UNLIKE[corner]
    moments, rehearsed = rehearse(corner, unlike, cooled=False)
    for moment in moments:
        place = (moment.step.rpartition(" ")[2], moment.phase)
        if place in wanted and place not in by_moment.values():
            by_moment[moment] = place

    def look(moment: Moment, twins: Twins) -> None:
        found[by_moment[moment]] = twins.stay(lambda twin, order: tried(twin, moment, order))

    visit(corner, by_moment, look, unlike, history(rehearsed))
    return found


def history(rehearsed: Stage) -> KnownRatio:
    """Return a rig's knowledge after three heatings like those of a run: the fault comes after a life without one."""
    rig = rehearsed.run.engine.ctx.rig
    return known_from(FIRST * ratios_of(rehearsed.ledger.heatings, rig), rig)


def attempt(row: Parametric, value: float, corner: str, place: tuple[str, str]) -> Trial:
    """Let a fault of this magnitude begin at a place of a corner."""
    return places(corner)[place](Order(row.kind.phrase, value))


def tried(stage: Stage, moment: Moment, order: Order) -> Trial:
    """Let a fault begin on this stage."""
    row, value = PARAMETRIC[order.phrase], order.value
    began_s, first = process_time(), len(stage.ledger.journal)
    stage.observer.forget()
    case = Case(moment.recipe, moment.tick, moment.place, (row.text(value),))
    watched_s = _WATCHED_S[kind_of_place(row.kind.phrase)]
    verdict = Judge(stage, case, budgets=False, watched_s=watched_s).run()
    stops = [text.partition(STOPPING)[2] for text in stage.ledger.journal[first:] if STOPPING in text]
    ended = next((why for why in stops if why != FINISHED), "")
    seen = stage.observer
    return Trial(
        value, stage.trip or stage.run.reason or ended, tuple(verdict.failures), seen.most_n, seen.most_hub_c,
        seen.most_contact_c, seen.most_power_w, seen.most_standing_j, process_time() - began_s,
    )  # fmt: skip


def search(row: Parametric, end: float) -> Found:
    """Find the worst place of a fault to one side, then the greatest magnitude there that nothing detects."""
    kind = kind_of_place(row.kind.phrase)
    trials: list[Trial] = []
    here = [(corner, place) for corner in CORNERS for place in _PLACES[kind] if place in places(corner)]
    worst: tuple[float, tuple[str, tuple[str, str]]] | None = None
    for corner, place in here:
        one = attempt(row, row.between(end, MODERATE), corner, place)
        trials.append(one)
        rank = one.danger + (1.0 if one.harm else 0.0)
        if worst is None or rank > worst[0]:
            worst = (rank, (corner, place))
    assert worst is not None
    corner, place = worst[1]
    unnoticed: Trial | None = None
    least, most, noticed_by = 0.0, 1.0, ""
    one = attempt(row, end, corner, place)
    trials.append(one)
    if one.noticed:
        noticed_by = one.noticed
        for _ in range(STEPS):
            middle = 0.5 * (least + most)
            one = attempt(row, row.between(end, middle), corner, place)
            trials.append(one)
            if one.noticed:
                most, noticed_by = middle, one.noticed
            else:
                least, unnoticed = middle, one
    else:
        unnoticed = one
    harmed = tuple(trial for trial in trials if trial.harm)
    cpu_s = sum(trial.cpu_s for trial in trials)
    return Found(row, end, f"{corner}; {place[0]}, {place[1]}", unnoticed, harmed, noticed_by, cpu_s)


def _search(one: tuple[str, float]) -> Found:
    return search(PARAMETRIC[one[0]], one[1])


def conduct(jobs: int = 1, only: str = "") -> Iterable[Found]:
    """Search every fault (those whose phrase has the text ``only``) to both sides, on ``jobs`` processors."""
    ends = [(row.kind.phrase, end) for row in PARAMETRIC.values() for end in row.ends if only in row.kind.phrase]
    if jobs == 1:
        yield from map(_search, ends)
        return
    with ProcessPoolExecutor(jobs) as pool:
        yield from pool.map(_search, ends)


@dataclass(frozen=True, slots=True)
class Written:
    """A row of the written table: magnitudes ``least`` to ``most`` of a fault that hardware must prevent."""

    fault: str
    least: float
    most: float
    unit: str
    does: str
    device: str
    why: str
    only: str = ""
    """The rigs it applies to; "" is a rig with a history of heatings, as in a search."""

    @property
    def range(self) -> str:
        """Fault, magnitudes and rigs, in words."""
        words = f"{self.fault}, {self.least:g} to {self.most:g} {self.unit}"
        return f"{words}, {self.only}" if self.only else words

    def covers(self, found: Found) -> bool:
        """Return whether every harmful magnitude is in this row."""
        mine = bool(found.harmed) and found.row.kind.phrase == self.fault and not self.only
        return mine and all(self.least <= trial.value <= self.most for trial in found.harmed)


def written() -> tuple[Written, ...]:
    """Return the written table."""
    with WRITTEN.open(encoding="utf-8", newline="") as file:
        return tuple(
            Written(row["fault"], float(row["least"]), float(row["most"]), row["unit"], row["does"], row["device"],
                    row["why"], row["only"])
            for row in csv.DictReader(file)
        )  # fmt: skip
