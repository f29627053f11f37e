"""A Modbus device by the names that people, the rig file and its line know it by."""

from __future__ import annotations

from dataclasses import dataclass

from drivers.modbus import Device


@dataclass(slots=True)
class FieldDevice:
    """A Modbus device of the rig file."""

    name: str
    """Its key in the rig file."""
    title: str
    """What people call it."""
    line: str
    driver: Device
