"""What the rig's devices do by themselves when the process that owns the rig is gone: their own watchdogs, in words."""

from __future__ import annotations

from drivers.jacket import LEASE_S
from tester.inputs.rig.profiles import profile_of
from tester.kinds.wheel_on_belt.rig import RigConfig

PRESS = "The press stops where it is: where no spring lifts it, its load stays on the wheel."


def left_alone(rig: RigConfig) -> str:
    """Return what drives and heating do, and by when, from the rig file's numbers."""
    if rig.can.interface == "sim":
        return "The simulated rig was part of the service and is gone with it."
    return f"{_drives(rig)} {PRESS} {_heating(rig)}"


def _drives(rig: RigConfig) -> str:
    """Return by when each drive makes its quick stop: the first of its two watchdogs that runs out."""
    by_ms: dict[int, list[str]] = {}
    for name, axis in rig.drives().items():
        waits = [wait for wait in (axis.consumer_heartbeat_s, axis.rpdo_deadline_s) if wait > 0.0]
        by_ms.setdefault(round(1e3 * min(waits)), []).append(name)
    stops = "; ".join(f"{', '.join(names)}: {ms} ms" for ms, names in sorted(by_ms.items()))
    return f"Without heartbeat and setpoints each drive makes a quick stop by itself ({stops})."


def _heating(rig: RigConfig) -> str:
    jacket = rig.devices["jacket"]
    profile = profile_of(jacket.profile)
    if "lease" in profile.writes:
        return f"The jacket stops heating by itself ({LEASE_S:g} s without a command)."
    if jacket.heat_off == "fallback" and profile.falls_back_s is not None:
        return f"The jacket falls back to a setpoint of no heat ({profile.falls_back_s:g} s without a command)."
    if jacket.heat_off == "relay":
        return "The jacket has no watchdog of its own: a relay, the rig file says, takes its supply. See to it."
    return "The jacket has no watchdog of its own: switch its supply off."
