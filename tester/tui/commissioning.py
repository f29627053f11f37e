"""From the operator's screen to the commissioning of the rig: a process of its own, which takes the rig itself."""

from __future__ import annotations

import subprocess
from typing import Final

from tester.base.children import tester_command
from tester.base.source import InvalidSource
from tester.run.rigs import load_rig
from tester.service.state import StateView
from tester.tui.host import TuiOptions

FREE: Final = ("OFFLINE", "IDLE", "INTERRUPTED")
"""Modes of a service that does not have the rig: it takes the buses for a run or manual mode, and gives them back."""


def begins_here(options: TuiOptions, state: StateView) -> bool:
    """Tell whether the rig that this screen was told of is the service's."""
    try:
        return options.address is None and load_rig(options.rig).name == state.rig
    except (InvalidSource, OSError):
        return False


def commission_rig(options: TuiOptions) -> None:
    """Commission, and come back when it has ended; the terminal is the other process's meanwhile."""
    command = tester_command("commission", options.rig, "--tui", "--out", str(options.runs))
    command += ["--ascii"] if options.plain else []
    command += ["--theme", options.theme] if options.theme else []
    subprocess.run(command, check=False)
