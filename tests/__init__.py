"""Tests and campaigns. None finds the settings of whoever starts it: a service would send notices to real addresses."""

import os
from pathlib import Path

os.environ["TESTER_CONFIG_DIR"] = str(Path(__file__).parent / "no-settings")
"""A folder that does not exist."""
