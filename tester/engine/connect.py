"""Bring the rig up: configure every drive, home the position axes, hear every Modbus device."""

from __future__ import annotations

from enum import Enum

from tester.engine.devices import Devices

CONNECT_S = 0.01
"""Period of the ticks while connecting, s: an SDO exchange takes half a millisecond on the wire."""
TIMEOUT_S = 90.0
"""Everything must be up by then; homing of a slow axis takes the most [A]."""


class Stage(Enum):
    """How far the connection is."""

    CONFIGURE = "configure drives"
    HOME = "home position axes"
    LISTEN = "hear every device"
    READY = "ready"
    FAILED = "failed"


class Connector:
    """Drives the connection, tick by tick."""

    def __init__(self, devices: Devices) -> None:
        """Nothing is sent before the first ``tick``."""
        self.devices = devices
        self.stage = Stage.CONFIGURE
        self.failure = ""
        self._started_s: float | None = None

    @property
    def finished(self) -> bool:
        """Ready or failed."""
        return self.stage in (Stage.READY, Stage.FAILED)

    def tick(self, now: float) -> float:
        """Do what is due at ``now``; return when to be called again (s)."""
        devices = self.devices
        devices.receive(now)
        if self._started_s is None:
            self._started_s = now
            for drive in devices.drives:
                devices.master.start(drive, drive.connect())
        self._advance(now)
        devices.transmit(now, scan=self.stage in (Stage.HOME, Stage.LISTEN))
        return now + CONNECT_S

    def _advance(self, now: float) -> None:
        devices = self.devices
        busy = any(devices.master.busy(drive) for drive in devices.drives)
        refused = devices.refused()
        assert self._started_s is not None
        if refused:
            self._fail(refused)
        elif self.stage is Stage.CONFIGURE and not busy:
            devices.master.sync = True
            for drive in devices.drives:
                if drive.config.mode == "position":
                    devices.master.start(drive, drive.home())
            self.stage = Stage.HOME
        elif self.stage is Stage.HOME and not busy:
            self.stage = Stage.LISTEN
        elif self.stage is Stage.LISTEN and devices.answering():
            self.stage = Stage.READY
        elif devices.master.foreign_master:
            self._fail("another CANopen master is sending on this bus")
        elif now - self._started_s > TIMEOUT_S:
            self._fail(f"not up after {TIMEOUT_S:g} s: {self._missing()}")

    def _fail(self, why: str) -> None:
        self.stage = Stage.FAILED
        self.failure = why

    def _missing(self) -> str:
        """Name what has not answered."""
        devices = self.devices
        names = [drive.config.name for drive in devices.drives if devices.master.busy(drive) or not drive.online]
        for name, device in (
            ("load cell", devices.cell),
            ("infrared thermometer", devices.thermometer),
            ("jacket controller", devices.jacket),
        ):
            if not device.valid:
                names.append(name)
        return ", ".join(names) or "unknown"
