"""A serial CAN adapter's half of slcan, the LAWICEL protocol of lines that end with CR; sans-IO.

Source: LAWICEL CANUSB manual and its CAN232 manual, chapter "available commands": ``Sn`` bit rate, ``O`` open, ``L``
open to listen only, ``C`` close, ``tiiildd..`` and ``Tiiiiiiiildd..`` a frame, ``r`` and ``R`` a remote frame, ``F``
status, ``V`` version, ``N`` serial number, ``Z0/Z1`` time stamps, ``M``, ``m`` acceptance. A command that is carried
out is answered with CR (a frame with ``z`` or ``Z`` and CR), any other with BELL.
"""

from __future__ import annotations

from string import hexdigits

from drivers.ports import CanFrame

BITRATES = {0: 10_000, 1: 20_000, 2: 50_000, 3: 100_000, 4: 125_000, 5: 250_000, 6: 500_000, 7: 800_000, 8: 1_000_000}
"""Bit rate in bit/s by the number of the command ``S``. python-can sends S7 for 750 kbit/s, which no manual has."""
LONGEST_LINE = 64
"""Greatest length of a line, characters; the longest valid line, an extended frame, has 26."""
BUS_ERROR = 0x80
"""Status bit of a bus error, as an adapter at a wrong bit rate reports it."""

_OK, _BELL = b"\r", b"\a"
_HIGHEST_ID = 0x7FF
_DIGITS = frozenset(hexdigits.encode("ascii"))


class SlcanSession:
    """The adapter: ``feed`` takes the computer's bytes, ``outgoing`` holds the bytes for the computer.

    ``bitrate`` is that of the bus, bit/s: opened at another rate, the adapter receives nothing and reaches no node.
    ``ignored`` counts frames that the simulated bus does not carry (29-bit identifiers, remote frames), ``refused``
    lines that are no valid command.
    """

    def __init__(self, bitrate: int) -> None:
        """Wait, with the channel closed."""
        self.bitrate = bitrate
        self.is_open = False
        self.ignored = 0
        self.refused = 0
        self.outgoing = bytearray()
        self._buffer = b""
        self._own_rate: int | None = None
        self._listens_only = False
        self._stamped = False

    @property
    def deaf(self) -> bool:
        """Return whether the channel is open at a bit rate that differs from the bus."""
        return self.is_open and self._own_rate != self.bitrate

    def feed(self, data: bytes) -> list[tuple[int, bytes]]:
        """Process the computer's bytes; return the frames for the bus as (identifier, data), in order."""
        frames: list[tuple[int, bytes]] = []
        *lines, self._buffer = (self._buffer + data).split(b"\r")
        for line in lines:
            self._line(line, frames)
        if len(self._buffer) > LONGEST_LINE:
            self._buffer = b""
            self._refuse()
        return frames

    def relay(self, frames: list[CanFrame]) -> None:
        """Queue frames of the bus for the computer; a closed channel drops them."""
        if not self.is_open or self.deaf:
            return
        for t, can_id, data in frames:
            stamp = f"{int(1000.0 * t) % 60_000:04X}" if self._stamped else ""
            self.outgoing += f"t{can_id:03X}{len(data)}{data.hex().upper()}{stamp}\r".encode("ascii")

    def _line(self, line: bytes, frames: list[tuple[int, bytes]]) -> None:
        command, rest = line[:1], line[1:]
        match command:
            case b"":
                self.outgoing += _OK  # an empty line clears the adapter's buffer
            case b"t" | b"T" | b"r" | b"R":
                self._frame(command, rest, frames)
            case b"O" | b"L" if not rest and not self.is_open and self._own_rate is not None:
                self.is_open, self._listens_only = True, command == b"L"
                self.outgoing += _OK
            case b"C" if not rest and self.is_open:
                self.is_open = False
                self.outgoing += _OK
            case b"F" if not rest and self.is_open:
                self.outgoing += f"F{BUS_ERROR if self.deaf else 0:02X}\r".encode("ascii")
            case b"V" if not rest:
                self.outgoing += b"V1013\r"
            case b"v" if not rest:
                self.outgoing += b"v1013\r"
            case b"N" if not rest:
                self.outgoing += b"NSIM1\r"
            case _:
                self._set(command, rest)

    def _set(self, command: bytes, rest: bytes) -> None:
        """Apply a setting; the channel has to be closed."""
        valid = not self.is_open
        if command == b"S" and rest.isdigit() and int(rest) in BITRATES:
            rate = BITRATES[int(rest)]
        elif command == b"s" and len(rest) == 4 and _hex(rest):
            rate = _rate_of(int(rest[:2], 16), int(rest[2:], 16))
        else:
            rate = None
            accepts = command in (b"M", b"m") and len(rest) == 8 and _hex(rest)
            valid &= accepts or (command == b"Z" and rest in (b"0", b"1"))
        if not valid:
            self._refuse()
            return
        if rate is not None:
            self._own_rate = rate
        elif command == b"Z":
            self._stamped = rest == b"1"
        self.outgoing += _OK

    def _frame(self, command: bytes, rest: bytes, frames: list[tuple[int, bytes]]) -> None:
        digits = 8 if command in b"TR" else 3
        can_id, length, data = rest[:digits], rest[digits : digits + 1], rest[digits + 1 :]
        count = int(length) if length.isdigit() else 9
        expected = 0 if command in b"rR" else 2 * count
        if not self.is_open or self._listens_only or count > 8 or len(data) != expected or not _hex(can_id + data):
            self._refuse()
            return
        if command != b"t" or int(can_id, 16) > _HIGHEST_ID:
            self.ignored += 1
        elif not self.deaf:
            frames.append((int(can_id, 16), bytes.fromhex(data.decode("ascii"))))
        self.outgoing += b"z\r" if command in b"tr" else b"Z\r"

    def _refuse(self) -> None:
        self.refused += 1
        self.outgoing += _BELL


def _hex(text: bytes) -> bool:
    return _DIGITS.issuperset(text)


def _rate_of(btr0: int, btr1: int) -> int:
    """Return the bit rate in bit/s for an SJA1000's bus timing registers at 16 MHz (data sheet, 6.5)."""
    quantum_s = 2 * ((btr0 & 0x3F) + 1) / 16e6
    quanta = 1 + (btr1 & 0x0F) + 1 + (btr1 >> 4 & 0x07) + 1
    return round(1.0 / (quantum_s * quanta))
