"""Settings of every test: campaigns run only on request, and the garbage collector runs seldom."""

from __future__ import annotations

import gc

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
