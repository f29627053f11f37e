"""Describes what the rig's devices do by themselves once the process that owns the rig is gone."""

from __future__ import annotations

from drivers.temperature_controller import JACKET_LEASE_S
from tester.inputs.rig.profiles import profile_of
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.panel import drives_alone

PRESS = "The press stops where it is: where no spring lifts it, its load stays on the wheel."


def left_alone(rig: RigConfig) -> str:
    """Return what drives and heating do, and by when, from the rig file's numbers."""
    return drives_alone(rig, PRESS, _heating(rig))


def _heating(rig: RigConfig) -> str:
    jacket = rig.devices["jacket"]
    profile = profile_of(jacket.profile)
    if "lease" in profile.writes:
        return f"The jacket stops heating by itself ({JACKET_LEASE_S:g} s without a command)."
    if jacket.heat_off == "fallback" and profile.falls_back_s is not None:
        return f"The jacket falls back to a setpoint of no heat ({profile.falls_back_s:g} s without a command)."
    if jacket.heat_off == "relay":
        return "The jacket has no watchdog of its own: a relay, the rig file says, takes its supply. See to it."
    return "The jacket has no watchdog of its own: switch its supply off."
