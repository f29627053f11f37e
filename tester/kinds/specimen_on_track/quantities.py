"""The channels of a specimen on a track."""

from __future__ import annotations

from typing import Final

from tester.base.quantities import BURST, GATE, KEY, TIME, Channel, Figure, Quantities, Roles, Screen

_ZERO: Final = Figure()
_COLD: Final = Figure("limits.air_low_c", offset=-10.0)
_HOT: Final = Figure("limits.air_high_c", offset=10.0)

QUANTITIES: Final = Quantities(
    (
        Channel(TIME, "s", "Time", "now"),
        Channel("track_m_s", "m/s", "Track speed", "readings.track_m_s", decimals=6,
                column="track_mm_s", shown_unit="mm/s", scale=1e3,
                screen=Screen("track", 2, "can", Figure("limits.track_speed_m_s", -1100.0),
                              Figure("limits.track_speed_m_s", 1100.0), Figure("limits.track_speed_m_s", 1000.0),
                              both=True, axis="track_speed", trend="track_mm_s")),
        Channel("force_n", "N", "Force", "readings.force_n", decimals=2,
                screen=Screen("force", 3, "load_cell", Figure("limits.force_n", -1.1), Figure("limits.force_n", 1.1),
                              Figure("limits.force_n"), both=True, watched=True, trend="force_n")),
        Channel("friction_n", "N", "Friction force", "readings.friction_n", 1, 2),
        Channel("sliding_m_s", "m/s", "Sliding speed", "readings.sliding_m_s", 3, 6,
                column="sliding_mm_s", shown_unit="mm/s", scale=1e3),
        Channel("load_n", "N", "Load", "readings.load_n", 2, 1,
                screen=Screen("load", 4, "load_cell", _ZERO, Figure("heaviest_n", 1.1), axis="load")),
        Channel("air_c", "°C", "Air temp", "readings.air_c", 5, 2,
                screen=Screen("air", 5, "air", _COLD, _HOT, Figure("limits.air_high_c"), watched=True,
                              axis="temperature", trend="air_c")),
        Channel("contact_c", "°C", "Contact temp", "readings.contact_c", 4, 2,
                screen=Screen("contact", 6, "contact", _COLD, _HOT, trend="contact_c")),
        Channel("chamber_percent", "%", "Chamber", "readings.chamber_percent", decimals=0,
                screen=Screen("chamber", 7, "air", Figure(offset=-100.0), Figure(offset=100.0))),
        Channel("track_mm", "mm", "Track place", "readings.track_mm", decimals=3),
        Channel("lift_mm", "mm", "Arm", "readings.lift_mm", decimals=2,
                screen=Screen("lift", 8, "can", _ZERO, Figure("arm.raised_mm", 1.1))),
        Channel("height_mm", "mm", "Arm height", "readings.height_mm", decimals=3,
                screen=Screen("height", 9, "height_sensor", Figure("height_low_mm", 1.5), Figure("arm.raised_mm", 1.1),
                              Figure("height_high_mm"), lower=Figure("height_low_mm"), optional=True, watched=True)),
        Channel("way_m", "m", "Way", "readings.way_m", decimals=6),
        Channel("stretch", "", "Stretches", "readings.stretch"),
        Channel(GATE, "", "Gates closed", "gate", decimals=0, whole=True),
        Channel(BURST, "", "Way there or back", "burst", decimals=0, whole=True),
        Channel(KEY, "", "Repeat", "repeat_key", decimals=0, whole=True),
        Channel("friction", "", "Friction mu", "", decimals=3,
                screen=Screen("friction", 1, "load_cell", _ZERO, Figure(offset=3.0), trend="friction")),
    ),
    Roles(friction=("friction_n",), normal="load_n", turn="stretch", temperature="contact_c", sliding="sliding_m_s"),
)  # fmt: skip
"""In the order of a sample's columns. Blocks are counted in stretches: a tenth of the way that a condition is to slide,
forward or back."""
