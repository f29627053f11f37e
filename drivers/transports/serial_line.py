"""A serial port as a line that carries Modbus RTU or ASCII."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from drivers.ports import BusLost, Rts, WatchedLine
from drivers.transports.ascii_frames import AsciiFrames, as_ascii

if TYPE_CHECKING:
    from serial import Serial


class SerialLine(WatchedLine):
    """A port (``drivers.ports.LinePort``) over pyserial. Nothing blocks: the operating system keeps what arrives.

    Bytes are stamped with the time of fetching, which is no earlier than their arrival. ``low_latency``: the
    driver's flag was set at opening (None: the driver has no flag). ``latency_timer_s``: the time for which a USB
    adapter holds characters back, as its driver reports it, s (None: no report).
    """

    def __init__(
        self,
        serial: Serial,
        low_latency: bool | None = None,
        latency_timer_s: float | None = None,
        *,
        in_ascii: bool = False,
    ) -> None:
        """Take an open port without time-outs; ``in_ascii``: Modbus ASCII on the wire; see ``open_serial_line``."""
        super().__init__()
        self.low_latency = low_latency
        self.latency_timer_s = latency_timer_s
        self.remedy = remedy_of(str(serial.name or ""))
        self._serial = serial
        self._unsent = b""
        self._received = AsciiFrames() if in_ascii else None

    def write(self, data: bytes, now: float) -> None:
        """Send bytes; those that the operating system refuses now are sent with the next call. Raises BusLost."""
        self._unsent += data if self._received is None else as_ascii(data)
        self._send()
        if self.watchers:
            self.tell(now, data, True)

    def _send(self) -> None:
        from serial import SerialException

        try:
            sent = self._serial.write(self._unsent) or 0
        except (SerialException, OSError) as error:
            raise BusLost(f"serial port {self._serial.name}: {error}") from error
        self._unsent = self._unsent[sent:]

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return what has arrived, stamped ``now`` (s). Raises BusLost."""
        from serial import SerialException

        if self._unsent:
            self._send()
        try:
            waiting = self._serial.in_waiting
            data = self._serial.read(waiting) if waiting else b""
        except (SerialException, OSError) as error:
            raise BusLost(f"serial port {self._serial.name}: {error}") from error
        if self._received is not None:
            data = self._received.feed(data)
        if not data:
            return []
        if self.watchers:
            self.tell(now, data, False)
        return [(now, data)]

    def close(self) -> None:
        """Release the port."""
        self._serial.close()


def open_serial_line(
    port: str,
    baud: int,
    parity: Literal["N", "E", "O"] = "N",
    stop_bits: Literal[1, 2] = 1,
    *,
    in_ascii: bool = False,
    rts: Rts = "",
) -> SerialLine:
    """Open a serial port for Modbus: ``baud`` in bit/s, 8 data bits, 7 in ASCII; no other program can open it.

    ``rts``: level of the RTS line while the port sends, for an RS-485 adapter whose direction it switches.
    USB adapters are asked for low latency: by default many deliver in batches of 16 ms. Raises
    BusLost when the port cannot be opened.
    """
    from serial import Serial, SerialException
    from serial.rs485 import RS485Settings

    try:
        serial = Serial(
            port, baud, bytesize=7 if in_ascii else 8, parity=parity, stopbits=stop_bits, timeout=0.0,
            write_timeout=0.0, exclusive=True,
        )  # fmt: skip
        if rts:
            serial.rs485_mode = RS485Settings(rts_level_for_tx=rts == "high", rts_level_for_rx=rts == "low")
        serial.reset_input_buffer()
    except (SerialException, OSError, ValueError, *_settings_errors()) as error:
        raise BusLost(f"serial port {port}: {error}") from error
    granted = _ask_for_low_latency(serial) if sys.platform == "linux" else None
    return SerialLine(serial, granted, latency_timer_s(port), in_ascii=in_ascii)


def latency_timer_s(port: str, root: Path = Path("/sys/class/tty")) -> float | None:
    """Return the latency timer of a USB adapter on Linux, s; None if the driver has none, or elsewhere."""
    try:
        return 1e-3 * int((root / Path(port).resolve().name / "device" / "latency_timer").read_text(encoding="ascii"))
    except (OSError, ValueError):
        return None


def remedy_of(port: str) -> str:
    """Return the advice that makes a USB adapter deliver at once, on this system."""
    if sys.platform == "win32":
        return (
            f"set the latency timer of {port} to 1 ms: Device Manager, Ports, {port}, Port Settings, Advanced; in the"
            " registry LatencyTimer below HKLM\\SYSTEM\\CurrentControlSet\\Enum\\FTDIBUS"
        )
    name = Path(port).name
    return (
        f"set the adapter's latency timer to 1 ms: echo 1 > /sys/class/tty/{name}/device/latency_timer, or"
        f" setserial {port} low_latency; an adapter without one: another adapter"
    )


def _settings_errors() -> tuple[type[Exception], ...]:
    """Return the exceptions of a terminal that refuses its settings: a pty refuses parity, for example."""
    try:
        import termios
    except ImportError:  # Windows
        return ()
    return (termios.error,)


def _ask_for_low_latency(serial: Serial) -> bool:
    """Set the driver's low-latency flag (1 ms with FTDI chips); return whether the port has one."""
    try:
        serial.set_low_latency_mode(True)
    except (OSError, ValueError):
        # A pty or an adapter without the flag: it works, with its usual latency.
        return False
    return True
