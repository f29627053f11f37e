"""Defines the safe outputs, in one place."""

from __future__ import annotations

from tester.kinds.wheel_on_belt.image.process import Setpoints
from tester.kinds.wheel_on_belt.rig import RigConfig


def safe_outputs(setpoints: Setpoints, rig: RigConfig, *, fast: bool) -> None:
    """Overwrite the commands with the safe ones, all in this scan; no action waits for another.

    Heat off and contactor open, press retracting, both drives to zero on equal linear decelerations (``fast``: by
    quick stop, and the press as fast as it goes). Positioned axes stay where they are: moving them would not help.
    """
    setpoints.heat = False
    setpoints.contactor = False
    setpoints.hub_c = rig.loops.heat.hub_min_c
    setpoints.press_mm_s = -rig.axes.press.max_speed if fast else -rig.loops.load.lift_speed_mm_s
    setpoints.wheel_rad_s = 0.0
    setpoints.belt_m_s = 0.0
    setpoints.quick_stop = fast


def no_outputs(setpoints: Setpoints, rig: RigConfig) -> None:
    """Set every command to zero and want no power: at rest. What was escalated stays so until it is acknowledged."""
    safe_outputs(setpoints, rig, fast=False)
    setpoints.press_mm_s = 0.0
    setpoints.enable = False


def mirror_emergency(setpoints: Setpoints, rig: RigConfig) -> None:
    """Set every command to zero: the hardware has taken over, and nothing may start when it gives the power back.

    The quick stop ends in power off by itself; the press wants no power, so that its spring lifts it.
    """
    safe_outputs(setpoints, rig, fast=True)
    setpoints.press_mm_s = 0.0
    setpoints.enable = False
