"""Names for the CANopen numbers this project uses: objects, identifiers, commands, data types, error codes.

Sources: CiA 301 (communication) and CiA 402-2 (drives and motion control), as collected in the design notes
on field buses, section 5.1. Indices are 16 bits wide, sub-indices 8.
"""

from __future__ import annotations

import struct
from enum import IntEnum

# --- CAN identifiers (CiA 301 predefined connection set; node 1..127 is added to the bases) -----------------
NMT_ID = 0x000
SYNC_ID = 0x080
EMERGENCY_BASE = 0x080
TPDO1_BASE = 0x180
RPDO1_BASE = 0x200
TPDO2_BASE = 0x280
RPDO2_BASE = 0x300
RPDO3_BASE = 0x400
RPDO4_BASE = 0x500
SDO_REPLY_BASE = 0x580
SDO_REQUEST_BASE = 0x600
HEARTBEAT_BASE = 0x700
COB_INVALID = 0x8000_0000   # bit 31 of a PDO's COB-ID: the PDO does not exist
COB_NO_RTR = 0x4000_0000    # bit 30 of a TPDO's COB-ID: no remote requests
COB_ID_MASK = 0x7FF


class NmtCommand(IntEnum):
    """First byte of an NMT frame (CiA 301, 7.2.8.2.1)."""

    START = 1
    STOP = 2
    PRE_OPERATIONAL = 128
    RESET_NODE = 129
    RESET_COMMUNICATION = 130


class NmtState(IntEnum):
    """The byte of a heartbeat frame (CiA 301, 7.2.8.3.2.2)."""

    BOOT_UP = 0
    STOPPED = 4
    OPERATIONAL = 5
    PRE_OPERATIONAL = 127


class DataType(IntEnum):
    """Data types with their CiA 301 type index (table 44)."""

    I8 = 0x02
    I16 = 0x03
    I32 = 0x04
    U8 = 0x05
    U16 = 0x06
    U32 = 0x07
    TEXT = 0x09


STRUCT_CODE: dict[DataType, str] = {
    DataType.I8: "b", DataType.I16: "h", DataType.I32: "i",
    DataType.U8: "B", DataType.U16: "H", DataType.U32: "I",
}
"""Struct letter of each integer type; CANopen is little-endian throughout."""

CODEC: dict[DataType, struct.Struct] = {kind: struct.Struct("<" + code) for kind, code in STRUCT_CODE.items()}
BITS: dict[DataType, int] = {kind: codec.size * 8 for kind, codec in CODEC.items()}


def encode(kind: DataType, value: int | str) -> bytes:
    """Return the bytes of one value; raises ValueError where it does not fit the type."""
    if isinstance(value, str):
        if kind is not DataType.TEXT:
            raise ValueError(f"{kind.name} cannot hold the text {value!r}")
        return value.encode("latin-1", "replace")
    codec = CODEC.get(kind)
    if codec is None:
        raise ValueError(f"{kind.name} cannot hold the number {value}")
    try:
        return codec.pack(value)
    except struct.error as error:
        raise ValueError(f"{value} does not fit {kind.name}: {error}") from error


def decode(kind: DataType, data: bytes) -> int | str:
    """Return the value of the bytes; raises ValueError where the length is not the type's."""
    codec = CODEC.get(kind)
    if codec is None:
        return data.rstrip(b"\0").decode("latin-1")
    if len(data) != codec.size:
        raise ValueError(f"{kind.name} has {codec.size} bytes, {len(data)} came")
    value: int = codec.unpack(data)[0]
    return value


# --- Communication objects (CiA 301, 7.5.2) -----------------------------------------------------------------
DEVICE_TYPE = 0x1000
ERROR_REGISTER = 0x1001
ERROR_HISTORY = 0x1003
SYNC_COB_ID = 0x1005
SYNC_PERIOD = 0x1006
SYNC_WINDOW = 0x1007
DEVICE_NAME = 0x1008
HARDWARE_VERSION = 0x1009
SOFTWARE_VERSION = 0x100A
STORE_PARAMETERS = 0x1010
RESTORE_PARAMETERS = 0x1011
EMERGENCY_COB_ID = 0x1014
EMERGENCY_INHIBIT = 0x1015
CONSUMER_HEARTBEAT = 0x1016
PRODUCER_HEARTBEAT = 0x1017
IDENTITY = 0x1018
SYNC_COUNTER = 0x1019
ERROR_BEHAVIOUR = 0x1029
SDO_SERVER = 0x1200
RPDO_COMMUNICATION = 0x1400   # + PDO number - 1
RPDO_MAPPING = 0x1600
TPDO_COMMUNICATION = 0x1800
TPDO_MAPPING = 0x1A00

# --- Drive objects (CiA 402-2) ------------------------------------------------------------------------------
ABORT_CONNECTION_OPTION = 0x6007
ERROR_CODE = 0x603F
CONTROLWORD = 0x6040
STATUSWORD = 0x6041
VL_TARGET_VELOCITY = 0x6042
VL_VELOCITY_DEMAND = 0x6043
VL_VELOCITY_ACTUAL = 0x6044
VL_MIN_MAX = 0x6046
VL_ACCELERATION = 0x6048
VL_DECELERATION = 0x6049
VL_QUICK_STOP = 0x604A
VL_DIMENSION_FACTOR = 0x604C
QUICK_STOP_OPTION = 0x605A
SHUTDOWN_OPTION = 0x605B
DISABLE_OPERATION_OPTION = 0x605C
HALT_OPTION = 0x605D
FAULT_REACTION_OPTION = 0x605E
MODE = 0x6060
MODE_DISPLAY = 0x6061
POSITION_ACTUAL = 0x6064
FOLLOWING_ERROR_WINDOW = 0x6065
FOLLOWING_ERROR_TIME = 0x6066
POSITION_WINDOW = 0x6067
POSITION_WINDOW_TIME = 0x6068
VELOCITY_DEMAND = 0x606B
VELOCITY_ACTUAL = 0x606C
VELOCITY_WINDOW = 0x606D
VELOCITY_WINDOW_TIME = 0x606E
VELOCITY_THRESHOLD = 0x606F
VELOCITY_THRESHOLD_TIME = 0x6070
MAX_TORQUE = 0x6072
RATED_CURRENT = 0x6075
RATED_TORQUE = 0x6076
TORQUE_ACTUAL = 0x6077
CURRENT_ACTUAL = 0x6078
DC_LINK_VOLTAGE = 0x6079
TARGET_POSITION = 0x607A
HOME_OFFSET = 0x607C
SOFTWARE_LIMIT = 0x607D
MAX_PROFILE_VELOCITY = 0x607F
MAX_MOTOR_SPEED = 0x6080
PROFILE_VELOCITY = 0x6081
PROFILE_ACCELERATION = 0x6083
PROFILE_DECELERATION = 0x6084
QUICK_STOP_DECELERATION = 0x6085
HOMING_METHOD = 0x6098
HOMING_SPEED = 0x6099
HOMING_ACCELERATION = 0x609A
FOLLOWING_ERROR = 0x60F4
MAX_SLIPPAGE = 0x60F8
DIGITAL_INPUTS = 0x60FD
DIGITAL_OUTPUTS = 0x60FE
TARGET_VELOCITY = 0x60FF
SUPPORTED_MODES = 0x6502

DEVICE_PROFILE = 402
"""Low half of 0x1000: the device follows CiA 402."""


class OperationMode(IntEnum):
    """Modes of operation, 0x6060 and 0x6061; 0x6502 has bit (mode - 1) set for each one supported."""

    NONE = 0
    PROFILE_POSITION = 1
    VELOCITY = 2
    PROFILE_VELOCITY = 3
    HOMING = 6


MACHINE_LATE = 0xFF4C
"""Manufacturer's error code of the simulated machine: the computer that simulates it was late.

The vendor's bytes are its lateness in ms (two bytes), then ``MACHINE_LATE_MARK``. With them it is no fault of a drive.
"""
MACHINE_LATE_MARK = b"sim"
EMERGENCY_TEXT: dict[int, str] = {
    MACHINE_LATE: "the computer that simulates this machine was late",
    0x0000: "error reset or no error",
    0x1000: "generic error",
    0x2310: "over-current",
    0x3210: "DC link over-voltage",
    0x3220: "DC link under-voltage",
    0x4210: "device over-temperature",
    0x4310: "drive over-temperature",
    0x6320: "parameter error",
    0x7121: "motor blocked",
    0x7305: "encoder error",
    0x8110: "CAN overrun",
    0x8120: "CAN error passive",
    0x8130: "heartbeat of the master lost",
    0x8140: "recovered from bus-off",
    0x8210: "PDO too short, not processed",
    0x8220: "PDO too long",
    0x8250: "RPDO time-out",
    0x8400: "velocity control deviation",
    0x8611: "following error",
}
"""EMCY and 0x603F codes that occur on the rig (CiA 301 table 26, CiA 402-2 table of 0x603F)."""

_EMERGENCY_CLASS: dict[int, str] = {
    0x10: "generic error", 0x20: "current", 0x21: "current, input side", 0x22: "current inside the device",
    0x23: "current, output side", 0x30: "voltage", 0x31: "mains voltage", 0x32: "voltage inside the device",
    0x33: "output voltage", 0x40: "temperature", 0x41: "ambient temperature", 0x42: "device temperature",
    0x50: "device hardware", 0x60: "device software", 0x61: "internal software", 0x62: "user software",
    0x63: "data set", 0x70: "additional modules", 0x71: "power additional module", 0x73: "sensor",
    0x80: "monitoring", 0x81: "communication", 0x82: "protocol error", 0x84: "velocity controller",
    0x85: "position controller", 0x86: "positioning controller", 0x90: "external error",
    0xF0: "additional functions", 0xFF: "vendor specific",
}

ERROR_REGISTER_BITS = ("generic", "current", "voltage", "temperature", "communication", "profile", "reserved",
                       "manufacturer")
"""Meaning of bits 0..7 of 0x1001."""


def emergency_text(code: int) -> str:
    """Return the meaning of an error code (0..0xFFFF); for a code that is not listed, the meaning of its class."""
    text = EMERGENCY_TEXT.get(code)
    if text is None:
        text = _EMERGENCY_CLASS.get(code >> 8) or _EMERGENCY_CLASS.get((code >> 8) & 0xF0) or "unknown error"
    return f"0x{code:04X} {text}"
