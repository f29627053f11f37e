"""The object dictionaries of a servo drive and of a frequency inverter, described once.

The client takes the types of its SDO requests from here, the simulated drive takes its objects and defaults, and
the EDS writer takes its text. Contents: CiA 301, CiA 402-2. Defaults are those of a new drive:
no heartbeat, no consumer, PDO 1 mapped for profile velocity, PDO 2 off.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from drivers.canopen import objects as o
from drivers.canopen.objects import DataType

Access = Literal["ro", "wo", "rw", "const"]

VENDOR_ID = 0x000F_71C7
"""0x1018:01 of the simulated drive; not a registered vendor [A]."""
PRODUCT_CODE = 0x0000_0402
REVISION = 0x0001_0000


@dataclass(frozen=True, slots=True)
class Entry:
    """One object: address, type, access, default value and name.

    ``plus_node`` adds the node id to the default (COB-IDs). ``mappable`` allows the object in a PDO.
    """

    index: int
    sub: int
    type: DataType
    access: Access
    default: int | str
    name: str
    mappable: bool = False
    plus_node: bool = False

    @property
    def bits(self) -> int:
        """Width in a PDO, 8..32; 0 for text."""
        return o.BITS.get(self.type, 0)

    @property
    def readable(self) -> bool:
        """Whether an SDO upload is allowed."""
        return self.access != "wo"

    @property
    def writable(self) -> bool:
        """Whether an SDO download is allowed."""
        return self.access in ("rw", "wo")

    def initial(self, node_id: int) -> int | str:
        """Return the default of the device with this node id (1..127)."""
        if self.plus_node and isinstance(self.default, int):
            return self.default + node_id
        return self.default


def mapping(index: int, sub: int, bits: int) -> int:
    """Return the U32 of one PDO mapping entry."""
    return index << 16 | sub << 8 | bits


_I8, _I16, _I32 = DataType.I8, DataType.I16, DataType.I32
_U8, _U16, _U32, _TEXT = DataType.U8, DataType.U16, DataType.U32, DataType.TEXT


def _pdo(communication: int, map_index: int, name: str, cob_id: int, kind: int,
         mapped: tuple[int, ...]) -> list[Entry]:
    """Return communication and mapping parameters of one PDO (CiA 301, 7.5.2.35-38)."""
    entries = [
        Entry(communication, 0, _U8, "const", 5, f"{name} communication: highest sub-index"),
        Entry(communication, 1, _U32, "rw", cob_id, f"{name} COB-ID", plus_node=True),
        Entry(communication, 2, _U8, "rw", kind, f"{name} transmission type"),
        Entry(communication, 3, _U16, "rw", 0, f"{name} inhibit time (100 us)"),
        Entry(communication, 5, _U16, "rw", 0, f"{name} event timer (ms)"),
        Entry(map_index, 0, _U8, "rw", len(mapped), f"{name} mapping: number of objects"),
    ]
    for sub in range(1, 5):
        value = mapped[sub - 1] if sub <= len(mapped) else 0
        entries.append(Entry(map_index, sub, _U32, "rw", value, f"{name} mapping {sub}"))
    return entries


def _communication() -> list[Entry]:
    entries = [
        Entry(o.DEVICE_TYPE, 0, _U32, "const", 0x0002_0192, "device type"),
        Entry(o.ERROR_REGISTER, 0, _U8, "ro", 0, "error register", mappable=True),
        Entry(o.ERROR_HISTORY, 0, _U8, "rw", 0, "error history: number of errors"),
        *(Entry(o.ERROR_HISTORY, sub, _U32, "ro", 0, f"error history {sub}") for sub in range(1, 9)),
        Entry(o.SYNC_COB_ID, 0, _U32, "rw", o.SYNC_ID, "SYNC COB-ID"),
        Entry(o.SYNC_PERIOD, 0, _U32, "rw", 0, "SYNC period (us)"),
        Entry(o.SYNC_WINDOW, 0, _U32, "rw", 0, "SYNC window (us)"),
        Entry(o.DEVICE_NAME, 0, _TEXT, "const", "friction-tester servo drive", "device name"),
        Entry(o.HARDWARE_VERSION, 0, _TEXT, "const", "1.0", "hardware version"),
        Entry(o.SOFTWARE_VERSION, 0, _TEXT, "const", "1.0.0", "software version"),
        Entry(o.STORE_PARAMETERS, 0, _U8, "const", 1, "store parameters: highest sub-index"),
        Entry(o.STORE_PARAMETERS, 1, _U32, "rw", 1, "store all parameters"),
        Entry(o.RESTORE_PARAMETERS, 0, _U8, "const", 1, "restore parameters: highest sub-index"),
        Entry(o.RESTORE_PARAMETERS, 1, _U32, "rw", 1, "restore all parameters"),
        Entry(o.EMERGENCY_COB_ID, 0, _U32, "rw", o.EMERGENCY_BASE, "EMCY COB-ID", plus_node=True),
        Entry(o.EMERGENCY_INHIBIT, 0, _U16, "rw", 0, "EMCY inhibit time (100 us)"),
        Entry(o.CONSUMER_HEARTBEAT, 0, _U8, "const", 1, "consumer heartbeat: highest sub-index"),
        Entry(o.CONSUMER_HEARTBEAT, 1, _U32, "rw", 0, "consumer heartbeat (node << 16 | ms)"),
        Entry(o.PRODUCER_HEARTBEAT, 0, _U16, "rw", 0, "producer heartbeat (ms)"),
        Entry(o.IDENTITY, 0, _U8, "const", 4, "identity: highest sub-index"),
        Entry(o.IDENTITY, 1, _U32, "const", VENDOR_ID, "vendor id"),
        Entry(o.IDENTITY, 2, _U32, "const", PRODUCT_CODE, "product code"),
        Entry(o.IDENTITY, 3, _U32, "const", REVISION, "revision number"),
        Entry(o.IDENTITY, 4, _U32, "const", 0, "serial number"),
        Entry(o.SYNC_COUNTER, 0, _U8, "rw", 0, "SYNC counter overflow"),
        Entry(o.ERROR_BEHAVIOUR, 0, _U8, "const", 1, "error behaviour: highest sub-index"),
        Entry(o.ERROR_BEHAVIOUR, 1, _U8, "rw", 0, "error behaviour: communication error"),
        Entry(o.SDO_SERVER, 0, _U8, "const", 2, "SDO server: highest sub-index"),
        Entry(o.SDO_SERVER, 1, _U32, "const", o.SDO_REQUEST_BASE, "SDO COB-ID of requests", plus_node=True),
        Entry(o.SDO_SERVER, 2, _U32, "const", o.SDO_REPLY_BASE, "SDO COB-ID of replies", plus_node=True),
    ]
    drive_out = (mapping(o.CONTROLWORD, 0, 16), mapping(o.TARGET_VELOCITY, 0, 32))
    drive_in = (mapping(o.STATUSWORD, 0, 16), mapping(o.VELOCITY_ACTUAL, 0, 32),
                mapping(o.TORQUE_ACTUAL, 0, 16))
    entries += _pdo(o.RPDO_COMMUNICATION, o.RPDO_MAPPING, "RPDO1", o.RPDO1_BASE, 1, drive_out)
    entries += _pdo(o.RPDO_COMMUNICATION + 1, o.RPDO_MAPPING + 1, "RPDO2", o.COB_INVALID | o.RPDO2_BASE, 255,
                    (mapping(o.DIGITAL_OUTPUTS, 1, 32),))
    entries += _pdo(o.TPDO_COMMUNICATION, o.TPDO_MAPPING, "TPDO1", o.COB_NO_RTR | o.TPDO1_BASE, 1, drive_in)
    entries += _pdo(o.TPDO_COMMUNICATION + 1, o.TPDO_MAPPING + 1, "TPDO2",
                    o.COB_INVALID | o.COB_NO_RTR | o.TPDO2_BASE, 255, (mapping(o.DIGITAL_INPUTS, 0, 32),))
    return entries


def _state_machine() -> list[Entry]:
    return [
        Entry(o.ABORT_CONNECTION_OPTION, 0, _I16, "rw", 1, "abort connection option code"),
        Entry(o.ERROR_CODE, 0, _U16, "ro", 0, "error code", mappable=True),
        Entry(o.CONTROLWORD, 0, _U16, "rw", 0, "controlword", mappable=True),
        Entry(o.STATUSWORD, 0, _U16, "ro", 0, "statusword", mappable=True),
        Entry(o.QUICK_STOP_OPTION, 0, _I16, "rw", 2, "quick stop option code"),
        Entry(o.SHUTDOWN_OPTION, 0, _I16, "rw", 0, "shutdown option code"),
        Entry(o.DISABLE_OPERATION_OPTION, 0, _I16, "rw", 1, "disable operation option code"),
        Entry(o.HALT_OPTION, 0, _I16, "rw", 1, "halt option code"),
        Entry(o.FAULT_REACTION_OPTION, 0, _I16, "rw", 2, "fault reaction option code"),
        Entry(o.MODE, 0, _I8, "rw", 0, "mode of operation", mappable=True),
        Entry(o.MODE_DISPLAY, 0, _I8, "ro", 0, "mode of operation display", mappable=True),
        Entry(o.SUPPORTED_MODES, 0, _U32, "const", 0b10_0101, "supported drive modes (pp, pv, hm)"),
    ]


def _motion() -> list[Entry]:
    return [
        Entry(o.POSITION_ACTUAL, 0, _I32, "ro", 0, "position actual value", mappable=True),
        Entry(o.FOLLOWING_ERROR_WINDOW, 0, _U32, "rw", 0xFFFF_FFFF, "following error window"),
        Entry(o.FOLLOWING_ERROR_TIME, 0, _U16, "rw", 0, "following error time-out (ms)"),
        Entry(o.POSITION_WINDOW, 0, _U32, "rw", 10, "position window"),
        Entry(o.POSITION_WINDOW_TIME, 0, _U16, "rw", 20, "position window time (ms)"),
        Entry(o.VELOCITY_DEMAND, 0, _I32, "ro", 0, "velocity demand value", mappable=True),
        Entry(o.VELOCITY_ACTUAL, 0, _I32, "ro", 0, "velocity actual value", mappable=True),
        Entry(o.VELOCITY_WINDOW, 0, _U16, "rw", 20, "velocity window"),
        Entry(o.VELOCITY_WINDOW_TIME, 0, _U16, "rw", 20, "velocity window time (ms)"),
        Entry(o.VELOCITY_THRESHOLD, 0, _U16, "rw", 10, "velocity threshold"),
        Entry(o.VELOCITY_THRESHOLD_TIME, 0, _U16, "rw", 20, "velocity threshold time (ms)"),
        Entry(o.MAX_TORQUE, 0, _U16, "rw", 3000, "max torque (per mille of rated)"),
        Entry(o.RATED_CURRENT, 0, _U32, "ro", 5000, "motor rated current (mA)"),
        Entry(o.RATED_TORQUE, 0, _U32, "ro", 10_000, "motor rated torque (mN m)"),
        Entry(o.TORQUE_ACTUAL, 0, _I16, "ro", 0, "torque actual value (per mille of rated)", mappable=True),
        Entry(o.CURRENT_ACTUAL, 0, _I16, "ro", 0, "current actual value (per mille of rated)", mappable=True),
        Entry(o.DC_LINK_VOLTAGE, 0, _U32, "ro", 325_000, "DC link voltage (mV)", mappable=True),
        Entry(o.TARGET_POSITION, 0, _I32, "rw", 0, "target position", mappable=True),
        Entry(o.HOME_OFFSET, 0, _I32, "rw", 0, "home offset"),
        Entry(o.SOFTWARE_LIMIT, 0, _U8, "const", 2, "software position limit: highest sub-index"),
        Entry(o.SOFTWARE_LIMIT, 1, _I32, "rw", -0x8000_0000, "min position limit"),
        Entry(o.SOFTWARE_LIMIT, 2, _I32, "rw", 0x7FFF_FFFF, "max position limit"),
        Entry(o.MAX_PROFILE_VELOCITY, 0, _U32, "rw", 0xFFFF_FFFF, "max profile velocity"),
        Entry(o.MAX_MOTOR_SPEED, 0, _U32, "rw", 0xFFFF_FFFF, "max motor speed"),
        Entry(o.PROFILE_VELOCITY, 0, _U32, "rw", 0, "profile velocity"),
        Entry(o.PROFILE_ACCELERATION, 0, _U32, "rw", 1000, "profile acceleration"),
        Entry(o.PROFILE_DECELERATION, 0, _U32, "rw", 1000, "profile deceleration"),
        Entry(o.QUICK_STOP_DECELERATION, 0, _U32, "rw", 1000, "quick stop deceleration"),
        Entry(o.HOMING_METHOD, 0, _I8, "rw", 0, "homing method"),
        Entry(o.HOMING_SPEED, 0, _U8, "const", 2, "homing speed: highest sub-index"),
        Entry(o.HOMING_SPEED, 1, _U32, "rw", 1000, "homing speed: search for switch"),
        Entry(o.HOMING_SPEED, 2, _U32, "rw", 100, "homing speed: search for zero"),
        Entry(o.HOMING_ACCELERATION, 0, _U32, "rw", 1000, "homing acceleration"),
        Entry(o.FOLLOWING_ERROR, 0, _I32, "ro", 0, "following error actual value", mappable=True),
        Entry(o.MAX_SLIPPAGE, 0, _I32, "rw", 0x7FFF_FFFF, "max slippage"),
        Entry(o.DIGITAL_INPUTS, 0, _U32, "ro", 0, "digital inputs", mappable=True),
        Entry(o.DIGITAL_OUTPUTS, 0, _U8, "const", 2, "digital outputs: highest sub-index"),
        Entry(o.DIGITAL_OUTPUTS, 1, _U32, "rw", 0, "digital outputs: physical outputs", mappable=True),
        Entry(o.DIGITAL_OUTPUTS, 2, _U32, "rw", 0, "digital outputs: bit mask", mappable=True),
        Entry(o.TARGET_VELOCITY, 0, _I32, "rw", 0, "target velocity", mappable=True),
    ]


def _velocity_mode() -> list[Entry]:
    """Return the objects of mode 2 (CiA 402-2, 18), in r/min; 0x604C = 1/1."""
    ramps = (o.VL_ACCELERATION, "acceleration"), (o.VL_DECELERATION, "deceleration"), (o.VL_QUICK_STOP, "quick stop")
    entries = [
        Entry(o.VL_TARGET_VELOCITY, 0, _I16, "rw", 0, "vl target velocity", mappable=True),
        Entry(o.VL_VELOCITY_DEMAND, 0, _I16, "ro", 0, "vl velocity demand", mappable=True),
        Entry(o.VL_VELOCITY_ACTUAL, 0, _I16, "ro", 0, "vl velocity actual value", mappable=True),
        Entry(o.VL_MIN_MAX, 0, _U8, "const", 2, "vl velocity min max amount: highest sub-index"),
        Entry(o.VL_MIN_MAX, 1, _U32, "rw", 0, "vl velocity min amount"),
        Entry(o.VL_MIN_MAX, 2, _U32, "rw", 0x7FFF, "vl velocity max amount"),
        Entry(o.VL_DIMENSION_FACTOR, 0, _U8, "const", 2, "vl dimension factor: highest sub-index"),
        Entry(o.VL_DIMENSION_FACTOR, 1, _I32, "rw", 1, "vl dimension factor: numerator"),
        Entry(o.VL_DIMENSION_FACTOR, 2, _I32, "rw", 1, "vl dimension factor: denominator"),
    ]
    for index, name in ramps:
        entries.append(Entry(index, 0, _U8, "const", 2, f"vl velocity {name}: highest sub-index"))
        entries.append(Entry(index, 1, _U32, "rw", 1000, f"vl velocity {name}: delta speed"))
        entries.append(Entry(index, 2, _U16, "rw", 1, f"vl velocity {name}: delta time (s)"))
    return entries


def _by_address(entries: list[Entry]) -> dict[tuple[int, int], Entry]:
    return {(entry.index, entry.sub): entry for entry in sorted(entries, key=lambda e: (e.index, e.sub))}


DICTIONARY: dict[tuple[int, int], Entry] = _by_address([*_communication(), *_state_machine(), *_motion()])
"""Every object of a servo drive by (index, sub-index), ascending. Read only."""

_PROFILE_MOTION = frozenset((
    o.POSITION_ACTUAL, o.FOLLOWING_ERROR_WINDOW, o.FOLLOWING_ERROR_TIME, o.POSITION_WINDOW, o.POSITION_WINDOW_TIME,
    o.VELOCITY_DEMAND, o.VELOCITY_ACTUAL, o.VELOCITY_WINDOW, o.VELOCITY_WINDOW_TIME, o.VELOCITY_THRESHOLD,
    o.VELOCITY_THRESHOLD_TIME, o.TARGET_POSITION, o.HOME_OFFSET, o.SOFTWARE_LIMIT, o.MAX_PROFILE_VELOCITY,
    o.MAX_MOTOR_SPEED, o.PROFILE_VELOCITY, o.PROFILE_ACCELERATION, o.PROFILE_DECELERATION, o.QUICK_STOP_DECELERATION,
    o.HOMING_METHOD, o.HOMING_SPEED, o.HOMING_ACCELERATION, o.FOLLOWING_ERROR, o.MAX_SLIPPAGE, o.TARGET_VELOCITY,
))
"""Objects of the modes that a frequency inverter does not have."""


def _inverter() -> list[Entry]:
    """Return the objects of an inverter; PDO 1 is mapped for velocity mode."""
    mapped = {
        (o.RPDO_MAPPING, 2): mapping(o.VL_TARGET_VELOCITY, 0, 16),
        (o.TPDO_MAPPING, 2): mapping(o.VL_VELOCITY_ACTUAL, 0, 16),
    }
    kept = (entry for entry in DICTIONARY.values() if entry.index not in _PROFILE_MOTION)
    return [replace(entry, default=mapped.get((entry.index, entry.sub), entry.default)) for entry in kept]


INVERTER: dict[tuple[int, int], Entry] = _by_address([*_inverter(), *_velocity_mode()])
"""Every object of a frequency inverter by (index, sub-index), ascending. Read only."""
KNOWN: dict[tuple[int, int], Entry] = INVERTER | DICTIONARY
"""Every object that this program knows, by (index, sub-index). Read only."""


def describe(index: int, sub: int) -> str:
    """Return an object's address and name for messages: ``0x1016:01 (consumer heartbeat ...)``."""
    entry = KNOWN.get((index, sub))
    return f"0x{index:04X}:{sub:02X}" + (f" ({entry.name})" if entry else "")
