"""The axes of this machine's conditions, and the quantities of a setpoint for its procedures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

from tester.base.axes import SURFACE, Axes, Axis, AxisValue, Setpoint

KIND: Final = "wheel_on_belt"

LEAST_SPEED_M_S: Final = 0.05
"""Least speed of a loaded wheel or belt: below it the control cannot be sure that they turn [A]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Positioned(Axis):
    """An axis with its own drive that moves it to a position while the wheel is lifted, and holds it under load.

    Its drive is in the rig file's ``axes`` and its limit in ``limits``, both under its name. An axis that a person sets
    (``manual: true``) stays at 0.
    """

    most: float
    """Greatest allowed limit of a rig, in ``recipe_unit``."""
    hardest: str
    """Greatest limit without an accepted risk (tester.inputs.rig.ceilings), with its unit ..."""
    because: str
    """... and its reason."""
    symbol: str
    """Its unit on screens."""
    mean: int
    """Index of its channel among the means of a block (tester.base.quantities.Channel)."""
    rank: int
    """Row of its channel on screens."""
    trend: str = ""
    """Column of its channel in the trend."""
    step: float = 1.0
    """Size of a step in manual mode, in ``recipe_unit``."""


AXES: Final = Axes(
    (
        Axis("slip_velocity", "m/s", "slip_velocity_m_s", "mm/s", 1e3, "slip_velocity_mm_s", "Slip Velocity /mm·s⁻¹",
             "Slip mm/s", "", None, True, 2),
        Axis("load", "N", "load_n", "N", 1.0, "load_n", "Load /N", "Load N", "", None, True, 1,
             gt=0.0, limit="limits.load"),
        Positioned("sideslip", "deg", "sideslip_deg", "deg", 1.0, "sideslip_deg", "Sideslip Angle /°", "Angle °",
                   "sideslip", 0.0, True, 4, ge=-90.0, le=90.0, limit="limits.sideslip", drive="axes.sideslip",
                   most=45.0, hardest="30 deg", because="the paper's tests end there: no side force is known beyond",
                   symbol="°", mean=9, rank=6, trend="sideslip_deg"),
        Positioned("camber", "deg", "camber_deg", "deg", 1.0, "camber_deg", "Camber Angle /°", "Camber °",
                   "camber", 0.0, False, 5, ge=-90.0, le=90.0, limit="limits.camber", drive="axes.camber",
                   most=45.0, hardest="10 deg",
                   because="a tread of 30 mm is 5 mm lower on one side: the other carries no load",
                   symbol="°", mean=10, rank=9),
        Axis("temperature", "degC", "temperature_c", "degC", 1.0, "temperature_c", "Temperature /°C", "Temp °C", "",
             None, True, 3, ge=-50.0, le=200.0),
        Axis("wheel_speed", "m/s", "wheel_speed_m_s", "m/s", 1.0, "wheel_speed_m_s", "Wheel Speed /m·s⁻¹", "Wheel m/s",
             "wheel", 0.8, False, 6, ge=LEAST_SPEED_M_S, in_measure=True, limit="limits.wheel_speed"),
        Axis(SURFACE, "1", "surface", "", 1.0, "surface", "Surface", "Surface", "on", "", False, 7),
    ),
    blocks="temperature",
)  # fmt: skip
"""All axes in the order of display. The paper held the wheel at 0.8 m/s and without camber throughout.

Slip velocity is wheel speed less belt speed at no sideslip, negative when braking; sideslip is the angle of the wheel's
plane to the belt's travel, camber its tilt; temperature is the surface's, wheel speed the line speed, surface the name
of the belt ("": the recipe's abrasive).
"""


POSITIONED: Final = tuple(axis for axis in AXES if isinstance(axis, Positioned))
"""The axes with a positioning drive, in order: rig sections, drives, control and screens are made from them."""


def straight() -> dict[str, float]:
    """Return the straight position of each positioned axis, 0, by name."""
    return dict.fromkeys(_NAMES, 0.0)


_NAMES = tuple(axis.name for axis in POSITIONED)


class HeldSetpoint(NamedTuple):
    """The quantities of a setpoint on this machine. Speeds m/s, load N, surface temperature degC."""

    compound: str
    slip_velocity_m_s: float
    load_n: float
    temperature_c: float
    wheel_speed_m_s: float
    positions: Mapping[str, float]
    """Positions of the positioned axes, by name, in their units."""

    @property
    def belt_speed_m_s(self) -> float:
        """Return the belt speed in m/s: wheel speed less slip velocity."""
        # Rounded to 1 nm/s: 0.8 - 0.3 is to be 0.5 in every output, not 0.5000000000000001.
        return round(self.wheel_speed_m_s - self.slip_velocity_m_s, 9)

    def reversed(self) -> HeldSetpoint:
        """Return the same setpoint with reversed slip: the belt is faster by as much as it was slower."""
        return self._replace(slip_velocity_m_s=-self.slip_velocity_m_s)

    @property
    def sideslip_deg(self) -> float:
        """Return the angle of the wheel's plane to the belt's travel, degrees."""
        return self.positions["sideslip"]

    @property
    def yawed(self) -> bool:
        """Return whether the wheel is at an angle to its line: it is then in contact only while it slides."""
        return any(self.positions.values())


_BY_FIELD = {axis.field: axis.name for axis in AXES}


@lru_cache(maxsize=8)
def _numbers_of(axes: Axes) -> Callable[[tuple[AxisValue, ...]], tuple[float, ...]]:
    return axes.numbers_of(*(_BY_FIELD[field] for field in HeldSetpoint._fields[1:-1]), *_NAMES)


def on_belt(setpoint: Setpoint, belt: str) -> Setpoint:
    """Return a setpoint on another belt; "": without a name of one."""
    values = list(setpoint.values)
    values[setpoint.axes.places[SURFACE]] = belt
    return setpoint._replace(values=tuple(values))


def held_by(setpoint: Setpoint) -> HeldSetpoint:
    """Return the quantities of a setpoint; further axes of a laboratory's own kind are ignored."""
    slip_m_s, load_n, temperature_c, wheel_m_s, *positions = _numbers_of(setpoint.axes)(setpoint.values)
    return HeldSetpoint(
        setpoint.compound, slip_m_s, load_n, temperature_c, wheel_m_s, dict(zip(_NAMES, positions, strict=True))
    )
