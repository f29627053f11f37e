"""The axes of this machine's conditions."""

from __future__ import annotations

from typing import Final, NamedTuple

from tester.base.axes import SURFACE, Axes, Axis, Setpoint, surface_of

NAME: Final = "specimen_on_track"
INTERFACES: Final = ("dry", "wet", "talc")

AXES: Final = Axes(
    (
        Axis(SURFACE, "1", "surface", "", 1.0, "surface", "Surface", "Surface", "on", "", False, 5),
        Axis("interface", "1", "interface", "", 1.0, "interface", "Interface", "Interface", "", "dry", False, 4,
             choices=INTERFACES),
        Axis("load", "N", "load_n", "N", 1.0, "load_n", "Load /N", "Load N", "", None, True, 3, gt=0.0,
             limit="weights"),
        Axis("temperature", "degC", "temperature_c", "degC", 1.0, "temperature_c", "Temperature /°C", "Temp °C", "",
             None, True, 2, ge=-100.0, le=200.0),
        Axis("track_speed", "m/s", "track_speed_m_s", "mm/s", 1e3, "track_speed_mm_s", "Track Speed /mm·s⁻¹",
             "Track mm/s", "", None, True, 1, gt=0.0, limit="limits.track_speed"),
    ),
    blocks="temperature",
)  # fmt: skip
"""All axes, in the order of texts for people: what a person changes (surface, interface, weights) before the speed.

Track speed is the speed of the track under the standing specimen, load the force of the weights on the arm,
temperature that of the air around the specimen, surface the name of what the track is covered with ("": the recipe's
abrasive), interface its state: dry, wet or powdered.
"""


class TrackHeld(NamedTuple):
    """The values of a setpoint of this machine."""

    track_m_s: float
    load_n: float
    temperature_c: float
    interface: str
    surface: str


def held_by(setpoint: Setpoint) -> TrackHeld:
    """Return the values of a setpoint by their names."""
    number = setpoint.number
    interface = str(setpoint.value("interface"))
    return TrackHeld(number("track_speed"), number("load"), number("temperature"), interface, surface_of(setpoint))
