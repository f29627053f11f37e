"""Tests and campaigns. They find no settings of whoever starts them, and show local times in UTC."""

from __future__ import annotations

import os
import time
from pathlib import Path

os.environ["TESTER_CONFIG_DIR"] = str(Path(__file__).parent / "no-settings")
"""A folder that does not exist: a service would send notices to real addresses."""

os.environ["TZ"] = "UTC"
if hasattr(time, "tzset"):  # POSIX
    time.tzset()
