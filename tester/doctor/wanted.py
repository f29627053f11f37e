"""The objects and registers of a device to read: its identity and everything that a set-up writes."""

from __future__ import annotations

from collections.abc import Iterator

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.scan import Key
from drivers.modbus.register_scan import RegisterQuestion
from drivers.profiles.model import DeviceProfile
from tester.run.kept import IDENTITY, KEPT
from tester.run.set_up import mapped, written

STATE: tuple[Key, ...] = (
    (o.ERROR_REGISTER, 0),
    (o.STATUSWORD, 0),
    (o.ERROR_CODE, 0),
    (o.DIGITAL_INPUTS, 0),
    (o.POSITION_ACTUAL, 0),
    (o.VELOCITY_ACTUAL, 0),
)
"""Present state of a drive."""


def objects_of(config: AxisConfig) -> list[Key]:
    """Return every object to read from an axis' drive, each once."""
    return list(dict.fromkeys((*IDENTITY, *STATE, *KEPT, *written(config), *mapped(config))))


def configuration(profile: DeviceProfile, unit_id: int) -> Iterator[tuple[str, RegisterQuestion]]:
    """Yield name and question of every configuration register of a device: identity, set-up, parameters.

    Setpoint and lease are commands, and are left out.
    """
    reads = 3 if 3 in profile.functions else 4
    identity = profile.identity
    if identity is not None:
        yield "device type", RegisterQuestion(unit_id, identity.function, identity.address, 1)
    for write in profile.setup:
        yield write.name, RegisterQuestion(unit_id, reads, write.address, 1)
    for name, signal in profile.writes.items():
        if name not in ("setpoint", "lease"):
            yield name, RegisterQuestion(unit_id, reads, signal.address, signal.size)
