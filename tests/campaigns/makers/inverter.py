"""A frequency inverter on CAN, byte by byte from its makers' pages, without our own dictionary.

Pages: Fuji's FRENIC-Ace user's manual 9-20 to 9-42 (PDO, identity, aborts), WEG's CFW11 CANopen manual 32 (types of
0x6042 to 0x6048), Lenze's i510 manual 177 (ranges of 0x6042 to 0x6049, 0x605A), Toshiba's E6581911 31 and 43 (target
cleared at enabling, SYNC), LS iG5A CANopen manual 71 (controlword bits 4 to 6, no halt). 0x6007 and 0x6077 are on none
of them: CiA 402-2.
"""

from __future__ import annotations

from drivers.ports import CanFrame, FrameByFrame

NODE = 9
VENDOR = 0x25E
READ_ONLY, NO_OBJECT, NO_SUB, UNMAPPABLE, RANGE = 0x0601_0002, 0x0602_0000, 0x0609_0011, 0x0604_0041, 0x0609_0030
U32 = 0xFFFF_FFFF
ROWS: dict[tuple[int, int], tuple[int, str, int, int, int]] = {
    # size, access, at power-on, least, greatest
    (0x1000, 0): (4, "r", 0x0001_0192, 0, 0), (0x1001, 0): (1, "r", 0, 0, 0), (0x1003, 0): (1, "rw", 0, 0, 0),
    (0x1016, 0): (1, "r", 1, 0, 0), (0x1016, 1): (4, "rw", 0, 0, U32), (0x1017, 0): (2, "rw", 0, 0, 0xFFFF),
    (0x1018, 0): (1, "r", 1, 0, 0), (0x1018, 1): (4, "r", VENDOR, 0, 0),
    (0x1029, 0): (1, "r", 1, 0, 0), (0x1029, 1): (1, "rw", 0, 0, 2),
    (0x603F, 0): (2, "r", 0, 0, 0), (0x6040, 0): (2, "rw", 0, 0, 0xFFFF), (0x6041, 0): (2, "r", 0, 0, 0),
    (0x6042, 0): (2, "rw", 0, -0x8000, 0x7FFF), (0x6043, 0): (2, "r", 0, 0, 0), (0x6044, 0): (2, "r", 0, 0, 0),
    (0x6046, 1): (4, "rw", 0, 0, 480_000), (0x6046, 2): (4, "rw", 480_000, 0, 480_000),
    (0x6048, 1): (4, "rw", 3000, 0, 0x7FFF_FFFF), (0x6048, 2): (2, "rw", 10, 0, 0xFFFF),
    (0x6049, 1): (4, "rw", 3000, 0, 0x7FFF_FFFF), (0x6049, 2): (2, "rw", 10, 0, 0xFFFF),
    (0x604A, 1): (4, "rw", 3000, 0, 0x7FFF_FFFF), (0x604A, 2): (2, "rw", 1, 0, 0xFFFF),
    (0x6007, 0): (2, "rw", 0, 0, 3), (0x605A, 0): (2, "rw", 2, 2, 6), (0x605E, 0): (2, "rw", 0, 0, 2),
    (0x6060, 0): (1, "rw", 0, 0, 2), (0x6061, 0): (1, "r", 0, 0, 0), (0x6502, 0): (4, "r", 0b10, 0, 0),
    (0x6077, 0): (2, "r", 0, 0, 0),
}  # fmt: skip
for base in (0x1400, 0x1401, 0x1800, 0x1801):
    ROWS[base, 1] = (4, "rw", (0x180 if base & 0x400 == 0 else 0x200) + 0x100 * (base & 1) + NODE, 0, U32)
    ROWS[base, 2] = (1, "rw", 255, 0, 255)
    if base >= 0x1800:
        ROWS[base, 3], ROWS[base, 5] = (2, "rw", 100, 0, 0xFFFF), (2, "rw", 0, 0, 0xFFFF)
    ROWS |= {(base + 0x200, sub): (4 if sub else 1, "rw", 0, 0, U32 if sub else 4) for sub in range(5)}
MAPPABLE = {0x6040_0010, 0x6042_0010, 0x6041_0010, 0x6043_0010, 0x6044_0010, 0x6077_0010}
SHOWN = {"off": 0x0250, "ready": 0x0231, "on": 0x0233, "runs": 0x0237, "stops": 0x0217, "fault": 0x0218}
"""Statusword of each state: remote, and voltage on."""


class InverterSlave(FrameByFrame):
    """The device: ``rpm`` turns, ``mille`` of its rated torque. Its frames wait for ``receive``."""

    def __init__(self, without: set[int] | None = None, most: dict[tuple[int, int], int] | None = None) -> None:
        """Power it up. ``without``: objects that it lacks; ``most``: greatest values below the table's."""
        lacks = without or set()
        self.rows = {key: row for key, row in ROWS.items() if key[0] not in lacks}
        self.most = {key: row[4] for key, row in self.rows.items()} | (most or {})
        self.mappable = {entry for entry in MAPPABLE if entry >> 16 not in lacks}
        self.frames: list[CanFrame] = []
        self.silent = False
        self.sends = 0
        """Bytes that its TPDO1 is cut or filled to; 0: as mapped."""
        self.rpm = self.mille = 0.0
        self._power_up()

    def _power_up(self) -> None:
        self.values = {key: row[2] for key, row in ROWS.items()}
        self.state, self.nmt = "off", 127
        self.taken, self.heartbeat_s, self.cleared = b"", float("inf"), False
        self.beat_s = self.moved_s = 0.0

    # --- wire -----------------------------------------------------------------------------------------------------

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Process a frame from the computer."""
        self._turn(now)
        if can_id == 0 and data[1] in (0, NODE):
            self._network(data[0], now)
        elif can_id == 0x600 + NODE and data[0] != 0x80:
            self._say(0x580 + NODE, self._service(data), now)
        elif can_id == 0x200 + NODE and self.nmt == 5 and self._open(0x1400):
            self.taken = data
        elif can_id == 0x80 and self.nmt == 5:
            self._synchronise(now)
        elif can_id == 0x77F:
            self.heartbeat_s = now

    def receive(self, now: float) -> list[CanFrame]:
        """Return its frames."""
        self._turn(now)
        beat = self.values[0x1017, 0] / 1000
        if beat and now >= self.beat_s + beat:
            self.beat_s = now
            self._say(0x700 + NODE, bytes((self.nmt,)), now)
        taken, self.frames = self.frames, []
        return [] if self.silent else taken

    def _say(self, can_id: int, data: bytes, now: float) -> None:
        self.frames.append((now, can_id, data))

    def _network(self, command: int, now: float) -> None:
        if command in (129, 130):
            self._power_up()
            self.moved_s = now
            self._say(0x700 + NODE, b"\0", now)
        self.nmt = {1: 5, 2: 4, 128: 127}.get(command, self.nmt)

    # --- objects --------------------------------------------------------------------------------------------------

    def _service(self, data: bytes) -> bytes:
        key = data[1] | data[2] << 8, data[3]
        row = self.rows.get(key)
        code = 0
        if row is None:
            code = NO_SUB if any(index == key[0] for index, _ in self.rows) else NO_OBJECT
        elif data[0] == 0x40:
            size = row[0]
            value = self._shown(key) & (1 << 8 * size) - 1
            return bytes((0x43 | 4 - size << 2,)) + data[1:4] + value.to_bytes(4, "little")
        elif row[1] == "r":
            code = READ_ONLY
        else:
            value = int.from_bytes(data[4:4 + row[0]], "little", signed=row[3] < 0)
            code = self._write(key, value, row[3])
        return bytes((0x80 if code else 0x60,)) + data[1:4] + code.to_bytes(4, "little")

    def _shown(self, key: tuple[int, int]) -> int:
        return {
            0x6041: SHOWN[self.state], 0x6043: round(self.rpm), 0x6044: round(self.rpm), 0x6077: round(self.mille),
            0x6061: self.values[0x6060, 0],
        }.get(key[0], self.values[key])  # fmt: skip

    def _write(self, key: tuple[int, int], value: int, least: int) -> int:
        """Store a value; return an abort code, or 0."""
        index, sub = key
        if not least <= value <= self.most[key] or (index == 0x605A and value not in (2, 6)):
            return RANGE
        if index in (0x1400, 0x1401, 0x1800, 0x1801) and sub == 1 and self._open(index) and not value >> 31:
            return RANGE if value != self.values[key] else 0  # a COB-ID changes only while its PDO is invalid
        if 0x1600 <= index < 0x1C00 and index & 0x200 and sub and value not in self.mappable:
            return UNMAPPABLE
        self.values[key] = value
        if index == 0x6040:
            self._command(value)
        return 0

    def _open(self, communication: int) -> bool:
        return not self.values[communication, 1] >> 31

    def _entries(self, mapping: int) -> list[int]:
        return [self.values[mapping, sub] >> 16 for sub in range(1, self.values[mapping, 0] + 1)]

    # --- motion ---------------------------------------------------------------------------------------------------

    def _synchronise(self, now: float) -> None:
        if self.taken and self.values[0x1400, 2] <= 240:
            words = [int.from_bytes(self.taken[i:i + 2], "little", signed=i > 0) for i in range(0, len(self.taken), 2)]
            mapped = dict(zip(self._entries(0x1600), words, strict=True))
            self._command(mapped[0x6040])
            if self.state == "runs" and not self.cleared:
                self.values[0x6042, 0] = mapped[0x6042]
            self.cleared = False
        if self._open(0x1800) and self.values[0x1800, 2] <= 240:
            data = b"".join((self._shown((i, 0)) & 0xFFFF).to_bytes(2, "little") for i in self._entries(0x1A00))
            self._say(0x180 + NODE, data.ljust(self.sends, b"\0")[:self.sends] if self.sends else data, now)

    def _command(self, word: int) -> None:
        rising, self.values[0x6040, 0] = word & ~self.values[0x6040, 0], word
        if self.state == "fault":
            self.state = "off" if rising & 0x80 else "fault"
        elif not word & 2:
            self.state = "off"
        elif not word & 4:
            self.state = "stops" if self.state in ("runs", "stops") else "off"
        elif self.state != "stops":
            wanted = {6: "ready", 7: "on", 15: "runs"}.get(word & 15, self.state)
            steps = ["off", "ready", "on", "runs"]
            reached = min(steps.index(wanted), steps.index(self.state) + 1)
            if steps[reached] == "runs" != self.state:
                self.values[0x6042, 0], self.cleared = 0, True
            self.state = steps[reached]

    def _turn(self, now: float) -> None:
        """Let the shaft turn until now, and watch the computer's heartbeat."""
        span, self.moved_s = now - self.moved_s, now
        watched = (self.values[0x1016, 1] & 0xFFFF) / 1000
        if watched and self.nmt == 5 and now > self.heartbeat_s + watched and self.state == "runs":
            self.state = {1: "fault", 2: "off", 3: "stops"}.get(self.values[0x6007, 0], "runs")
        word = self.values[0x6040, 0]
        runs = self.state == "runs" and self.values[0x6060, 0] == 2
        goal = self.values[0x6042, 0] if runs and word & 0x40 else 0
        goal = max(-self.values[0x6046, 2], min(self.values[0x6046, 2], goal))
        if runs and word & 0x30 != 0x30:
            return
        ramp = 0x604A if self.state == "stops" else 0x6048 if abs(goal) > abs(self.rpm) else 0x6049
        step = self.values[ramp, 1] / (self.values[ramp, 2] or 1) * span
        self.rpm += max(-step, min(step, goal - self.rpm))
        if self.state == "stops" and self.rpm == 0.0:
            self.state = "off"

    def fail(self, code: int, now: float) -> None:
        """Trip with an error code (CiA 402): it sends EMCY, and coasts."""
        self.state = "fault"
        self.values[0x603F, 0] = code
        self._say(0x80 + NODE, code.to_bytes(2, "little") + b"\x21" + bytes(5), now)
