"""A rubber wheel pressed on an abrasive belt: plant, rig, faults, and what counts as harm."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.machines import SimulatedMachine
from sim.machines.wheel_on_belt.rig import WheelRig
from sim.machines.wheel_on_belt.state_log import LOG_COLUMNS, LOG_DECIMALS, log_row

if TYPE_CHECKING:
    from sim.faults.language import FaultLanguage


def _language() -> FaultLanguage:
    from sim.machines.wheel_on_belt.faults import LANGUAGE

    return LANGUAGE


MACHINE = SimulatedMachine(WheelRig, _language, LOG_COLUMNS, log_row, LOG_DECIMALS)
