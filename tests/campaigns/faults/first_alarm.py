"""Things pulled out of a running machine, and the first alarm, which must name them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product
from math import nan

from tester.kinds.wheel_on_belt.interlocks.heat_balance import NO_HISTORY
from tests.campaigns.faults.moments import Twins
from tests.campaigns.faults.recipes import language_of, setting_of
from tests.campaigns.faults.stage import Stage

RECIPE = "short"
IN_PHASE_S = 0.3
"""Delay between the beginning of a phase and a pull, s."""
LONGEST_S = 12.0
"""A device that is not needed at the moment is missed within this time: it is polled once a second, five times."""


@dataclass(frozen=True, slots=True)
class Pulled:
    """Something that comes loose: lines of a fault script, and words; the first alarm must contain one of them."""

    what: str
    faults: tuple[str, ...]
    names: tuple[str, ...]


DRIVES = ("wheel", "belt", "press", "sideslip", "camber")
PULLED: tuple[Pulled, ...] = (
    Pulled("cell cable or power off", ("load cell silent",), ("load cell",)),
    Pulled("serial adapter of the cell out", ("load cell line unplugged",), ("line load_cell", "line lost: load_cell")),
    Pulled("serial adapter of the heat line out", ("jacket line unplugged",), ("line lost: heat",)),
    Pulled("heat line out", ("thermometer silent", "jacket silent"), ("line heat",)),
    Pulled("CAN adapter out", ("CAN adapter gone",), ("simulated CAN adapter",)),
    Pulled("CAN plug out", ("CAN bus off",), ("CAN cable",)),
    *(Pulled(f"plug of the {axis} drive out", (f"{axis} drive off the bus",), (f"{axis} drive",)) for axis in DRIVES),
)


def text_of_first_trip(stage: Stage, one: Pulled, after_s: float = 0.0) -> str:
    """Pull it ``after_s`` after the next tick; return name and text of the first trip, "" if nothing trips."""
    began_s = stage.next_s + after_s
    for fault in one.faults:
        stage.inject(language_of(RECIPE).parse(f"t=0 s: {fault}").shifted(began_s))
    alarms: list[str] = []
    ledger = stage.ledger

    def trip(t_s: float, interlock: str, text: str, value: float = nan, limit: float = nan, unit: str = "") -> int:
        alarms.append(f"{interlock}: {text}")
        return len(alarms)

    ledger.trip = trip  # type: ignore[method-assign]
    while stage.next_s < began_s + LONGEST_S and not stage.run.finished:
        stage.tick()
        if alarms:
            return alarms[0]
    return ""


def conduct(
    pulled: Iterable[Pulled], phases: Iterable[str], seed: int = 0, moments_s: Iterable[float] = (0.0,)
) -> dict[tuple[str, str], str]:
    """Pull each thing IN_PHASE_S after the first beginning of each of these phases; return the first alarms.

    ``moments_s``: pull it so long after the next tick, each time in a copy; the place names the moment.
    """
    moments_s = tuple(moments_s)
    pulled, wanted = tuple(pulled), set(phases)
    setting = setting_of(RECIPE)
    stage = Stage(setting.text, setting.overrides, seed)
    found: dict[tuple[str, str], str] = {}
    place, since_s = stage.place, 0.0
    while wanted and not stage.run.finished:
        stage.tick()
        if stage.place != place:
            place, since_s = stage.place, stage.next_s
        if place[1] in wanted and stage.next_s - since_s >= IN_PHASE_S:
            wanted.remove(place[1])
            twins = Twins(stage, RECIPE, (), NO_HISTORY)
            for one, after_s in product(pulled, moments_s):
                where = place[1] + (f" + {1e3 * after_s:.2f} ms" if after_s else "")
                found[one.what, where] = twins.do(lambda twin, one=one, s=after_s: text_of_first_trip(twin, one, s))
    return found


def unnamed(found: dict[tuple[str, str], str]) -> list[str]:
    """Return the first alarms that do not name the pulled thing."""
    names = {one.what: one.names for one in PULLED}
    return [
        f"{what}, {place}: {text or 'no alarm'}"
        for (what, place), text in found.items()
        if not any(name in text for name in names[what])
    ]
