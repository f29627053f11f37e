"""Changes of the queue, one after another, each on the disk before the next; the scan never waits for the disk."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Final, NamedTuple

from tester.queue.events import QueueEvent
from tester.queue.fold import Queue, QueueError
from tester.queue.record import QueueRecord

Make = Callable[[Queue], QueueEvent]
"""Makes the event from the queue as it is then; raises QueueError to refuse the change."""
Then = Callable[[str], None]
"""Called after a change: with "", or why it was refused."""
UNWRITTEN: Final = "the queue's record cannot be written"


class _Change(NamedTuple):
    make: Make
    then: Then


class Changes:
    """Writes changes in a thread. ``queue`` is what is on the disk; ``broken``: why nothing can be written any more."""

    def __init__(self, record: QueueRecord) -> None:
        """Write into ``record``, which this object then owns."""
        self.record = record
        self.broken = ""
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="queue record")
        self._waiting: deque[_Change] = deque()
        self._writing: tuple[Future[Queue], Then] | None = None

    @property
    def queue(self) -> Queue:
        """The queue as it is on the disk."""
        return self.record.queue

    @property
    def pending(self) -> bool:
        """Whether a change is not on the disk yet."""
        return self._writing is not None or bool(self._waiting)

    def put(self, make: Make, then: Then = lambda _refusal: None) -> None:
        """Ask for a change; ``look`` carries it out."""
        self._waiting.append(_Change(make, then))

    def look(self) -> None:
        """Go on with the changes; never wait."""
        if self._writing is not None:
            future, then = self._writing
            if not future.done():
                return
            self._writing = None
            then(self._outcome(future))
        while self._waiting and self._writing is None:
            change = self._waiting.popleft()
            if self.broken:
                change.then(self.broken)
                continue
            try:
                event = change.make(self.queue)
                self.record.prepared(event)
            except QueueError as error:
                change.then(str(error))
                continue
            self._writing = self._thread.submit(self.record.append, event), change.then

    def _outcome(self, future: Future[Queue]) -> str:
        error = future.exception()
        if isinstance(error, OSError):
            self.broken = f"{UNWRITTEN}: {error}"
            return self.broken
        if error is not None and not isinstance(error, QueueError):
            raise error
        return str(error or "")

    def close(self) -> None:
        """Write what waits, and close the record."""
        while self.pending:
            if self._writing is not None:
                self._writing[0].exception()  # waits for it
            self.look()
        self._thread.shutdown()
        self.record.close()
