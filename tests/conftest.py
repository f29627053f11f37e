"""What holds for every test: campaigns run only when they are asked for; no test finds the user's own settings."""

from __future__ import annotations

import os
from pathlib import Path

import pytest


def pytest_configure(config: pytest.Config) -> None:
    """Leave out what is marked `campaign`, unless -m says what to run. Set a folder of settings that does not exist: no
    service of a test sends notices to the addresses of whoever runs the tests.
    """
    os.environ["TESTER_CONFIG_DIR"] = str(Path(__file__).parent / "no-settings")
    if not config.option.markexpr:
        config.option.markexpr = "not campaign"
