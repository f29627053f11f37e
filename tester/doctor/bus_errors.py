"""A probe of the CAN bus: error frames in the watch, and what the adapter says of itself."""

from __future__ import annotations

from collections.abc import Iterator

from tester.doctor.can_probes import BUS, WIRING
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, ok, warning

_STATES = {
    "passive": "error-passive: it has seen many errors, and marks none of its own any more",
    "error": "in an error state: it takes part no more",
}


def errors(e: Examination) -> Iterator[Finding]:
    """Count error frames, and tell an adapter's state; nothing where the adapter tells neither."""
    watch = e.watch
    if watch.can_errors is not None and watch.seconds:
        count = sum(watch.can_errors.values())
        said = ", ".join(f"{number} {kind}" for kind, number in watch.can_errors.items())
        if count:
            yield warning(BUS, f"error frames in {watch.seconds:.0f} s: {said}", f"look at {WIRING}; shields, stubs")
        else:
            yield ok(BUS, f"no error frame in {watch.seconds:.0f} s")
    words = _STATES.get(watch.can_state)
    if words is not None:
        yield fault(BUS, f"the adapter is {words}", f"look at {WIRING}; plug the adapter out and in")
