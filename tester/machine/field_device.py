"""A Modbus device with its names for people, the rig file and its line."""

from __future__ import annotations

from dataclasses import dataclass

from drivers.modbus import Device


@dataclass(slots=True)
class FieldDevice:
    """A Modbus device of the rig file."""

    name: str
    """Its key in the rig file."""
    title: str
    """Its name for people."""
    line: str
    driver: Device
