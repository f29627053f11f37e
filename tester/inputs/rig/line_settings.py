"""The settings of Modbus lines beside those of the devices on them, as their profiles have them."""

from __future__ import annotations

from drivers.profiles import ProfileError
from tester.inputs.rig.config import Rig
from tester.inputs.rig.profiles import profile_of


def other_settings(rig: Rig) -> list[str]:
    """Return the lines that are set otherwise than profiles of devices on them say, a text each with what to do.

    Most devices can be set to other values than their profile's, which are those of the maker or our advice: so this
    refuses nothing. A line over TCP has settings of the gateway's.
    """
    found: list[str] = []
    for key, line in rig.lines.items():
        if line.framing != "rtu":
            continue
        there = [(name, device) for name, device in rig.devices.items() if device.line == key]
        for name, device in there:
            try:
                due = profile_of(device.profile).line
            except ProfileError:
                continue  # said elsewhere
            if (due.baud, due.parity) != (line.baud, line.parity):
                found.append(
                    f"lines.{key} has {line.baud} baud, parity {line.parity}; {name} by its profile {device.profile}"
                    f" {due.baud} baud, parity {due.parity}: set one as the other (`tester doctor` finds what answers)"
                )
    return found
