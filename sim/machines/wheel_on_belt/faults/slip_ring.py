"""A slip ring that is worn at one place: the jacket's line fails while the brush is there."""

from __future__ import annotations

from math import pi
from typing import Final

from sim.faults.modbus import line_of, slave_of
from sim.faults.scene import Effect, Scene
from sim.machines.wheel_on_belt.faults.place import wheel_rig
from sim.wires.modbus_wire import Impairment

HALF_DEG: Final = 20.0
"""The worn place reaches this far to either side of its centre, degrees of the wheel's turn [A]."""
_DEVICE: Final = "jacket"


class WornSector(Effect):
    """Requests to the jacket fail while the wheel stands within HALF_DEG of an angle.

    ``turns`` of the wheel count from when it begins; at the angle 0 it stands then.
    """

    __slots__ = ("_at_rev", "_impairment", "_last_s", "turns")

    every_step = True

    def __init__(self, degrees: float) -> None:
        """At this angle."""
        self._at_rev = degrees / 360.0
        self._impairment: Impairment | None = None
        self._last_s = 0.0
        self.turns = 0.0

    def begin(self, scene: Scene, now: float) -> None:
        """Begin with a sound line."""
        line = line_of(scene, _DEVICE)
        self._last_s = now
        self._impairment = Impairment("corrupt", 0, slave_of(scene, _DEVICE).unit_id, besides=line.impair)
        line.impair = self._impairment

    def end(self, scene: Scene, now: float) -> None:
        """Let the line be sound again."""
        if self._impairment is not None:
            self._impairment.count = 0
            self._impairment = None

    def renew(self, scene: Scene, now: float) -> None:
        """Follow the wheel to ``now`` s."""
        self.turns += wheel_rig(scene).wheel_rad_s * (now - self._last_s) / (2.0 * pi)
        self._last_s = now
        if self._impairment is not None:
            away_rev = abs((self.turns - self._at_rev + 0.5) % 1.0 - 0.5)
            self._impairment.count = -1 if 360.0 * away_rev <= HALF_DEG else 0
