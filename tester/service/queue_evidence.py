"""The owner's part of the evidence before an item of the queue begins; ``tester.queue.assess`` collects the rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from tester.base import clock
from tester.base.screen import Check
from tester.base.words import rough_duration
from tester.queue.assess import Assessment
from tester.queue.decide import ALARMS, COOL, FREE, GUARD, STANDSTILL
from tester.service.preflight import alarms_check
from tester.service.state_publisher import Desk
from tester.service.watch import LastSeen

SEEN_S: Final = 60.0
"""Greatest age of the last scan that counts as evidence, s [A]: the next item begins some seconds after the last."""
ATTESTED_S: Final = 600.0
"""Greatest time since a person started the queue for which their look at the machine counts, s [A]: a walk from the
machine to the screen. The run checks guard and safety chain again before anything moves."""


@dataclass(frozen=True, slots=True)
class Attested:
    """A person who started the queue, and when (tester.base.clock.monotonic)."""

    by: str
    at_s: float


def evidence_of(desk: Desk, found: Assessment, attested: Attested | None, busy: str) -> tuple[Check, ...]:
    """Return all checks for an item: those that ``found`` has, and those of the owner, which count where both have one
    that fails. ``busy``: why nothing may begin, "" if it may.
    """
    own = [*_own(desk, attested, busy)]
    failing = {check.name for check in own if not check.ok}
    names = {check.name for check in own if check.name != FREE}
    kept = [check for check in found.checks if check.name not in failing | names]
    free = [check for check in kept if check.name == FREE]
    return (*kept, *(check for check in own if not (check.name == FREE and check.ok and free)))


def objection(desk: Desk) -> str:
    """Return why an item that is taken must not begin after all; "" if it may. Its record took some milliseconds."""
    check = _alarms(desk)
    return "" if check.ok else f"{check.name}: {check.text}"


def _own(desk: Desk, attested: Attested | None, busy: str) -> Iterator[Check]:
    yield Check(FREE, not busy, busy or "nothing else is under way")
    yield _alarms(desk)
    if desk.rig.can.interface == "sim":
        for name in (STANDSTILL, GUARD, COOL):
            yield Check(name, True, "a simulated rig is new at every start")
        return
    now_s = clock.monotonic()
    if attested is not None and now_s - attested.at_s <= ATTESTED_S:
        ago = f"{attested.by} started the queue {rough_duration(now_s - attested.at_s)} ago"
        for name in (STANDSTILL, GUARD, COOL):
            yield Check(name, True, f"{ago}; the run checks it again before anything moves")
        return
    yield from _seen(desk.seen, now_s)


def _alarms(desk: Desk) -> Check:
    if desk.latched:
        return Check(ALARMS, False, f"the rig is latched ({desk.latched}): acknowledge it first")
    if desk.interrupted:
        return Check(ALARMS, False, f"{desk.interrupted[-1]} was cut off: resume or acknowledge it first")
    check = alarms_check(desk.alarms.listed())
    return Check(ALARMS, check.ok, check.text)


def _seen(seen: LastSeen | None, now_s: float) -> Iterator[Check]:
    """Yield what the last scan of the run before showed."""
    if seen is None or not now_s - seen.at_s <= SEEN_S:
        for name in (STANDSTILL, GUARD, COOL):
            yield Check(name, None, "not seen lately: look at the machine, and start the queue again")
        return
    rests = seen.mode == "IDLE"
    yield Check(STANDSTILL, rests, f"the last run left the rig in {seen.mode}")
    open_ = [f"{check.name}: {check.text or 'not met'}" for check in seen.checks if not check.ok]
    yield Check(GUARD, bool(seen.checks) and not open_, "; ".join(open_) or "as the last run saw it")
    yield Check(COOL, rests, "the last run cooled down" if rests else f"the last run ended in {seen.mode}")
