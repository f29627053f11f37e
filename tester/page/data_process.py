"""The process that reads stored runs for pages, ``python -m tester.page.data_process LINK``: it ends with its owner.

A request is ``{"query", "keys", "by"}``; its settings are the folder of the runs (``tester.service.asked_process``).
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from functools import partial
from pathlib import Path

from pydantic import JsonValue

from tester.base.source import InvalidSource
from tester.base.trouble import TroubleError, in_words
from tester.page.stored.asked import answer
from tester.page.stored.run_cache import QuestionError, RunCache
from tester.service.asked_process import NICE, RefusedQuestionError, answer_all
from tester.service.child_process import link_to_owner


def begin(runs: JsonValue) -> Callable[[JsonValue], JsonValue]:
    """Return what answers a request about the runs in a folder."""
    return partial(_answered, RunCache(Path(str(runs))))


def _answered(cache: RunCache, request: JsonValue) -> JsonValue:
    match request:
        case {"query": str(query), "keys": dict(keys), "by": str(by)}:
            pass
        case _:
            raise RefusedQuestionError("not a request")
    try:
        return answer(cache, query, keys, by)
    except (QuestionError, TroubleError, InvalidSource, OSError, sqlite3.Error) as error:
        raise RefusedQuestionError(in_words(error)) from error


if __name__ == "__main__":
    answer_all(link_to_owner(NICE), begin)
