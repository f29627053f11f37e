"""What an axis and its drive exchange in every scan: mode of operation, target, reading, and the maps of the PDOs."""

from __future__ import annotations

from dataclasses import dataclass

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen import pdo
from drivers.canopen.objects import OperationMode
from drivers.canopen.pdo import PdoMap
from drivers.drives.drive_model import Key


@dataclass(frozen=True, slots=True)
class PdoSetting:
    """One PDO; it is off where ``mapped`` is None."""

    communication: int
    mapping: int
    cob_id: int
    kind: int
    mapped: PdoMap | None


def mode_of(config: AxisConfig) -> OperationMode:
    """Return the mode of operation of an axis."""
    if config.mode == "position":
        return OperationMode.PROFILE_POSITION
    return OperationMode.VELOCITY if config.drive.inverter else OperationMode.PROFILE_VELOCITY


def target_of(config: AxisConfig) -> Key:
    """Return the object of an axis' target."""
    if config.mode == "position":
        return o.TARGET_POSITION, 0
    return (o.VL_TARGET_VELOCITY if config.drive.inverter else o.TARGET_VELOCITY), 0


def actual_of(config: AxisConfig) -> Key:
    """Return the object of an axis' reading in TPDO1."""
    if config.feedback == "position":
        return o.POSITION_ACTUAL, 0
    return (o.VL_VELOCITY_ACTUAL if config.drive.inverter else o.VELOCITY_ACTUAL), 0


def tpdo1_of(config: AxisConfig) -> PdoMap:
    """Return the map of an axis' readings."""
    if config.drive.inverter:
        return pdo.TPDO1_INVERTER if config.drive.torque else pdo.TPDO1_NO_TORQUE
    return pdo.TPDO1_POSITION if config.feedback == "position" else pdo.TPDO1_VELOCITY


def pdo_settings(config: AxisConfig, *, inputs_with_sync: bool = False) -> list[PdoSetting]:
    """Return the axis' PDOs; ``inputs_with_sync``: the digital inputs come with every SYNC, not by event."""
    node = config.node_id
    rpdo1 = pdo.RPDO1_POSITION if config.mode == "position" else pdo.RPDO1_VELOCITY
    if config.drive.inverter:
        rpdo1 = pdo.RPDO1_INVERTER
    io = config.digital_io
    tpdo2 = pdo.TPDO2_INPUTS if io else pdo.TPDO2_STATUS if config.standstill_by_pdo else None
    kind2 = pdo.SYNCHRONOUS if io and inputs_with_sync else pdo.EVENT_DRIVEN
    return [
        PdoSetting(o.RPDO_COMMUNICATION, o.RPDO_MAPPING, o.RPDO1_BASE + node, pdo.SYNCHRONOUS, rpdo1),
        PdoSetting(o.RPDO_COMMUNICATION + 1, o.RPDO_MAPPING + 1, o.RPDO2_BASE + node, pdo.EVENT_DRIVEN,
                   pdo.RPDO2_OUTPUTS if io else None),
        PdoSetting(o.TPDO_COMMUNICATION, o.TPDO_MAPPING, o.COB_NO_RTR | o.TPDO1_BASE + node, pdo.SYNCHRONOUS,
                   tpdo1_of(config)),
        PdoSetting(o.TPDO_COMMUNICATION + 1, o.TPDO_MAPPING + 1, o.COB_NO_RTR | o.TPDO2_BASE + node, kind2, tpdo2),
    ]
