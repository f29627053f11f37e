"""A computer for tests of the doctor: everything as it should be, unless a test says otherwise."""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace

from tester.doctor.system import Computer, SerialPortInfo
from tester.inputs.rig import Rig

CELL, HEAT = "/dev/serial/by-id/cell", "/dev/serial/by-id/heat"


def ip_link(bitrate: int = 500_000, state: str = "ERROR-ACTIVE") -> str:
    """Return the part of the output of ``ip -json -details link show can0`` that is read."""
    return json.dumps([{"linkinfo": {"info_data": {"state": state, "bittiming": {"bitrate": bitrate}}}}])


@dataclass
class FakeComputer(Computer):
    """A computer with two USB serial adapters and a CAN interface."""

    platform: str = "linux"
    ports: dict[str, SerialPortInfo] = field(
        default_factory=lambda: {
            CELL: SerialPortInfo("/dev/ttyUSB0", "USB-RS485"),
            HEAT: SerialPortInfo("/dev/ttyUSB1", "USB-RS485"),
        }
    )
    """By the names of the rig file, which lead to the devices."""
    latency: dict[str, int] = field(default_factory=lambda: {CELL: 1, HEAT: 1})
    files: dict[str, str] = field(
        default_factory=lambda: {
            "/sys/class/net/can0": "",
            "/sys/class/net/can0/operstate": "up",
            "/sys/class/net/can0/tx_queue_len": "128",
        }
    )
    outputs: dict[str, str] = field(default_factory=lambda: {"ip": ip_link(), "timedatectl": "yes\n"})
    """By the program's name."""
    forbidden: frozenset[str] = frozenset()
    free: int | None = 500_000_000_000

    def text(self, path: str) -> str | None:
        return self.files.get(path)

    def names(self, folder: str) -> list[str]:
        return sorted({path[len(folder) + 1 :].split("/")[0] for path in self.files if path.startswith(f"{folder}/")})

    def exists(self, path: str) -> bool:
        return path in self.files or path in self.ports or path in {port.device for port in self.ports.values()}

    def real(self, path: str) -> str:
        return self.ports[path].device if path in self.ports else path

    def may_use(self, path: str) -> bool:
        return path not in self.forbidden

    def group_of(self, path: str) -> str:
        return "dialout"

    def free_bytes(self, folder: str) -> int | None:
        return self.free

    def output(self, *command: str) -> str | None:
        return self.outputs.get(command[0])

    def serial_ports(self) -> list[SerialPortInfo]:
        return list(self.ports.values())

    def latency_ms(self, port: str) -> int | None:
        return self.latency.get(port)


def on_adapters(rig: Rig) -> Rig:
    """Return a simulated rig as the file of a real one would describe it: on SocketCAN and serial ports."""
    ports = {"load_cell": CELL, "heat": HEAT}
    lines = {name: replace(line, port=ports.get(name, CELL)) for name, line in rig.lines.items()}
    return replace(rig, can=replace(rig.can, interface="socketcan", channel="can0"), lines=lines)
