"""Opens a Modbus line by the settings of a rig file."""

from __future__ import annotations

from drivers.ports import LineSettings
from drivers.transports.serial_line import SerialLine, open_serial_line
from drivers.transports.tcp_line import TcpLine, open_tcp_line


def open_line(settings: LineSettings) -> TcpLine | SerialLine:
    """Open a line; raises BusLost."""
    if settings.framing == "socket":
        host, _, port = settings.port.rpartition(":")
        return open_tcp_line(host, int(port))
    return open_serial_line(
        settings.port, settings.baud, settings.parity, settings.stop_bits,
        in_ascii=settings.framing == "ascii", rts=settings.rts,
    )  # fmt: skip
