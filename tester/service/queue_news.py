"""The message ``queue``: what the queue does or waits for, and when its items begin and end."""

from __future__ import annotations

from typing import Final

from tester.base import clock
from tester.base.words import local_hour
from tester.queue.decide import waits
from tester.queue.fold import Queue
from tester.queue.items import QueueItem
from tester.queue.view import view_of
from tester.service.state_publisher import Desk
from tester.service.unanswered import AnswerLimit

NEWS_S: Final = 10.0
"""Period of the message while the queue goes, s: predicted times follow the run."""


class QueueNews:
    """Sends the queue when it, or its state in words, has changed, and every ``NEWS_S`` while it goes."""

    def __init__(self, desk: Desk, limit: AnswerLimit) -> None:
        """Send through the gateway of ``desk``, whose run it reads. ``limit``: of a question's time."""
        self._desk = desk
        self._limit = limit
        self._told: tuple[int, str] | None = None
        self._due_s = float("-inf")

    def publish(self, queue: Queue, broken: str, wait: str) -> None:
        """Send the queue if there is news. ``broken``: why it cannot be used; ``wait``: why the next item waits."""
        state = f"not usable: {broken}" if broken else self._state(queue, wait)
        now_s = clock.monotonic()
        follows = (queue.going or queue.under_way is not None) and now_s >= self._due_s
        if self._told == (queue.revision, state) and not follows:
            return
        self._told, self._due_s = (queue.revision, state), now_s + NEWS_S
        view = view_of(queue, state, clock.utc_now(), self._left_s(queue), broken)
        self._desk.gateway.queue(view)
        self._desk.notices.queue(view)

    def _state(self, queue: Queue, wait: str) -> str:
        """Return what the queue does or waits for, in words; never empty."""
        under_way, watch = queue.under_way, self._desk.watch
        if under_way is not None and watch is not None:
            number = under_way.item.id
            if (prompt := watch.prompt()) is not None:
                text = f"question {prompt.number}: {prompt.text}"
                return f"item {number} waits for a person: {text}{self._deadline(under_way.item)}"
            mode, why, _ = watch.mode
            if mode != "RUN":
                return f"item {number} runs: {mode}" + (f", {why}" if why else "")
        if (held := waits(queue)) is not None:
            return held.reason
        first = queue.next
        return wait or f"item {first.item.id if first is not None else 0} is next"

    def _deadline(self, item: QueueItem) -> str:
        """Return in words when an item is stopped without an answer; "" if it waits as long as it takes."""
        left_s = self._limit.left_s(item.unanswered)
        if left_s is None:
            return ""
        return f" (without an answer the item is stopped at {local_hour(clock.utc_in(left_s))})"

    def _left_s(self, queue: Queue) -> float | None:
        """Return the seconds to the end of the item under way; None if they are not known."""
        watch, run, under_way = self._desk.watch, self._desk.run, queue.under_way
        if watch is None or run is None or under_way is None or under_way.run != run.name:
            return None
        left_s = watch.track.standing().left_s
        return None if left_s is None or run.pace is None else left_s / run.pace
