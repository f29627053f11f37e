"""Settings of every test: campaigns run only on request, and the garbage collector runs seldom."""

from __future__ import annotations

import gc
import time
from collections.abc import Iterator

import pytest

YOUNG_OBJECTS = 50_000
"""The garbage collector looks at young objects when there are so many more of them; Python's own 700 cost 5 % of a
simulated run's CPU time [A]."""


def pytest_configure(config: pytest.Config) -> None:
    """Skip tests marked `campaign` unless -m selects tests."""
    if not config.option.markexpr:
        config.option.markexpr = "not campaign"
    gc.set_threshold(YOUNG_OBJECTS, 20, 20)


def pytest_collection_finish() -> None:
    """Spare the collector the tests themselves: some hundred thousand objects that stay to the end."""
    gc.collect()
    gc.freeze()


@pytest.fixture
def noon(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Move this process and its children to a zone where it is about noon (POSIX; elsewhere the hour stays).

    The morning's message and a queue's windows come at a local hour: a test must not meet them by chance.
    """
    if not hasattr(time, "tzset"):
        yield
        return
    with monkeypatch.context() as patch:
        patch.setenv("TZ", f"LAB{time.gmtime().tm_hour - 12:+d}")
        time.tzset()
        yield
    time.tzset()
