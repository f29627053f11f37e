"""Writes the simulated servo drive's electronic data sheet (EDS, CiA 306-1) from its object dictionary.

``python -m drivers.canopen.eds`` writes ``drivers/profiles/cia402_servo.eds``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from drivers.canopen import objects as o
from drivers.canopen.dictionary import DICTIONARY, PRODUCT_CODE, REVISION, VENDOR_ID, Entry

EDS_PATH = Path(__file__).parent.parent / "profiles" / "cia402_servo.eds"

_MANDATORY = (o.DEVICE_TYPE, o.ERROR_REGISTER, o.IDENTITY)
_ARRAYS = (o.ERROR_HISTORY, o.CONSUMER_HEARTBEAT, o.ERROR_BEHAVIOUR)
_VAR, _ARRAY, _RECORD = 7, 8, 9
_RECEIVED_PDOS = range(o.RPDO_COMMUNICATION, o.RPDO_MAPPING)
_SENT_PDOS = range(o.TPDO_COMMUNICATION, o.TPDO_MAPPING)

# CiA 306-1, 4.4: every run writes the same text, so that the file changes only with the dictionary.
_HEAD = """\
[FileInfo]
FileName=cia402_servo.eds
FileVersion=1
FileRevision=1
EDSVersion=4.0
Description=Simulated CiA 402 servo drive of the friction tester
CreationTime=12:00AM
CreationDate=01-01-2025
CreatedBy=drivers.canopen.eds
ModificationTime=12:00AM
ModificationDate=01-01-2025
ModifiedBy=drivers.canopen.eds

[DeviceInfo]
VendorName=friction-tester
VendorNumber=0x{vendor:08X}
ProductName=Simulated CiA 402 servo drive
ProductNumber=0x{product:08X}
RevisionNumber=0x{revision:08X}
OrderCode=
BaudRate_10=0
BaudRate_20=0
BaudRate_50=0
BaudRate_125=1
BaudRate_250=1
BaudRate_500=1
BaudRate_800=0
BaudRate_1000=1
SimpleBootUpMaster=0
SimpleBootUpSlave=1
Granularity=8
DynamicChannelsSupported=0
GroupMessaging=0
NrOfRXPDO={receive}
NrOfTXPDO={transmit}
LSS_Supported=0

[DummyUsage]
Dummy0001=0
Dummy0002=0
Dummy0003=0
Dummy0004=0
Dummy0005=0
Dummy0006=0
Dummy0007=0

[Comments]
Lines=0
"""


def write_eds(dictionary: Mapping[tuple[int, int], Entry]) -> str:
    """Return the text of the EDS that describes these objects."""
    objects: dict[int, list[Entry]] = {}
    for (index, _), entry in sorted(dictionary.items()):
        objects.setdefault(index, []).append(entry)
    head = _HEAD.format(vendor=VENDOR_ID, product=PRODUCT_CODE, revision=REVISION,
                        receive=sum(index in _RECEIVED_PDOS for index in objects),
                        transmit=sum(index in _SENT_PDOS for index in objects))
    optional = [index for index in objects if index not in _MANDATORY]
    parts = [
        head,
        _listing("MandatoryObjects", [index for index in objects if index in _MANDATORY]),
        _listing("OptionalObjects", optional),
        _listing("ManufacturerObjects", []),
    ]
    for index, entries in objects.items():
        parts += _object(index, entries)
    return "\n".join(parts)


def _listing(section: str, indices: list[int]) -> str:
    lines = [f"[{section}]", f"SupportedObjects={len(indices)}"]
    lines += [f"{number}=0x{index:04X}" for number, index in enumerate(indices, start=1)]
    return "\n".join(lines) + "\n"


def _object(index: int, entries: list[Entry]) -> list[str]:
    if len(entries) == 1 and entries[0].sub == 0:
        return [_variable(f"{index:04X}", entries[0])]
    name = entries[0].name.partition(":")[0]
    kind = _ARRAY if index in _ARRAYS else _RECORD
    parts = [f"[{index:04X}]\nParameterName={name}\nObjectType=0x{kind:X}\nSubNumber={len(entries)}\n"]
    parts += [_variable(f"{index:04X}sub{entry.sub:X}", entry) for entry in entries]
    return parts


def _variable(section: str, entry: Entry) -> str:
    default = entry.default
    if isinstance(default, int) and entry.plus_node:
        default = f"$NODEID+0x{default:X}"
    return (f"[{section}]\nParameterName={entry.name}\nObjectType=0x{_VAR:X}\n"
            f"DataType=0x{entry.type.value:04X}\nAccessType={entry.access}\nDefaultValue={default}\n"
            f"PDOMapping={int(entry.mappable)}\n")


def main() -> None:
    """Write the data sheet to its place in the package."""
    EDS_PATH.write_text(write_eds(DICTIONARY), encoding="ascii", newline="\n")


if __name__ == "__main__":
    main()
