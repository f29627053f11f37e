"""Which objects and registers of a device are read: what a set-up writes, and what it is told by."""

from __future__ import annotations

from collections.abc import Iterator

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.scan import Key
from drivers.drive_settings import plan
from drivers.modbus.scan import RegisterQuestion
from drivers.profiles.model import DeviceProfile
from tester.run.kept import IDENTITY, KEPT

STATE: tuple[Key, ...] = (
    (o.ERROR_REGISTER, 0),
    (o.STATUSWORD, 0),
    (o.ERROR_CODE, 0),
    (o.DIGITAL_INPUTS, 0),
    (o.POSITION_ACTUAL, 0),
    (o.VELOCITY_ACTUAL, 0),
)
"""How a drive is now."""


def written(config: AxisConfig) -> dict[Key, int]:
    """Return what every connect writes into an axis' drive but for its process data, by object.

    What stands in for an object that the maker's drive lacks has another value, which follows from the drive: it is
    left out, as are homing parameters of an axis that is not homed.
    """
    made = plan(config)
    settings = [*made.settings, *made.homing] if config.mode == "position" else made.settings
    found = {one.key: one.value for one in settings if one.substitute is None}
    return found | {(o.PRODUCER_HEARTBEAT, 0): round(config.heartbeat_s * 1000)}


def mapped(config: AxisConfig) -> dict[Key, int]:
    """Return what every connect writes into the objects of an axis' process data, by object."""
    found: dict[Key, int] = {}
    for one in plan(config).pdos:
        if one.mapped is None:
            continue
        found[one.communication, 1] = one.cob_id
        found[one.communication, 2] = one.kind
        entries = one.mapped.parameters()
        found[one.mapping, 0] = len(entries)
        found |= {(one.mapping, sub): entry for sub, entry in enumerate(entries, start=1)}
    return found


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
