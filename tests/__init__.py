"""Tests and campaigns. They ignore the user's settings and run at about noon local time."""

from __future__ import annotations

import os
import time
from pathlib import Path

os.environ["TESTER_CONFIG_DIR"] = str(Path(__file__).parent / "no-settings")
"""A folder that does not exist: a service would send notices to real addresses."""

if hasattr(time, "tzset"):  # POSIX; elsewhere the hour of the computer holds
    # The morning's message and a queue's windows come at a local hour, also in the processes of a test.
    os.environ["TZ"] = f"LAB{time.gmtime().tm_hour - 12:+d}"
    time.tzset()
