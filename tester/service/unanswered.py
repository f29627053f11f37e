"""A question that no person answers in time ends its item, where the item chose that."""

from __future__ import annotations

from collections.abc import Callable

from tester.base import clock
from tester.base.words import rough_duration
from tester.queue.events import ItemSkipped
from tester.queue.fold import Queue
from tester.queue.items import QueueItem, Unanswered
from tester.service.queue_changes import Changes
from tester.service.watch import RunWatch


class AnswerLimit:
    """Measures how long the question of the run under way has waited, and stops its item where the item chose that.

    While the guard is open a person is at the machine: then the time begins anew.
    """

    def __init__(self, stop: Callable[[str], None]) -> None:
        """``stop`` stops the item under way for a reason."""
        self.text = ""
        """The question that waits, with its number; "" if none does."""
        self._since_s = 0.0
        self._stop = stop
        self._stopped = 0
        """Item that was stopped last."""

    def look(self, watch: RunWatch | None, changes: Changes) -> None:
        """Look at the run, between two ticks; stop the item whose time is over."""
        self._see(watch)
        entry = changes.queue.under_way
        if entry is None or entry.item.id == self._stopped or (policy := entry.item.unanswered) is None:
            return
        left_s = self.left_s(policy)
        if left_s is None or left_s > 0.0:
            return
        self._stopped, why = entry.item.id, f"no answer within {rough_duration(policy.within_s)} to {self.text}"
        skips, because = then_skips(entry.item, changes.queue)
        if skips and not entry.skip:
            changes.put(lambda _queue: ItemSkipped(entry.item.id, why), lambda _refusal: self._stop(why))
        else:
            self._stop(f"{why}; {because}" if because else why)

    def _see(self, watch: RunWatch | None) -> None:
        prompt = watch.prompt() if watch is not None else None
        text = f"question {prompt.number}: {prompt.text}" if prompt is not None else ""
        closed = watch is not None and watch.run.engine.ctx.readings.guard_closed
        if text != self.text or not closed:
            self.text, self._since_s = text, clock.monotonic()

    def left_s(self, policy: Unanswered | None) -> float | None:
        """Return the time until an item is stopped, s of wall time; None if nothing is asked, or it waits for ever."""
        if policy is None or not self.text:
            return None
        return policy.within_s - (clock.monotonic() - self._since_s)


def then_skips(item: QueueItem, queue: Queue) -> tuple[bool, str]:
    """Return whether the queue continues after an item without an answer, and if not, why."""
    if item.unanswered is None or not item.unanswered.skip:
        return False, ""
    following = queue.next
    if following is None:
        return True, ""
    if following.item.needs.asks:
        return False, f"item {following.item.id} asks for a person, too"
    return True, ""
