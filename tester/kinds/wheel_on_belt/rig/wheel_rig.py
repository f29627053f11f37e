"""A rig of this kind: its sections together, and the rules for reading its file (tester.inputs.rig.config)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from math import ceil
from typing import Annotated, ClassVar, Final

from drivers.axis import AxisConfig
from drivers.profiles import ProfileError
from sim.physics.parameters import SimParameters
from tester.base.quantities import Quantities
from tester.base.source import Location
from tester.inputs.rig.config import HEAT_OFF, NOT_REAL, OwnDevice, Rig
from tester.inputs.rig.further_sensors import skew_problem
from tester.inputs.rig.parameter import Parameter
from tester.inputs.rig.profiles import profile_of
from tester.kinds.wheel_on_belt import KIND
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.interlocks.friction import BELT_CAUGHT, BELT_TORQUE, SHAFT_POWER
from tester.kinds.wheel_on_belt.interlocks.hub import STALE_JACKET_S
from tester.kinds.wheel_on_belt.interlocks.load import STALE_CELL_S
from tester.kinds.wheel_on_belt.interlocks.motion import BELT_TORN
from tester.kinds.wheel_on_belt.interlocks.surface import STALE_IR_S
from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.kinds.wheel_on_belt.rig.loop_sections import GatesConfig, LoopsConfig
from tester.kinds.wheel_on_belt.rig.sections import (
    HAND_C,
    HARMFUL_N,
    VELOCITY_AXES,
    ArmingConfig,
    AxesConfig,
    CertificatesConfig,
    GeometryConfig,
    InterlocksConfig,
    LimitsConfig,
    ObserverConfig,
    WearConfig,
)
from tester.machine.interlock_table import InterlockTable

EQUAL_SIZES = 0.05
"""The same size in two sections may differ by this share: a wheel is ground before it is mounted [A]."""
BEYOND = 0.5
"""Software limits may be wider than what the machine needs by this share of it, to either side [A]."""
ANGLE_DEG = 10.0
"""Range of a positioned axis to either side that is never too wide, deg [A]."""
EQUAL_DECELERATIONS = 0.05
"""Wheel and belt must decelerate alike, in m/s2, within this share [A]: otherwise one stops before the other."""

_Found = Iterator[tuple[Location, str]]


def _speeds(rig: RigConfig) -> _Found:
    """Yield drives that cannot follow the rig's limits or loops: they would silently run slower than commanded."""
    wheel = rig.axes.wheel.max_speed * 0.5e-3 * rig.geometry.wheel_diameter_mm
    if wheel < rig.limits.wheel_speed_m_s:
        yield ("axes", "wheel", "max_speed"), f"gives {wheel:.3f} m/s, less than limits.wheel_speed"
    if rig.axes.belt.max_speed < rig.limits.belt_speed_m_s:
        yield ("axes", "belt", "max_speed"), f"{rig.axes.belt.max_speed:g} m/s is less than limits.belt_speed"
    if rig.loops.load.lift_speed_mm_s > rig.axes.press.max_speed:
        yield ("loops", "load", "lift_speed"), "is above axes.press.max_speed"
    if rig.loops.load.acceleration_mm_s2 > min(rig.axes.press.acceleration, rig.axes.press.deceleration):
        yield ("loops", "load", "acceleration"), "is above what axes.press can follow"


def _decelerations(rig: RigConfig) -> _Found:
    radius_m = 0.5e-3 * rig.geometry.wheel_diameter_mm
    for key in ("deceleration", "quick_stop_deceleration"):
        wheel = float(getattr(rig.axes.wheel, key)) * radius_m
        belt = float(getattr(rig.axes.belt, key))
        if abs(wheel - belt) > EQUAL_DECELERATIONS * belt:
            message = f"wheel {wheel:.3g} m/s2 at the rim, belt {belt:.3g} m/s2: they must be equal within 5 %"
            yield ("axes", "wheel", key), message


def _units(rig: RigConfig) -> _Found:
    due = VELOCITY_AXES | {axis.name: axis.recipe_unit for axis in POSITIONED}
    for name, axis in rig.axes.driven().items():
        if axis.unit != due[name]:
            yield ("axes", name, "unit"), f"the {name} axis is in {due[name]}, not {axis.unit}"
        mode = "velocity" if name in VELOCITY_AXES else "position"
        if axis.mode != mode:
            yield ("axes", name, "mode"), f"the {name} axis is driven by {mode}, not by {axis.mode}"
        feedback = "velocity" if name in ("wheel", "belt") else "position"
        if axis.feedback != feedback:
            yield ("axes", name, "feedback"), f"the {name} axis reports its {feedback}, not its {axis.feedback}"
    if not rig.axes.press.digital_io:
        yield ("axes", "press", "digital_io"), "the press drive carries the safety chain's inputs (expected true)"
    if rig.interlocks.stale_inputs_s < 2.0 * rig.axes.press.inputs_period_s:
        message = "is less than two of axes.press.inputs_period: a single lost frame would stop the rig"
        yield ("interlocks", "stale_inputs"), message


NEED_TORQUE: Final = {"wheel": (SHAFT_POWER, BELT_TORN), "belt": (SHAFT_POWER, BELT_TORQUE, BELT_CAUGHT)}
"""Interlocks that watch an axis' torque."""
STEP_MM_S: Final = 1.0
"""Greatest step of a frequency inverter's speed at the contact [A]: slip is asked for within 3 mm/s, and target and
reading of each of two axes are off by half a step."""


def _inverters(rig: RigConfig) -> _Found:
    """Yield what a frequency inverter does not report, or too coarsely."""
    for name, metres in (("wheel", 0.5e-3 * rig.geometry.wheel_diameter_mm), ("belt", 1.0)):
        axis = rig.axes.driven()[name]
        if not axis.drive.inverter:
            continue
        if not axis.drive.torque:
            needed = ", ".join(row.name for row in NEED_TORQUE[name])
            yield ("axes", name, "profile"), f"{axis.drive.title} reports no torque (0x6077), as needed for {needed}"
        step = 1e3 * metres / axis.velocity_increments
        if step > STEP_MM_S:
            message = f"a count of 0x6042 is {step:.3g} mm/s at the contact (expected {STEP_MM_S:g} mm/s at most)"
            yield ("axes", name, "velocity_increments"), f"{message}: more motor turns, or target_rpm below 1"


def _sizes(rig: RigConfig) -> _Found:
    """Yield sizes of the wheel that two sections state differently, and software limits that the machine belies."""
    wheel, geometry = rig.observer.wheel, rig.geometry
    for key, believed, mm in (
        ("outer_diameter", wheel.outer_diameter, geometry.wheel_diameter_mm),
        ("width", wheel.width, geometry.wheel_width_mm),
    ):
        if abs(believed - mm) > EQUAL_SIZES * mm:
            name = f"geometry.wheel_{key.removeprefix('outer_')}"
            yield ("observer", "wheel", key), f"{believed:g} mm, and {name} is {mm:g} mm: expected within 5 %"
    widest = {"press": (0.0, geometry.touch_mm + wheel.rubber_layer)}
    # A smaller limit of the recipes' angles changes no machine.
    widest |= {name: (-max(limit, ANGLE_DEG), max(limit, ANGLE_DEG)) for name, limit in rig.limits.positions().items()}
    for name, axis in rig.axes.driven().items():
        if name in widest and axis.software_limits is not None:
            (low, high), (first, last) = axis.software_limits, widest[name]
            room = BEYOND * (last - first)
            if low < first - room or high > last + room:
                expected = f"{first - room:g} to {last + room:g}: what the machine needs, and half as much"
                yield ("axes", name, "software_limits"), f"{low:g} to {high:g} (expected within {expected})"


def _press(rig: RigConfig) -> _Found:
    problem = torque_problem(rig)
    if problem:
        yield ("axes", "press", "screw"), problem
    screw, limits = rig.axes.press.screw, rig.axes.press.software_limits
    if screw is not None and limits is not None and screw.spring_n and not screw.lifts_n(limits[0]) > 0.0:
        # "press spring" compares a share of this force.
        message = f"leaves the spring without force at {limits[0]:g} mm (axes.press.software_limits)"
        yield ("axes", "press", "screw", "spring_rate"), message


def _skew(rig: RigConfig) -> _Found:
    needed = rig.own["load_cell"].channels
    yield from skew_problem(rig, needed, rig.interlocks.cell_skew_s)


def _heat_off(rig: RigConfig) -> _Found:
    """Check that the heat ends without this program: by a lease, or by the substitute that the file names."""
    for name, device in rig.devices.items():
        if device.heat_off and (name != "jacket" or device.heat_off not in HEAT_OFF):
            expected = "it is the jacket's" if name != "jacket" else f"expected {' or '.join(HEAT_OFF)}"
            yield ("devices", name, "heat_off"), f"{device.heat_off} ({expected})"
    jacket = rig.devices.get("jacket")
    try:
        profile = profile_of(jacket.profile) if jacket is not None else None
    except ProfileError:
        return  # another check reports it
    if jacket is None or profile is None or rig.simulated or "lease" in profile.writes:
        return
    if jacket.heat_off == "fallback" and profile.falls_back_s is None:
        message = f"{profile.title} has no setpoint of its own that it falls back to (falls_back_s): expected relay"
        yield ("devices", "jacket", "heat_off"), message
    elif not jacket.heat_off:
        ways = "; ".join(f"{key}: {words}" for key, words in HEAT_OFF.items())
        message = f"{profile.title} has no lease: it heats on when the PC is silent. Say by heat_off what ends that"
        yield ("devices", "jacket"), f"{message} ({ways})"


def _temperatures(rig: RigConfig) -> _Found:
    heat = rig.loops.heat
    if heat.hub_max_c > rig.limits.jacket_c:
        yield ("loops", "heat", "hub_max"), f"{heat.hub_max_c:g} degC is above limits.jacket"
    if heat.hub_min_c >= heat.hub_max_c:
        yield ("loops", "heat", "hub_min"), "is not below hub_max"
    if rig.limits.tool_hub_c > max(rig.interlocks.cooldown_hub_c, HAND_C):
        message = f"{rig.limits.tool_hub_c:g} degC is above interlocks.cooldown_hub: the wheel would stand, and bake"
        yield ("limits", "tool_hub"), message


RIPPLE_N: Final = 10.0
"""Peak-to-peak load variation from the tread's runout with the press at rest, N [A]: 7 to 10 N at 200 to 400 N."""


def with_torque_limit(rig: RigConfig) -> RigConfig:
    """Return a rig with its press drive's torque limited to that for ``limits.load``, or to the file's lower value.

    A press without ``screw`` keeps the file's value: the effect of its torque is unknown.
    """
    press = rig.axes.press
    if press.screw is None:
        return rig
    worn_mm = rig.geometry.touch_at_mm(rig.interlocks.least_diameter_mm)
    needed = ceil(1000.0 * press.screw.torque_nm(rig.limits.load_n, worn_mm) / press.rated_torque_nm)
    limited = replace(press, max_torque_per_mille=min(press.max_torque_per_mille, needed))
    return replace(rig, axes=replace(rig.axes, press=limited))


def torque_problem(rig: RigConfig) -> str:
    """Return why the limit of the press's torque is unsuitable, or ""; the rig comes from ``with_torque_limit``."""
    press = rig.axes.press
    if press.screw is None:
        return ""
    torque_nm = 1e-3 * press.max_torque_per_mille * press.rated_torque_nm
    most_n = press.screw.pushed_n(torque_nm, rig.geometry.touch_mm)
    least_n = press.screw.reached_n(torque_nm, rig.geometry.touch_at_mm(rig.interlocks.least_diameter_mm))
    if most_n + RIPPLE_N > HARMFUL_N:
        return (
            f"{torque_nm:.3f} N m (0x6072), which {rig.limits.load_n:g} N take with the most friction, press with"
            f" {most_n:.0f} N with the least, and {RIPPLE_N:g} N of runout make that more than {HARMFUL_N:g} N:"
            " lower limits.load, or narrow down efficiency and drag"
        )
    if least_n < rig.limits.load_n:
        return (
            f"{torque_nm:.3f} N m (max_torque_per_mille) surely press with {least_n:.0f} N only, limits.load is"
            f" {rig.limits.load_n:g} N: lower the one or raise the other"
        )
    return ""


@dataclass(frozen=True, slots=True, kw_only=True)
class RigConfig(Rig):
    """A rig: everything that the software must know about the machine, and nothing about a test."""

    packaged: ClassVar[Mapping[str, str]] = KIND.rigs
    may_lack: ClassVar[tuple[str, ...]] = (
        *Rig.may_lack,
        "axes.*.rpdo_deadline",
        "axes.*.speed_zero",
        "axes.*.inputs_period",
        "axes.*.max_torque_per_mille",
        "axes.*.home_timeout",
        "devices.*.emissivity",
        "loops",
        "gates",
        "interlocks",
        "arming",
        "wear",
        "limits.tool_hub",
        "observer.friction_heat_fraction",
        "observer.belt_conductance",
        "observer.thermal",
    )
    stated: ClassVar[tuple[str, ...]] = ("observer.wheel",)
    manual: ClassVar[tuple[str, ...]] = tuple(axis.name for axis in POSITIONED)
    own: ClassVar[Mapping[str, OwnDevice]] = {
        "load_cell": OwnDevice("load cell", "load_cell", channels=("fx", "fy", "fz"), joined=True, stale=STALE_CELL_S),
        "jacket": OwnDevice("jacket", "jacket", stale=STALE_JACKET_S),
        "ir_thermometer": OwnDevice("infrared thermometer", "ir_thermometer", stale=STALE_IR_S, shown="thermometer"),
    }
    quantities: ClassVar[Quantities] = QUANTITIES
    table: ClassVar[InterlockTable] = TABLE
    """The interlock rows that control evaluates; a laboratory's own kind may have more."""
    parameters: ClassVar[tuple[Parameter, ...]] = TABLE.parameters
    watched: ClassVar[tuple[str, ...]] = TABLE.channels
    real: ClassVar[tuple[tuple[str, str], ...]] = (
        ("the estimates and the thermal interlocks believe of the wheel. The simulated wheel behaves by `sim`\n",
         "the estimates and the thermal interlocks believe of the wheel. All [A].\n"),
        ("# below, so a wrong belief can be tried out: --set observer.friction_heat_fraction=0.2. All [A].\n", ""),
        ("    profile: simulated_jacket       #",
         "    heat_off: fallback              # [A] it has no lease; try it out: hub warm, cable off. Else: relay\n"
         "    profile: eurotherm_3200         #"),
        ("# air around a real rig; the simulated rig's is sim.ambient", "# air around the rig"),
    )  # fmt: skip

    geometry: GeometryConfig
    limits: LimitsConfig
    axes: AxesConfig
    loops: LoopsConfig
    gates: GatesConfig
    interlocks: InterlocksConfig
    arming: ArmingConfig
    wear: WearConfig
    observer: ObserverConfig
    calibration: CertificatesConfig = field(default_factory=CertificatesConfig)
    sim: Annotated[SimParameters, NOT_REAL] = field(default_factory=SimParameters)
    """The simulated rig's physics; unused on a real rig."""

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC: of the simulated rig's air, else as the file states it."""
        return self.sim.ambient if self.simulated else self.observer.ambient_c

    def in_air(self, ambient_c: float) -> RigConfig:
        """Return the rig with this temperature of the air around a real machine, degC, in its file."""
        return replace(self, observer=replace(self.observer, ambient_c=ambient_c))

    def drives(self) -> Mapping[str, AxisConfig]:
        """Return the axes that have a drive, by name."""
        return self.axes.driven()

    def settled(self) -> RigConfig:
        """Return the rig with the limit of the press's torque."""
        return with_torque_limit(self)

    def problems(self) -> Iterator[tuple[Location, str]]:
        """Yield inconsistencies between the kind's sections, with their places."""
        for check in (_speeds, _decelerations, _units, _inverters, _sizes, _press, _temperatures, _skew, _heat_off):
            yield from check(self)
