"""What the queue does next, as a pure function of the queue and of evidence about the rig."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Final

from tester.base.screen import Check
from tester.base.words import local_hour
from tester.queue.fold import Queue
from tester.queue.predict import BETWEEN_S

FREE: Final = "free"
RIG: Final = "rig"
STANDSTILL: Final = "standstill"
ALARMS: Final = "alarms"
GUARD: Final = "guard"
COOL: Final = "temperature"
SPECIMEN: Final = "specimen"
RECIPE: Final = "recipe"
CALIBRATION: Final = "calibration"
DISK: Final = "disk"
CEILINGS: Final = "ceilings"

NEEDED: Final = (FREE, RIG, STANDSTILL, ALARMS, GUARD, COOL, SPECIMEN, RECIPE, CALIBRATION, DISK, CEILINGS)
"""The evidence before an item begins. A check that is missing or unknown is no evidence."""
PASSES: Final = frozenset({FREE, STANDSTILL, COOL, DISK})
"""Checks whose failure passes without a person; after any other failure the queue stands until a person starts it. A
guard that is closed again, or an alarm that is gone, must not let a machine begin by itself."""
FRESH_S: Final = 10.0
"""Greatest age of evidence, s [A]: collecting it takes one to three seconds."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """What is known about the rig for one item. ``revision``: of the queue for which it was collected."""

    item: int
    revision: int
    checks: tuple[Check, ...]
    age_s: float = 0.0


@dataclass(frozen=True, slots=True)
class StartItem:
    """The item may begin."""

    item: int


@dataclass(frozen=True, slots=True)
class Wait:
    """Nothing begins; ``reason`` in words. ``stands``: the queue must stand until a person starts it."""

    reason: str
    stands: bool = False


@dataclass(frozen=True, slots=True)
class Look:
    """Evidence about the rig is needed for this item first; ``reason`` in words."""

    item: int
    reason: str


def decide(queue: Queue, evidence: Evidence | None, now_utc: str) -> StartItem | Wait | Look:
    """Return what the queue does next: start an item, look at the rig for one, or wait with a reason in words.

    ``now_utc``: the wall clock, ISO 8601 with a time zone.
    """
    if (held := waits(queue)) is not None:
        return held
    if late := too_late(queue, queue.until_utc, now_utc):
        return Wait(late, stands=True)
    first = queue.next
    assert first is not None  # otherwise the queue waits
    number = first.item.id
    if evidence is None or evidence.item != number or evidence.revision != queue.revision:
        return Look(number, f"the rig is checked for item {number}")
    if not 0.0 <= evidence.age_s <= FRESH_S:
        return Look(number, f"the rig is checked again for item {number}: the last look is {evidence.age_s:.0f} s old")
    known = {check.name: check for check in evidence.checks}
    failed = [_failed(known.get(name), name) for name in NEEDED if (check := known.get(name)) is None or not check.ok]
    failed += [_failed(check, check.name) for check in evidence.checks if check.name not in NEEDED and not check.ok]
    if failed:
        stands = any(name not in PASSES for name, _ in failed)
        return Wait(f"item {number} does not begin: {'; '.join(text for _, text in failed)}", stands)
    return StartItem(number)


def too_late(queue: Queue, until_utc: str, now_utc: str) -> str:
    """Return why the next item must not begin now if it has to end by ``until_utc`` ("": never); "" if it may.

    Its latest end counts, the end of its interval of 95 %: who asks for the rig at an hour relies on it.
    """
    first = queue.next
    if not until_utc or first is None:
        return ""
    latest_s = BETWEEN_S + first.item.needs.high_s
    now, until = datetime.fromisoformat(now_utc), datetime.fromisoformat(until_utc)
    if now + timedelta(seconds=latest_s) <= until:
        return ""
    latest = local_hour((now + timedelta(seconds=latest_s)).isoformat())
    return f"item {first.item.id} may last until {latest}, and the queue goes until {local_hour(until_utc)}"


def waits(queue: Queue) -> Wait | None:
    """Return why the queue begins nothing, whatever the rig's state; None if the rig's state decides."""
    if (now := queue.under_way) is not None:
        return Wait(f"item {now.item.id} {'runs' if now.run else 'begins'}")
    if not queue.going:
        return Wait(f"standing: {queue.why}")
    return None if queue.next is not None else Wait("no item waits")


def _failed(check: Check | None, name: str) -> tuple[str, str]:
    if check is None:
        return name, f"{name}: not known"
    text = check.text or ("not known" if check.ok is None else "not met")
    return name, f"{name}: {text}"
