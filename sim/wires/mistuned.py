"""Ports of a computer whose adapter has other settings than the devices on its wire: no device understands it."""

from __future__ import annotations

from drivers.ports import BusLost, CanFrame, FrameByFrame, WatchedLine


class MistunedCan(FrameByFrame):
    """A CAN adapter at another bit rate than its bus: no frame is acknowledged, and its controller goes bus-off."""

    def __init__(self) -> None:
        """Begin before the first frame."""
        super().__init__()
        self.bus_off = False

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Send a frame that no node acknowledges: errors count up to 256 within milliseconds (ISO 11898-1, 12.1)."""
        if self.bus_off:
            raise BusLost("CAN bus lost: bus-off")
        self.tell_sent(can_id, data, now)
        self.bus_off = True

    def receive(self, now: float) -> list[CanFrame]:
        """Return nothing; raises BusLost once it is bus-off."""
        if self.bus_off:
            raise BusLost("CAN bus lost: bus-off")
        return []


class MistunedLine(WatchedLine):
    """A serial port at another speed or parity than its devices: they recognise no frame, and are silent."""

    def write(self, data: bytes, now: float) -> None:
        """Send bytes that no device understands."""
        self.tell(now, data, True)

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return nothing."""
        return []
