"""Modbus, master side, without a clock or a port of its own."""

from __future__ import annotations

from drivers.modbus.device import Device, SetupStep
from drivers.modbus.link import ModbusLink
from drivers.modbus.request import Counters, Owner, Request, Station

__all__ = ["Counters", "Device", "ModbusLink", "Owner", "Request", "SetupStep", "Station"]
