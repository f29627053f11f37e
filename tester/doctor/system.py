"""The doctor's access to the computer: its files, programs, serial ports and disks. Tests override it.

It supports Linux: sysfs, ``ip``, ``timedatectl``. On other systems these reads return None, and the probes report that
they could not check. On Windows the latency timer is read from the registry, where FTDI's driver keeps it; that was not
tried on a machine.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple

COMMAND_AT_MOST_S = 3.0
"""Time limit for a program's answer, s [A]."""


class SerialPortInfo(NamedTuple):
    """A serial port of the computer; ``device`` is the name with which to open it: ``/dev/ttyUSB0``, ``COM3``."""

    device: str
    description: str


class Computer:
    """This computer."""

    platform: str = sys.platform

    def text(self, path: str) -> str | None:
        """Return the text of a small file without its last line end; None if it is unreadable."""
        try:
            return Path(path).read_text(encoding="utf-8", errors="replace").rstrip("\n")
        except OSError:
            return None

    def names(self, folder: str) -> list[str]:
        """Return the names in a folder; empty if it is unreadable."""
        try:
            return sorted(path.name for path in Path(folder).iterdir())
        except OSError:
            return []

    def exists(self, path: str) -> bool:
        """Return whether a file with this name exists."""
        return Path(path).exists()

    def real(self, path: str) -> str:
        """Return a path with links resolved, for example the port behind a name in ``/dev/serial/by-id``."""
        return os.path.realpath(path)

    def may_use(self, path: str) -> bool:
        """Return whether this user may read and write a path; if it is missing, its nearest existing folder."""
        return os.access(_nearest(path), os.R_OK | os.W_OK)

    def group_of(self, path: str) -> str:
        """Return the group of a file; "" if unknown."""
        try:
            return Path(path).group()
        except (OSError, KeyError, NotImplementedError):
            return ""

    def free_bytes(self, folder: str) -> int | None:
        """Return the free space on the disk of a folder, existing or not; None if unknown."""
        try:
            return shutil.disk_usage(_nearest(folder)).free
        except OSError:
            return None

    def output(self, *command: str) -> str | None:
        """Return a program's output; None if it is missing or fails."""
        try:
            done = subprocess.run(
                command, capture_output=True, text=True, timeout=COMMAND_AT_MOST_S, check=True, stdin=subprocess.DEVNULL
            )
        except (OSError, subprocess.SubprocessError):
            return None
        return done.stdout

    def serial_ports(self) -> list[SerialPortInfo]:
        """Return the serial ports of the computer."""
        from serial.tools import list_ports

        ports = sorted(list_ports.comports(), key=lambda port: port.device)
        return [SerialPortInfo(port.device, port.description or "") for port in ports]

    def latency_ms(self, port: str) -> int | None:
        """Return the latency timer of a USB serial adapter, ms; None if it has none or it is unknown."""
        if sys.platform == "win32":
            return _latency_on_windows(port)
        name = Path(self.real(port)).name
        text = self.text(f"/sys/bus/usb-serial/devices/{name}/latency_timer")
        return int(text) if text is not None and text.isdecimal() else None


def _nearest(path: str) -> Path:
    """Return a path, or the nearest existing folder above it."""
    absolute = Path(path).absolute()
    return next((folder for folder in (absolute, *absolute.parents) if folder.exists()), absolute)


if sys.platform == "win32":

    def _latency_on_windows(port: str) -> int | None:
        """Return the latency timer that FTDI's driver stores for a port, next to its ``PortName``. Not tried."""
        import winreg

        root = r"SYSTEM\CurrentControlSet\Enum\FTDIBUS"

        def under(key: winreg.HKEYType) -> list[str]:
            return [winreg.EnumKey(key, number) for number in range(winreg.QueryInfoKey(key)[0])]

        try:
            with winreg.OpenKey(winreg.HKEY_LOCAL_MACHINE, root) as adapters:
                for adapter in under(adapters):
                    with winreg.OpenKey(adapters, adapter) as instances:
                        for instance in under(instances):
                            with winreg.OpenKey(instances, rf"{instance}\Device Parameters") as values:
                                if winreg.QueryValueEx(values, "PortName")[0] == port:
                                    return int(winreg.QueryValueEx(values, "LatencyTimer")[0])
        except (OSError, ValueError):
            return None
        return None

else:

    def _latency_on_windows(port: str) -> int | None:
        """Return None: this system is not Windows."""
        return None
