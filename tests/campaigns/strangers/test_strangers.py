"""Drawn defects, their courses, and the outcome of a case (``python -m tests.campaigns.strangers``)."""

from __future__ import annotations

import random
from math import inf
from typing import Any

import pytest

from sim.faults.scene import Scene
from tests.campaigns.faults.corners import corners
from tests.campaigns.faults.moments import Moment
from tests.campaigns.strangers import places, trial
from tests.campaigns.strangers.defect import Course, Defect, Place, Reading
from tests.campaigns.strangers.draw import Case, Drawn, cases
from tests.campaigns.strangers.hardware import row_of, written
from tests.campaigns.strangers.scenes import TRACK, WHEEL, setups

ELSEWHERE = ("silent", "late", "commanded", "by itself")
"""Ends of names of places that show on a line, in the computer, or on an axis that has power."""
LOOKED_AT_AGAIN = frozenset({"impair", "still", "settled", "watching", "stale"})
"""Impairments of a line are counted down; the others only cause another check."""
MOMENT = Moment("a recipe", 0, "4 rest rest", "begin")


def place_of(name: str, of: tuple[Place, ...] = places.WHEEL) -> Place:
    return next(one for one in of if one.name == name)


@pytest.mark.parametrize(
    ("course", "age_s", "share"),
    [
        (Course(), 0.0, 1.0), (Course(rises_s=10.0), 5.0, 0.5), (Course(rises_s=10.0), 20.0, 1.0),
        (Course(every_s=2.0, duty=0.25), 0.4, 1.0), (Course(every_s=2.0, duty=0.25), 0.6, 0.0),
        (Course(lasts_s=3.0), 2.9, 1.0), (Course(lasts_s=3.0), 3.0, 0.0),
    ],
)  # fmt: skip
def test_a_course_gives_the_share_of_the_size(course: Course, age_s: float, share: float) -> None:
    assert course.share(age_s) == share


def test_cases_draw_every_place_of_a_machine() -> None:
    drawn = list(cases(random.Random(1), [MOMENT], places.WHEEL, 1500))
    assert {name for case in drawn for name in case.places} == {place.name for place in places.WHEEL}
    assert 0.4 < sum(len(case.defects) == 2 for case in drawn) / len(drawn) < 0.6


def test_sizes_fill_their_range_to_either_side() -> None:
    drawn = [one for case in cases(random.Random(2), [MOMENT], places.WHEEL, 3000) for one in case.defects]
    offsets = [one.size for one in drawn if one.place.name == "load cell offset"]
    assert min(offsets) < -200.0 and max(offsets) > 200.0


def numbers_of(thing: Any, path: str = "rig", seen: set[int] | None = None) -> dict[str, object]:
    """Return every plain value of a machine by its path."""
    seen = set() if seen is None else seen
    if isinstance(thing, Reading):
        spoilt = {f"{path}.{name}": getattr(thing, name) for name in ("gain", "offset", "holds")}
        return {name: value for name, value in spoilt.items() if value} | numbers_of(thing._source, path, seen)
    if isinstance(thing, dict):
        named = [(str(name), value) for name, value in thing.items()]
    else:
        slots = [name for one in type(thing).__mro__ for name in getattr(one, "__slots__", ())]
        names = (*slots, *getattr(thing, "__dict__", ()))
        named = [(name, getattr(thing, name)) for name in names if hasattr(thing, name) and name not in LOOKED_AT_AGAIN]
    found: dict[str, object] = {}
    for name, value in named:
        if isinstance(value, (int, float, str, frozenset, type(None))):
            found[f"{path}.{name}"] = round(value, 9) if isinstance(value, float) else value
        elif id(value) not in seen:
            seen.add(id(value))
            if isinstance(value, dict) or type(value).__module__.startswith(("sim.", Reading.__module__)):
                found |= numbers_of(value, f"{path}.{name}", seen)
    return found


@pytest.mark.parametrize("rig", ["sim", "grosch", "pin-on-disc"])
def test_each_place_changes_its_machine_and_is_sound_again_afterwards(rig: str) -> None:
    setup = next(one for kind in (WHEEL, TRACK) for one in setups(kind).values() if one.rig == rig)
    for place in places.of(rig):
        stage = setup.stage()
        if rig == "sim":
            stage.rig.install(1, 1, "1#", new_specimen=True)
        scene, sound = Scene(stage.rig, stage.faulty), numbers_of(stage.rig)
        effect = Defect(place, place.high, Course(lasts_s=1.0))
        effect.begin(scene, 0.0)
        spoilt = numbers_of(stage.rig)
        effect.renew(scene, 1.5)
        effect.end(scene, 2.0)
        changed = {path for path, value in numbers_of(stage.rig).items() if sound.get(path, value) != value}
        assert (place.name, changed) == (place.name, set())
        assert spoilt != sound or place.name.endswith(ELSEWHERE), place.name


def test_a_force_beyond_its_limit_is_harm_that_an_interlock_notices() -> None:
    name = next(iter(corners()))
    stage = setups(WHEEL)[name].stage()
    while stage.place[1] != "grind" or stage.rig.plant.force_z_n < 100.0:
        stage.tick()
    towards = Drawn(place_of("wheel towards the belt"), 2.0, Course())
    outcome = trial.tried(stage, Case(MOMENT, (towards,)))
    assert "force" in outcome.harm and outcome.noticed and outcome.harmed_s < inf


def test_a_row_covers_its_size_and_what_is_beyond() -> None:
    row = next(one for one in written() if one.place == "wheel towards the belt")
    place = place_of(row.place)
    beyond, below = (Case(MOMENT, (Drawn(place, size, Course()),)) for size in (-row.beyond, 0.9 * row.beyond))
    assert row_of(WHEEL, beyond) == row and row_of(WHEEL, below) is None and row_of(TRACK, beyond) is None
