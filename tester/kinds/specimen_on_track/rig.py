"""A rig of this kind: its sections, their consistency checks, and the rules for reading its file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Annotated, ClassVar, Final, Literal

from drivers.axis import LEAST_COUNTS, AxisConfig
from sim.physics.track import TrackParameters
from tester.base.config_reader import Range
from tester.base.quantities import Quantities
from tester.base.source import Location
from tester.inputs.rig.config import NOT_REAL, PAPER, CalibrationConfig, OwnDevice, Rig, section_of
from tester.inputs.rig.key_classes import HIGHER, LOWER, TRUE, Bounded, Free, Held, Inside
from tester.inputs.rig.parameter import Parameter
from tester.inputs.rig.plain_rig import LISTEN, WITHHOLD
from tester.inputs.rig.section_classes import AXIS, WATCHDOG_PROOF
from tester.kinds.specimen_on_track import KIND
from tester.kinds.specimen_on_track.interlocks.chamber import STALE_AIR_S, STALE_EXIT_S
from tester.kinds.specimen_on_track.interlocks.force import STALE_CELL_S
from tester.kinds.specimen_on_track.interlocks.height import STALE_HEIGHT_S
from tester.kinds.specimen_on_track.interlocks.table import TABLE
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.machine.interlock_table import InterlockTable

_POSITIVE = Range(gt=0.0)
_NOT_NEGATIVE = Range(ge=0.0)
LOST_MM: Final = 1.0
"""An arm without its specimen is at least this much below the lowest height with one, mm [A]."""
METRES: Final = {"mm/s": 1e-3, "m/s": 1.0}
"""Metres per unit of length of the track's drive."""


_ENDS: Final = Held("the end switches, which open the safety chain 5 mm before the stops")
_TRACK: Final = {
    **AXIS,
    "rpdo_deadline": Bounded(LOWER, "250 ms", "a drive continues for this long without setpoints", zero_is_off=True),
}


@dataclass(frozen=True, slots=True)
class TrackLimitsConfig:
    """Hard limits: no recipe and no procedure exceeds them."""

    force_n: Annotated[
        float, "N", Range(gt=0.0, le=195.0),
        Bounded(LOWER, "195 N", "the cell ends at 200 N: it does not see a greater force"),
    ]  # fmt: skip
    """At most 195 N: these rigs' cells end at 200 N."""
    track_speed_m_s: Annotated[
        float, "m/s", _POSITIVE,
        Bounded(LOWER, "2.1 m/s", "a disc at 2.1 m/s stops within 1.1 s; a disc that does not must lose its power 3 s"
                                  " after a trip"),
    ]  # fmt: skip
    slowest_m_s: Annotated[float, "m/s", _POSITIVE, Free("a recipe that asks for a slower track is refused")]
    air_low_c: Annotated[
        float, "degC", Range(ge=-55.0, le=60.0),
        Bounded(HIGHER, "-50 degC", "the chamber's own limiter acts at -55 degC"),
    ]  # fmt: skip
    air_high_c: Annotated[
        float, "degC", Range(ge=-55.0, le=105.0),
        Bounded(LOWER, "100 degC", "the chamber's own limiter acts at 105 degC"),
    ]  # fmt: skip
    travel_low_mm: Annotated[float, "mm", _NOT_NEGATIVE, _ENDS]
    travel_high_mm: Annotated[float, "mm", _NOT_NEGATIVE, _ENDS]


@dataclass(frozen=True, slots=True)
class TrackAxes:
    """The drives; the lift is None for an arm that is moved by hand (``manual: true`` in the file)."""

    track: Annotated[AxisConfig, Inside(_TRACK)]
    lift: Annotated[AxisConfig | None, Inside(_TRACK)]


@dataclass(frozen=True, slots=True)
class ArmConfig:
    """The arm: its raised place, and its tolerance."""

    raised_mm: Annotated[float, "mm", _POSITIVE, Held("the cell, which shows no force with the arm raised")]
    within_mm: Annotated[
        float, "mm", _POSITIVE, Bounded(LOWER, "1 mm", "the specimen touches 1 mm above its lowered place", own=True)
    ]
    protrusion_mm: Annotated[
        float, "mm", _POSITIVE,
        Bounded(HIGHER, "3 mm", "of it wear and thickness take 1 mm each: 1 mm shows a lost specimen", own=True),
    ]  # fmt: skip
    """Least height of a new specimen out of its holder."""


@dataclass(frozen=True, slots=True)
class TrackGates:
    """When a sample counts. A recipe sets the temperature band."""

    speed_percent: Annotated[float, "%", _POSITIVE, Bounded(LOWER, "5 %", "a sample at another speed counts", own=True)]
    stationary_percent: Annotated[
        float, "%", _POSITIVE, Bounded(LOWER, "2 %", "friction that still grows counts as that of sliding", own=True)
    ]
    settle_s: Annotated[float, "s", _NOT_NEGATIVE, Bounded(HIGHER, "1 s", "the arm still swings", own=True)]


@dataclass(frozen=True, slots=True)
class HeatConfig:
    """Assumed heating by friction, for checks and plans."""

    rise: Annotated[float, "K/W", _NOT_NEGATIVE, Free("checks and plans warn by it; nothing is heated by it")]
    """Final warming of the specimen's contact per power of friction."""


@dataclass(frozen=True, slots=True)
class TrackArmingConfig:
    """The proofs before a run may move anything."""

    listen_s: Annotated[float, "s", _NOT_NEGATIVE, LISTEN]
    bump_test: Annotated[bool, Bounded(HIGHER, TRUE, "without it the track may turn the wrong way, or not at all")]
    watchdog_proof: Annotated[bool, WATCHDOG_PROOF]
    withhold_s: Annotated[float, "s", _POSITIVE, WITHHOLD]
    creep_m_s: Annotated[
        float, "m/s", _POSITIVE, Bounded(LOWER, "0.1 m/s", "nothing is proven yet: a person can step back")
    ]
    unloaded_n: Annotated[
        float, "N", Range(gt=0.0, le=20.0),
        Bounded(LOWER, "10 N", "half of the least weight: an arm that is down must not pass"),
    ]  # fmt: skip


@dataclass(frozen=True, slots=True)
class TrackCertificatesConfig(CalibrationConfig):
    """The sensors that have a certificate."""

    certificates: ClassVar[tuple[str, ...]] = ("load_cell", "weights", "temperature")

    load_cell: Annotated[str, PAPER] = ""
    weights: Annotated[str, PAPER] = ""
    temperature: Annotated[str, PAPER] = ""


if TYPE_CHECKING:

    @dataclass(frozen=True, slots=True)
    class TrackInterlocksConfig:
        """The section ``interlocks``: a field for each parameter of the interlock table."""

        def __getattr__(self, name: str) -> float:
            """Return a parameter's value in its unit, by the name of its field (``Parameter.name``)."""
            ...

else:
    TrackInterlocksConfig = section_of("TrackInterlocksConfig", TABLE.parameters, __name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackConfig(Rig):
    """A rig: everything that the software must know about the machine, and nothing about a test."""

    packaged: ClassVar[Mapping[str, str]] = KIND.rigs
    may_lack: ClassVar[tuple[str, ...]] = (
        *Rig.may_lack, "axes.*.rpdo_deadline", "axes.*.inputs_period", "axes.*.max_torque_per_mille",
        "axes.*.home_timeout", "devices.*.emissivity", "arm.protrusion", "gates", "interlocks", "arming", "heat",
    )  # fmt: skip
    manual: ClassVar[tuple[str, ...]] = ("lift",)
    own: ClassVar[Mapping[str, OwnDevice]] = {
        "load_cell": OwnDevice("load cell", "load_cell", channels=("fx",), stale=STALE_CELL_S),
        "chamber": OwnDevice("chamber", "chamber", optional=True, stale=STALE_AIR_S),
        "pyrometer": OwnDevice("pyrometer", "ir_thermometer", optional=True, stale=STALE_EXIT_S),
        "thermometer": OwnDevice("thermometer", "ir_thermometer", optional=True),
        "height_sensor": OwnDevice(
            "height sensor", "sensor", optional=True, channels=("height",), stale=STALE_HEIGHT_S
        ),
    }
    quantities: ClassVar[Quantities] = QUANTITIES
    table: ClassVar[InterlockTable] = TABLE
    parameters: ClassVar[tuple[Parameter, ...]] = TABLE.parameters
    watched: ClassVar[tuple[str, ...]] = TABLE.channels
    real: ClassVar[tuple[tuple[str, str], ...]] = (("# air around a real rig; the simulated one's is sim.ambient",
                                                    "# air around the rig"),)  # fmt: skip

    track: Annotated[Literal["linear", "disc"], Held("axes.track and limits.travel; a disc has no end switches")]
    weights: Annotated[tuple[float, ...], Held("the weights on the arm, which a person puts there and confirms")]
    """The arm's possible loads, N, lightest first."""
    ambient: Annotated[float, "degC", Range(ge=-40.0, le=60.0), Free("it is recorded, and moves nothing")]
    limits: TrackLimitsConfig
    axes: TrackAxes
    arm: ArmConfig
    gates: TrackGates
    heat: HeatConfig
    interlocks: TrackInterlocksConfig
    arming: TrackArmingConfig
    calibration: TrackCertificatesConfig = field(default_factory=TrackCertificatesConfig)
    sim: Annotated[TrackParameters, NOT_REAL] = field(default_factory=TrackParameters)
    """The simulated rig's physics; unused on a real rig."""

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC."""
        return self.sim.ambient if self.simulated else self.ambient

    def in_air(self, ambient_c: float) -> TrackConfig:
        """Return the rig with this temperature of the air around a real machine, degC, in its file."""
        return replace(self, ambient=ambient_c)

    def drives(self) -> Mapping[str, AxisConfig]:
        """Return the axes that have a drive, by name."""
        lift = self.axes.lift
        return {"track": self.axes.track} | ({"lift": lift} if lift is not None else {})

    @property
    def linear(self) -> bool:
        """The track has two ends."""
        return self.track == "linear"

    @property
    def chamber(self) -> bool:
        """The air around the specimen is heated and cooled."""
        return "chamber" in self.devices

    @property
    def heaviest_n(self) -> float:
        """The greatest load, N."""
        return max(self.weights, default=0.0)

    @property
    def height_low_mm(self) -> float:
        """The lowest height of an arm whose specimen rests on the track, mm."""
        return -(self.interlocks.wear_mm + self.interlocks.thickness_mm)

    @property
    def height_high_mm(self) -> float:
        """The greatest height of such an arm, mm."""
        return self.interlocks.thickness_mm

    @property
    def metres(self) -> float:
        """Metres per unit of length of the track's drive."""
        return METRES[self.axes.track.unit]

    def problems(self) -> Iterator[tuple[Location, str]]:
        """Yield inconsistencies between the kind's sections, with their places."""
        track, limits = self.axes.track, self.limits
        if track.unit not in METRES or track.mode != "velocity":
            yield ("axes", "track"), "the track has a speed in mm/s or m/s (expected mode velocity)"
            return
        if track.max_speed * self.metres < limits.track_speed_m_s:
            yield ("axes", "track", "max_speed"), "is less than limits.track_speed"
        if limits.slowest_m_s >= limits.track_speed_m_s:
            yield ("limits", "slowest"), "is not below limits.track_speed"
        if limits.air_low_c >= limits.air_high_c:
            yield ("limits", "air_low"), "is not below limits.air_high"
        slowest = limits.slowest_m_s / self.metres * track.velocity_increments
        if track.drive.inverter and slowest < LEAST_COUNTS:
            message = f"is {slowest:.3g} counts of 0x6042 (expected {LEAST_COUNTS} or more: steps of 1 %)"
            yield ("limits", "slowest"), f"{message}: raise it, more motor turns, or target_rpm below 1"
        if not track.digital_io:
            yield ("axes", "track", "digital_io"), "the track's drive carries the safety inputs (expected true)"
        if self.linear and track.feedback != "position":
            yield ("axes", "track", "feedback"), "a linear track has ends: its place is asked (expected position)"
        if self.linear and limits.travel_low_mm >= limits.travel_high_mm:
            yield ("limits", "travel_low"), "is not below limits.travel_high"
        if not self.weights or min(self.weights) <= 0.0 or list(self.weights) != sorted(self.weights):
            yield ("weights",), "expected one weight in N or more, the lightest first"
        if not {"chamber", "thermometer"} & self.devices.keys():
            yield ("devices",), "nothing measures the air at the specimen (expected chamber or thermometer)"
        if self.simulated and self.linear != (self.sim.motion == "linear"):
            yield ("sim", "motion"), f"is {self.sim.motion}, and track is {self.track}"
        if self.simulated and self.chamber != self.sim.enclosed:
            yield ("sim", "enclosed"), "contradicts devices on whether there is a chamber"
        least_mm = LOST_MM - self.height_low_mm
        if "height_sensor" in self.devices and not self.arm.protrusion_mm >= least_mm:
            message = f"hides a lost specimen: interlocks.wear and thickness with {LOST_MM:g} mm beyond them are"
            yield ("arm", "protrusion"), f"{message} {least_mm:g} mm (expected at least that, or less of both)"
        if self.simulated and not self.sim.contact.protrusion >= self.arm.protrusion_mm:
            yield ("sim", "contact", "protrusion"), f"is below arm.protrusion, {self.arm.protrusion_mm:g} mm"
        own_mm2 = self.sim.contact.area
        if self.simulated and self.sim.of_materials and self.contact is not None and self.contact.area != own_mm2:
            message = f"sim.law {self.sim.law} rubs on {own_mm2:g} mm2 (sim.contact.area; expected the same)"
            yield ("contact", "area"), message
