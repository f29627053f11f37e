"""The second kind at its limits: every fault at the corners of a track's range, and harmful magnitudes there.

Each corner first runs without a fault: no trip, no harm, every condition measured. Then faults begin at its moments,
those with a range at quarters of it to either side. Harmful faults must be in ``HARDWARE``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

from tests.campaigns.faults.campaign import Tally, all_cases, conduct, sample
from tests.campaigns.faults.judge import Verdict
from tests.campaigns.faults.moments import Moment, rehearse
from tests.campaigns.faults.recipes import TRACKS, TrackRecipe
from tests.campaigns.faults.track import FAULTS, fits

CASES, SHORT_CASES = 2400, 60

_GROSCH = """\
recipe: at the limits
kind: specimen_on_track
specimens: [{{compound: SBR}}]
measure: {{repeats: 1, min_valid: 1, distance: 0.2 mm, at_least: 2 s, soak: {{within: 1 K, for: 4 s}}}}
grids:
  - {{name: corner, load: {load:g} N, temperature: {temperature:g} degC, track_speed: {speed}}}
"""
_DISC = """\
recipe: at the limits
kind: specimen_on_track
specimens: [{{compound: SBR}}]
measure: {{repeats: 1, min_valid: 1, distance: 100 mm, at_least: 2 s, temperature_band: 5 K,
          soak: {{within: 3 K, for: 2 s}}}}
grids:
  - {{name: corner, load: {load:g} N, temperature: 23 degC, track_speed: {speed}}}
"""


def corners() -> dict[str, TrackRecipe]:
    """Return the twelve corners by name: hot or cold air, least or greatest load, slow or fast; a disc without air."""
    found: dict[str, TrackRecipe] = {}
    for temperature, load, speed in product((-30.0, 85.0), (5.0, 20.0), ("0.2 mm/s", "8 mm/s")):
        text = _GROSCH.format(load=load, temperature=temperature, speed=speed)
        found[f"track, {temperature:g} degC, {load:g} N, {speed}"] = TrackRecipe("grosch", text)
    for load, speed in product((5.0, 20.0), ("0.05 m/s", "1 m/s")):
        found[f"disc, {load:g} N, {speed}"] = TrackRecipe("pin-on-disc", _DISC.format(load=load, speed=speed))
    return found


CORNERS = corners()
SHORT_CORNERS = ("disc, 20 N, 1 m/s",)


class Range(NamedTuple):
    """A fault with its greatest magnitudes to either side, and their unit."""

    phrase: str
    ends: tuple[float, ...]
    unit: str

    @property
    def texts(self) -> tuple[str, ...]:
        """The fault at quarters of its range."""
        return tuple(f"{self.phrase} {0.25 * part * end:g} {self.unit}" for end in self.ends for part in (1, 2, 3, 4))


RANGES = (
    Range("track overspeeds", (-12.0, 12.0), "mm/s"),
    Range("load cell offset", (-150.0, 150.0), "N"),
    Range("load cell drift", (-1.0, 1.0), "N/s"),
    Range("chamber sensor offset", (-20.0, 20.0), "K"),
    Range("chamber runs away", (-100.0, 100.0), "%"),
    Range("pyrometer offset", (-20.0, 20.0), "K"),
)
"""Faults with a range."""


@dataclass(frozen=True, slots=True)
class Held:
    """A fault whose harm a device of the rig must prevent."""

    phrase: str
    harm: str
    device: str

    def covers(self, verdict: Verdict) -> bool:
        """Return whether this harm is a case's only failure."""
        return verdict.case.faults[0].startswith(self.phrase) and all(self.harm in text for text in verdict.failures)


HARDWARE = (
    Held("chamber sensor offset", "chamber beyond its range", "the chamber's own limiters, with sensors of their own"),
    Held("common ", "chamber beyond its range", "the chamber's own limiters, with sensors and a supply of their own"),
)
"""Single faults whose harm the software does not prevent."""


class Fine(NamedTuple):
    """A corner without a fault: its result, failures, and moments."""

    name: str
    outcome: str
    wrong: tuple[str, ...]
    moments: tuple[Moment, ...]


def fault_free(names: Sequence[str]) -> Iterator[Fine]:
    """Run corners without a fault."""
    TRACKS.update({name: CORNERS[name] for name in names})
    for name in names:
        moments, stage = rehearse(name, cooled=False)
        seen = tuple(f"tripped by {trip}" for trip in stage.ledger.trips) + tuple(stage.observer.found.values())
        outcome = stage.run.outcome.value
        due = len(list(stage.plan.conditions()))
        if stage.ledger.committed < due:
            seen = (*seen, f"{stage.ledger.committed} of {due} conditions")
        yield Fine(name, outcome, seen + tuple(stage.invariants.broken.values()), tuple(moments))


def attempt(fine: Sequence[Fine], cases: int, jobs: int, faults: Sequence[str] = FAULTS) -> Tally:
    """Try a sample of faults at every moment of these corners."""
    tried = all_cases([moment for one in fine for moment in one.moments], list(faults))
    fitting = [one for one in tried if fits(one[0].recipe, one[1][0])]
    return conduct("track limits", sample(fitting, cases), jobs, parts=1)


def magnitudes() -> list[str]:
    """Return every fault with a range, at quarters of it."""
    return [text for row in RANGES for text in row.texts]
