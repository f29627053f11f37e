"""The jacket's slip ring in the record of a run (``ring_watch`` stores it)."""

from __future__ import annotations

from typing import Final

from tester.analysis.ring_errors import RingSegment
from tester.analysis.ring_runs import RingRun
from tester.kinds.wheel_on_belt.image.ring_watch import BUS
from tester.results.ring_part import RingPart
from tester.store.run_reader import RunReader


def ring_of(reader: RunReader, name: str) -> RingRun:
    """Return a run's record of its ring. Raises StoreError if it is unreadable."""
    found = RingRun(name, reader.run().info.started_utc)
    for counter, value in reader.bus_statistics(BUS):
        if counter == "wheel":
            found.segments.append(RingSegment())
            continue
        segment = found.segments[-1]
        what, _, place = counter.partition(" ")
        if counter == "turns":
            segment.turns = value
        elif counter == "error at":
            segment.at_rev.append(value)
        elif what == "requests":
            segment.requests[int(place)] = round(value)
        elif what == "errors":
            segment.errors[int(place)] = round(value)
    return found


RING: Final = RingPart(
    "Slip ring",
    "requests to the jacket over the wheel's slip ring",
    "the wheel",
    ring_of,
)
