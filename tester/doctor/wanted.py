"""Which objects and registers of a device are read: what a set-up writes, and what it is told by."""

from __future__ import annotations

from collections.abc import Iterator

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.scan import Key
from drivers.modbus.scan import RegisterQuestion
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
"""How a drive is now."""


def objects_of(config: AxisConfig) -> list[Key]:
    """Return every object of an axis' drive that is looked at, each once."""
    return list(dict.fromkeys((*IDENTITY, *STATE, *KEPT, *written(config), *mapped(config))))


def configuration(profile: DeviceProfile, unit_id: int) -> Iterator[tuple[str, RegisterQuestion]]:
    """Yield name and question of every register of a device that is configuration: identity, set-up, parameters.

    A setpoint and a lease are commands, and are left out.
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
