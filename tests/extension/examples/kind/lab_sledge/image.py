"""What a scan knows of the sledge, and the table of its channels."""

from dataclasses import dataclass
from math import copysign

from tester.base.quantities import BURST, GATE, KEY, TIME, Channel, Figure, Quantities, Roles, Screen
from tester.machine.image import NAN
from tester.machine.plain.image import PlainReadings


@dataclass(slots=True)
class SledgeReadings(PlainReadings):
    """Newest values; ``way_mm`` counts every way, ``place_mm`` from where the sledge was put down."""

    load_n: float = NAN
    speed_mm_s: float = NAN
    force_n: float = NAN
    way_mm: float = 0.0
    place_mm: float = 0.0

    def update(self, dt: float) -> None:
        """Count the way, and the force along it."""
        self.speed_mm_s = speed = self.drives["pull"]
        if speed == speed:
            self.place_mm += speed * dt
            self.way_mm += abs(speed) * dt
            self.slid_m += 1e-3 * abs(speed) * dt
        self.force_n = copysign(1.0, speed) * self.sensors["load_cell"][0]


QUANTITIES = Quantities(
    (
        Channel(TIME, "s", "Time", "now"),
        Channel("force_n", "N", "Pull", "readings.force_n", 1, 2,
                screen=Screen("force", 2, "load_cell", Figure(), Figure("interlocks.spring_n", 1.1),
                              Figure("interlocks.spring_n"), trend="force_n")),
        Channel("load_n", "N", "Weight", "readings.load_n", 2, 2),
        Channel("speed_mm_s", "mm/s", "Speed", "readings.speed_mm_s", 3, 2,
                screen=Screen("speed", 3, "can", Figure("sledge.speed_mm_s", -1.1), Figure("sledge.speed_mm_s", 1.1),
                              Figure("sledge.speed_mm_s"), both=True, axis="speed", trend="speed_mm_s")),
        Channel("way_mm", "mm", "Way", "readings.way_mm"),
        Channel(GATE, "", "Gates closed", "gate", decimals=0, whole=True),
        Channel(BURST, "", "Burst", "burst", decimals=0, whole=True),
        Channel(KEY, "", "Repeat", "repeat_key", decimals=0, whole=True),
        Channel("friction", "", "Friction mu", "", decimals=3,
                screen=Screen("friction", 1, "load_cell", Figure(), Figure(offset=2.0), trend="friction")),
    ),
    Roles(friction=("force_n",), normal="load_n", turn="way_mm", block=5.0),
)  # fmt: skip
"""A block is 5 mm of way: at 50 mm/s and 100 scans a second it has ten samples."""
