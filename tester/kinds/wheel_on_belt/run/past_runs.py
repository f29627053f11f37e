"""Records of past runs for later runs and pages: heatings as evidence, and requests over the slip ring.

Heatings are events of the kind ``heat`` whose data is JSON: the rig, the assumptions behind its ratio, and the numbers.
A rig file with other assumptions counts as another rig for its heat, and starts without evidence.
"""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from typing import Final, cast

from tester.analysis.ring_errors import RingRun, RingSegment
from tester.kinds.wheel_on_belt.image.ring_watch import BUS
from tester.kinds.wheel_on_belt.interlocks import hub, surface
from tester.kinds.wheel_on_belt.interlocks.heat_balance import KnownRatio, known_ratio
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.results.run_results import RingPart
from tester.store.record_schema import StoreError
from tester.store.run_folders import run_folders, under_way
from tester.store.run_reader import RunReader

KIND: Final = "heat"
LEAST_RISE_K: Final = 20.0
"""Least rise of the hub in a heating that counts as evidence: a sensor's lag of 1 K is 5 % of it [A]."""
LEAST_J: Final = 10e3
"""Least heat in a balance that counts as evidence, J [A]: a late sensor hides 2 % of it."""
_IN_HEAT: Final = frozenset(row.name for row in (*hub.ROWS, *surface.ROWS))
"""Trips after which the run's heat data is not trusted."""


def heating_data(rig: RigConfig, put_j: float, shown_j: float, rise_k: float) -> str:
    """Return a heating as an event's data: heat put in and heat shown, J, and the hub's rise, K."""
    numbers = {"put_j": round(put_j, 1), "shown_j": round(shown_j, 1), "rise_k": round(rise_k, 2)}
    return json.dumps({"rig": rig.name, "beliefs": beliefs_of(rig), **numbers})


def beliefs_of(rig: RigConfig) -> str:
    """Return a fingerprint of a ratio's assumptions: the file's section ``observer``, and a simulated rig's ``sim``."""
    of = (rig.observer, replace(rig.sim, faults=()) if rig.simulated else None)
    return sha256(repr(of).encode()).hexdigest()[:16]


def known_heat(runs: Path, rig: RigConfig) -> KnownRatio:
    """Return the facts about a rig's heat balance from the runs in a folder, except runs under way.

    An unreadable run, or a run that tripped in heat, is no evidence.
    """
    return known_from([ratio for folder in run_folders(runs) for ratio in _evidence(folder, rig)], rig)


def known_from(ratios: Sequence[float], rig: RigConfig) -> KnownRatio:
    """Return the facts about a rig's heat balance from ratios, the oldest first."""
    return known_ratio(ratios, rig.interlocks.heat_share, rig.interlocks.heat_share_known)


def _evidence(folder: Path, rig: RigConfig) -> list[float]:
    """Return the ratios of a run's heatings, where they are evidence."""
    with suppress(StoreError, OSError, sqlite3.Error), RunReader(folder) as reader:
        ratios = ratios_of(reader.event_data(KIND), rig)
        if ratios and _IN_HEAT.isdisjoint(trip.interlock for trip in reader.trips()) and under_way(folder) is None:
            return ratios
    return []


def ratios_of(data: Iterable[str], rig: RigConfig) -> list[float]:
    """Return the ratios in the data of events, in their order: those of this rig that are good evidence."""
    identity = (rig.name, beliefs_of(rig))
    ratios: list[float] = []
    for text in data:
        with suppress(ValueError, KeyError, TypeError):
            read = cast("dict[str, object]", json.loads(text))
            put_j, shown_j, rise_k = (float(cast("float", read[key])) for key in ("put_j", "shown_j", "rise_k"))
            if (read["rig"], read["beliefs"]) == identity and shown_j >= LEAST_J and rise_k >= LEAST_RISE_K:
                ratios.append(put_j / shown_j)
    return ratios


def ring_of(reader: RunReader, name: str) -> RingRun:
    """Return a run's record of its ring. Raises StoreError if it is unreadable."""
    ring = RingRun(name, reader.run().info.started_utc)
    for counter, value in reader.bus_statistics(BUS):
        if counter == "wheel":
            ring.segments.append(RingSegment())
            continue
        segment = ring.segments[-1]
        what, _, place = counter.partition(" ")
        if counter == "turns":
            segment.turns = value
        elif counter == "error at":
            segment.at_rev.append(value)
        elif what == "requests":
            segment.requests[int(place)] = round(value)
        elif what == "errors":
            segment.errors[int(place)] = round(value)
    return ring


RING: Final = RingPart(
    "Slip ring",
    "requests to the jacket over the wheel's slip ring",
    "the wheel",
    ring_of,
)
