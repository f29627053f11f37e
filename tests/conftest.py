"""What holds for every test: campaigns run only when they are asked for."""

from __future__ import annotations

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Leave out what is marked `campaign`, unless -m says what to run."""
    if not config.option.markexpr:
        config.option.markexpr = "not campaign"
