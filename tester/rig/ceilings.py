"""How far each safety key of a rig file may be loosened: its direction, its hardest value, and why there.

The parameters of interlocks say it themselves (tester.interlocks.parameter); the keys of the other sections stand here.
A value that is looser than the rig it is for allows is a risk: somebody has to accept it in words (tester.rig.load).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, fields
from functools import cache
from typing import TYPE_CHECKING, Any, Final

from drivers.canopen.dictionary import PRODUCT_CODE, VENDOR_ID
from tester.config_reader import key_of
from tester.interlocks.parameter import Direction
from tester.interlocks.table import PARAMETERS
from tester.interlocks.written import SECTION
from tester.rig.config import RigConfig
from tester.units import parse

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

LOWER, HIGHER = Direction.LOWER, Direction.HIGHER
TRUE: Final = "true"
"""Hardest value of a switch that may not be off."""
_AXES = "axes.*."
_SAID_ONCE = {"heartbeat": "drive_heartbeat", "consumer_heartbeat": "consumer_heartbeat"}
"""Keys of an axis that the section ``can`` says for all: a risk is told once."""


@dataclass(frozen=True, slots=True)
class Ceiling:
    """A key of the rig file on which safety hangs. ``*`` in it stands for every axis that has a drive."""

    key: str
    unit: str
    """"" for a switch. The bare numbers of an axis count in its own unit: they have none of their own either."""
    direction: Direction
    """Which way is tighter; of a switch, true is the higher value."""
    hardest: str
    """The loosest value that is accepted, as text like that of the rig file."""
    because: str
    zero_is_off: bool = False
    """0 switches the watch off: looser than any other value."""

    @property
    def limit(self) -> float:
        """The hardest value in the key's unit; 1 for "true"."""
        return 1.0 if self.hardest == TRUE else parse(self.hardest, self.unit or "1")

    def looser(self, value: float, limit: float) -> bool:
        """Tell whether a value is looser than a limit; what is not a number is."""
        if self.zero_is_off and value == 0.0:
            return limit != 0.0
        if self.zero_is_off and limit == 0.0:
            return value != value
        return not (value <= limit) if self.direction is LOWER else not (value >= limit)

    def text(self, value: float) -> str:
        """Return a value as the rig file writes it."""
        if self.hardest == TRUE:
            return TRUE if value else "false"
        return f"{value:g} {self.unit}".removesuffix(" 1").rstrip()


_OWN: Final = (
    Ceiling("limits.load", "N", LOWER, "450 N",
            "the load trips at once above it, and the press still comes for some 50 ms: harm begins at 500 N"),
    Ceiling("limits.wheel_speed", "m/s", LOWER, "1.5 m/s",
            "at 1.5 m/s a wheel that does not stop loses its power after 2.5 s; no step of a stop may begin later"),
    Ceiling("limits.belt_speed", "m/s", LOWER, "1.5 m/s",
            "at 1.5 m/s a belt that does not stop loses its power after 2.5 s; no step of a stop may begin later"),
    Ceiling("limits.slip_power", "W", LOWER, "400 W",
            "the wheel's drive gives 400 W at its rated torque: 16 N m at 25 rad/s"),
    Ceiling("limits.jacket", "degC", LOWER, "150 degC",
            "3 K of margin and 2 K of what comes after the heat is off make 155 degC, which harms"),
    Ceiling("limits.surface", "degC", LOWER, "100 degC",
            "the contact is hotter than the surface beside it by some 20 K [A]; harm begins at 130 degC there"),
    Ceiling("limits.sideslip", "deg", LOWER, "30 deg", "the paper's tests end there: no side force is known beyond"),
    Ceiling("limits.camber", "deg", LOWER, "10 deg",
            "a tread of 30 mm is 5 mm lower on one side then: the other side carries no load any more"),
    Ceiling("arming.watchdog_proof", "", HIGHER, TRUE,
            "without it nobody knows whether the drives stop when this program does"),
    Ceiling("arming.bump_test", "", HIGHER, TRUE, "without it wheel and belt may be exchanged, or turn the wrong way"),
    Ceiling("arming.listen", "s", HIGHER, "0.5 s", "another master sends twice a second or oftener [A]"),
    Ceiling("arming.withhold", "s", HIGHER, "300 ms",
            "half as long again as the 200 ms after which a drive must report the missing heartbeat"),
    Ceiling("arming.creep", "m/s", LOWER, "0.1 m/s", "nothing is proven yet: a wheel turns once in three seconds"),
    Ceiling("arming.unloaded", "N", LOWER, "30 N",
            "450 N, the most that is asked for, and 30 N of a wrong zero are 480 N; harm begins at 500 N"),
    Ceiling("scan.sliding", "Hz", HIGHER, "50 Hz", "a delay of 50 ms is two scans and a half: fewer are one reading"),
    Ceiling("scan.enabled", "Hz", HIGHER, "10 Hz", "two setpoints within the 200 ms after which a drive stops"),
    Ceiling("scan.idle", "Hz", HIGHER, "5 Hz", "the inputs are too old after 250 ms: one scan at least looks at them"),
    Ceiling("can.heartbeat", "s", LOWER, "100 ms", "two of the PC's heartbeats within the 200 ms that the drives wait"),
    Ceiling("can.drive_heartbeat", "s", LOWER, "100 ms", "three are missed before a drive is lost: 0.3 s"),
    Ceiling("can.consumer_heartbeat", "s", LOWER, "300 ms",
            "a drive that hears nothing goes on as told: another 0.1 s at 400 W (limits.slip_power) are 40 J: harm"),
    Ceiling(f"{_AXES}heartbeat", "s", LOWER, "100 ms", "as can.drive_heartbeat"),
    Ceiling(f"{_AXES}consumer_heartbeat", "s", LOWER, "300 ms", "as can.consumer_heartbeat"),
    Ceiling(f"{_AXES}proves_watchdog", "", HIGHER, TRUE, "as arming.watchdog_proof, for one drive"),
    *(Ceiling(f"axes.{name}.rpdo_deadline", "s", LOWER, "250 ms",
              "a drive that hears no setpoint costs 3# 45 J without it; harm is 40 J", zero_is_off=True)
      for name in ("wheel", "belt", "press")),
    Ceiling("axes.wheel.quick_stop_deceleration", "", HIGHER, "200",
            "rad/s2; at 8 m/s2 (178 rad/s2) a jammed belt costs 3# 45 J at 430 N, harm is 40 J"),
    Ceiling("axes.belt.quick_stop_deceleration", "", HIGHER, "9", "m/s2; as the wheel's"),
    Ceiling("axes.wheel.speed_zero", "", HIGHER, "0.1",
            "rad/s; 0 is off: a jam is then seen with the next scan, and costs 3# 77 J; harm is 40 J"),
    Ceiling("axes.belt.speed_zero", "", HIGHER, "0.005", "m/s; as the wheel's"),
    Ceiling("axes.press.acceleration", "", HIGHER, "600",
            "mm/s2; at 400 and 30 mm/s a wheel in local mode costs 3# 42 J, at 600 and 40 mm/s 39.5 J: harm is 40 J"),
    Ceiling("axes.press.max_speed", "", HIGHER, "40", "mm/s, of a fast stop; as axes.press.acceleration"),
    Ceiling("axes.press.quick_stop_deceleration", "", HIGHER, "100", "mm/s2; from 10 mm/s it comes 0.5 mm further"),
    Ceiling("loops.load.touch_load", "N", LOWER, "20 N",
            "what is wrong with direction or scale of wheel and belt is told at 20 N or less"),
    Ceiling("loops.load.follow_rate", "N/s", HIGHER, "50 N/s",
            "the load is watched against the one before until a change is followed: 450 N to none take 9 s then"),
    Ceiling("loops.load.touch_speed", "mm/s", LOWER, "15 mm/s", "it comes 0.75 mm in the 50 ms until it is seen"),
    Ceiling("loops.load.loading_speed", "mm/s", LOWER, "4 mm/s", "at 172 N/mm the load rises by 34 N in 50 ms"),
    Ceiling("loops.load.lift_speed", "mm/s", HIGHER, "5 mm/s", "lifting 2.5 mm takes 0.5 s, half of what it may"),
    Ceiling("loops.load.clearance", "mm", HIGHER, "1 mm", "twenty times the runout of the tread"),
    Ceiling("loops.heat.hub_max", "degC", LOWER, "150 degC", "as limits.jacket"),
)  # fmt: skip

CEILINGS: Final[tuple[Ceiling, ...]] = (
    *_OWN,
    *(Ceiling(f"{SECTION}.{one.key}", "" if one.unit == "1" else one.unit, one.direction, one.hardest, one.because)
      for one in PARAMETERS if one.direction is not None),
)  # fmt: skip
"""Every safety key of a rig file, in the order of the page docs/safety.md."""


def ceiling_table() -> str:
    """Return every safety key with its direction, its hardest value and the reason as Markdown, a line each."""
    lines = ["| key | tighter is | not looser than | because |", "|---|---|---|---|"]
    lines += [f"| {one.key} | {one.direction.value} | {one.hardest} | {one.because} |" for one in CEILINGS]
    return "\n".join(lines) + "\n"


@dataclass(frozen=True, slots=True)
class Risk:
    """A value of a rig that is looser than it may be without somebody's word for it."""

    ceiling: Ceiling
    location: tuple[str, ...]
    value: float
    limit: float

    @property
    def key(self) -> str:
        """The key, as it stands in the rig file."""
        return ".".join(self.location)

    def __str__(self) -> str:
        """Say key, value and limit."""
        return f"{self.key} {self.compared}"

    @property
    def compared(self) -> str:
        """Say value and limit."""
        one = self.ceiling
        hardest = f" and than {one.hardest}" if one.looser(self.value, one.limit) and self.limit != one.limit else ""
        return f"{one.text(self.value)} is looser than {one.text(self.limit)}{hardest}"


def counts_as_simulated(rig: RigConfig) -> bool:
    """Tell whether nobody can be hurt at a rig: it is simulated in this process, or behind a door.

    A rig behind a door is one whose every drive has to report the simulator's identity (0x1018). It is compared at
    every connect, before anything moves: with other drives on the wire nothing begins.
    """
    drives = rig.axes.driven().values()
    return rig.simulated or all((d.vendor_id, d.product_code) == (VENDOR_ID, PRODUCT_CODE) for d in drives)


def loosened(rig: RigConfig, than: RigConfig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser in one rig than in another; axes that only one has are left out."""
    found: list[Risk] = []
    for one, location, value in _values(rig):
        limit = _value(than, location)
        if limit is not None and one.looser(value, limit):
            found.append(Risk(one, location, value, limit))
    return tuple(found)


def beyond(rig: RigConfig) -> tuple[Risk, ...]:
    """Return the safety keys that are looser than their hardest values."""
    return tuple(
        Risk(one, location, value, one.limit) for one, location, value in _values(rig) if one.looser(value, one.limit)
    )


def _values(rig: RigConfig) -> Iterator[tuple[Ceiling, tuple[str, ...], float]]:
    """Yield every safety key that a rig has, with its place and its value (1 and 0 of a switch)."""
    for one in CEILINGS:
        names = rig.axes.driven() if "*" in one.key else ("",)
        for name in names:
            location = tuple(one.key.replace("*", name).split("."))
            value = _value(rig, location)
            said = _value(rig, ("can", _SAID_ONCE.get(location[-1], ""))) if name else None
            if value is not None and value != said:
                yield one, location, value


def _value(rig: RigConfig, location: tuple[str, ...]) -> float | None:
    """Return the value at a place of the file, None where the rig has no such axis."""
    found: Any = rig
    for key in location:
        name = _names(type(found)).get(key) if found is not None else None
        if name is None:
            return None
        found = getattr(found, name)
    return float(found)


@cache
def _names(kind: type[DataclassInstance]) -> dict[str, str]:
    """Return the fields of a section by their keys."""
    return {key_of(kind, field.name): field.name for field in fields(kind)}
