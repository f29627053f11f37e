"""The gateway's copy of the queue, and its answers to questions about it."""

from __future__ import annotations

from pydantic import JsonValue, TypeAdapter
from pydantic_core import from_json, to_json

from tester.base import clock
from tester.queue.check import night_check, window
from tester.queue.view import QueueView
from tester.service.commands import QueueCheck, QueueQuery
from tester.service.protocol import Accepted, Refused, encode

VIEW: TypeAdapter[QueueView] = TypeAdapter(QueueView)


class QueueAnswers:
    """Answers from ``encoded``, the newest queue as JSON: ``null`` before the owner has sent one."""

    def __init__(self) -> None:
        """Begin without a queue."""
        self.encoded = b"null"

    def reply(self, number: int, question: QueueQuery) -> bytes:
        """Return the answer to a question with this number, as a message."""
        if self.encoded == b"null":
            return encode(Refused(number, "the service has not read its queue yet"))
        if isinstance(question, QueueCheck):
            now_utc = clock.utc_now()
            times = window(question.start, question.end, now_utc)
            found = night_check(VIEW.validate_json(self.encoded), now_utc, *times)
            result: JsonValue = from_json(to_json(found))
            return encode(Accepted(number, result))
        return encode(Accepted(number, from_json(self.encoded)))
