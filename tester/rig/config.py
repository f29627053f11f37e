"""What a rig file says, as frozen dataclasses. Units are in the names; keys in the file have none (config_reader).

Nothing here has a default: a limit never comes from the program, always from a file that a person can read. The
numbers and their sources stand in the packaged file of the simulated rig, ``sim/rig.yaml``. Only the section
``interlocks`` is declared elsewhere, each key beside the interlock that it belongs to (tester.interlocks): a key that a
file lacks takes the packaged value, and ``tester check`` says which.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, make_dataclass
from datetime import date
from typing import TYPE_CHECKING, Annotated, Final, Literal

from drivers.axis import AxisConfig
from sim.parameters import SimParameters, ThermalParameters, WheelParameters
from tester.config_reader import Range, as_text, as_tree
from tester.interlocks.parameter import Values
from tester.interlocks.table import PARAMETERS

HARMFUL_N: Final = 500.0
"""From here on a force on the wheel counts as harm (sim.harm)."""

_POSITIVE = Range(gt=0.0)
_NOT_NEGATIVE = Range(ge=0.0)
_SHARE = Range(gt=0.0, le=1.0)


@dataclass(frozen=True, slots=True)
class GeometryConfig:
    """Sizes of the machine."""

    wheel_diameter_mm: Annotated[float, "mm", _POSITIVE]
    """Outer diameter of a new wheel, at ``wear.reference``."""
    wheel_width_mm: Annotated[float, "mm", _POSITIVE]
    belt_roller_diameter_mm: Annotated[float, "mm", _POSITIVE]
    touch_mm: Annotated[float, "mm", _POSITIVE]
    """Press travel from fully lifted to touching a new wheel."""


@dataclass(frozen=True, slots=True)
class LimitsConfig:
    """Hard limits: no recipe and no loop gets past them."""

    load_n: Annotated[float, "N", Range(gt=0.0, le=HARMFUL_N)]
    """At most 500 N: above it docs/safety.md counts harm."""
    wheel_speed_m_s: Annotated[float, "m/s", _POSITIVE]
    belt_speed_m_s: Annotated[float, "m/s", _POSITIVE]
    slip_power_w: Annotated[float, "W", _POSITIVE]
    jacket_c: Annotated[float, "degC", Range(gt=0.0, le=155.0)]
    """At most 155 degC: above it docs/safety.md counts harm."""
    surface_c: Annotated[float, "degC", Range(gt=0.0, le=130.0)]
    """At most 130 degC: above it docs/safety.md counts harm."""
    sideslip_deg: Annotated[float, "deg", Range(ge=0.0, le=45.0)]
    camber_deg: Annotated[float, "deg", Range(ge=0.0, le=45.0)]


@dataclass(frozen=True, slots=True)
class ScanConfig:
    """Scan rates: while sliding or moving, while any drive is enabled, with all drives disabled."""

    sliding_hz: Annotated[float, "Hz", Range(gt=0.0, le=200.0)]
    enabled_hz: Annotated[float, "Hz", Range(gt=0.0, le=200.0)]
    idle_hz: Annotated[float, "Hz", Range(gt=0.0, le=200.0)]


@dataclass(frozen=True, slots=True)
class CanConfig:
    """The drives' bus. ``interface`` is "sim" or a python-can interface; ``node`` is the PC's own."""

    interface: str
    channel: str
    bitrate: Literal[125000, 250000, 500000, 800000, 1000000]
    node: int
    heartbeat_s: Annotated[float, "s", _POSITIVE]
    """The PC's heartbeat period."""
    drive_heartbeat_s: Annotated[float, "s", _POSITIVE]
    """The drives' heartbeat period (0x1017)."""
    consumer_heartbeat_s: Annotated[float, "s", _POSITIVE]
    """How long a drive waits for the PC's heartbeat before it stops (0x1016)."""


@dataclass(frozen=True, slots=True)
class AxesConfig:
    """The drives; None for an axis that is set by hand (``manual: true`` in the file)."""

    wheel: AxisConfig
    belt: AxisConfig
    press: AxisConfig
    sideslip: AxisConfig | None
    camber: AxisConfig | None

    def driven(self) -> dict[str, AxisConfig]:
        """Return the axes that have a drive, by name."""
        axes = {
            "wheel": self.wheel,
            "belt": self.belt,
            "press": self.press,
            "sideslip": self.sideslip,
            "camber": self.camber,
        }
        return {name: axis for name, axis in axes.items() if axis is not None}


@dataclass(frozen=True, slots=True)
class LineConfig:
    """One Modbus line: a serial port, ``host:port`` (framing "socket"), or "sim"."""

    port: str
    baud: int
    parity: Literal["N", "E", "O"]
    framing: Literal["rtu", "socket"]


@dataclass(frozen=True, slots=True)
class DeviceConfig:
    """One Modbus device: its profile in drivers/profiles, its line and its address there."""

    profile: str
    line: str
    unit_id: int


@dataclass(frozen=True, slots=True)
class IrThermometerConfig:
    """The infrared thermometer on the rubber surface."""

    profile: str
    line: str
    unit_id: int
    emissivity: Annotated[float, "1", Range(ge=0.1, le=1.0)]


@dataclass(frozen=True, slots=True)
class DevicesConfig:
    """The measuring and heating devices."""

    load_cell: DeviceConfig
    jacket: DeviceConfig
    ir_thermometer: IrThermometerConfig


@dataclass(frozen=True, slots=True)
class LoadLoopConfig:
    """Press control: approach, touch, hold (tester.control.load_loop)."""

    bandwidth_hz: Annotated[float, "Hz", _POSITIVE]
    rolling_bandwidth_hz: Annotated[float, "Hz", _POSITIVE]
    """While holding in band: too slow to chase the wheel's runout."""
    error_filter_s: Annotated[float, "s", _POSITIVE]
    """The load error is averaged over this time before it decides between the two bandwidths."""
    stiffness_n_per_mm: Annotated[float, "N/mm", _POSITIVE]
    """Tangent stiffness of the contact at 200 N."""
    integral_s: Annotated[float, "s", _POSITIVE]
    touch_load_n: Annotated[float, "N", _POSITIVE]
    open_share: Annotated[float, "1", _SHARE]
    """Below this share of the touching force the contact was seen open: only then is the next touch a first one."""
    follow_rate_n_s: Annotated[float, "N/s", _POSITIVE]
    """A change of load is expected to be followed at this rate at least: what the load is watched against."""
    touch_speed_mm_s: Annotated[float, "mm/s", _POSITIVE]
    loading_speed_mm_s: Annotated[float, "mm/s", _POSITIVE]
    lift_speed_mm_s: Annotated[float, "mm/s", _POSITIVE]
    acceleration_mm_s2: Annotated[float, "mm/s2", _POSITIVE]
    """Profiles to a position are planned with it: at most ``axes.press.acceleration``, which is what a lift takes."""
    clearance_mm: Annotated[float, "mm", _POSITIVE]
    """Lifted means this far off the last contact."""


@dataclass(frozen=True, slots=True)
class HeatLoopConfig:
    """Outer heat loop: surface error to hub setpoint (tester.control.heat_loop)."""

    outer_gain: Annotated[float, "1", _NOT_NEGATIVE]
    """Kelvin of hub setpoint per kelvin of surface error."""
    outer_integral_s: Annotated[float, "s", _POSITIVE]
    integral_band_k: Annotated[float, "K", _POSITIVE]
    """The integral moves only inside this error."""
    integral_limit_k: Annotated[float, "K", _NOT_NEGATIVE]
    hub_min_c: Annotated[float, "degC"]
    hub_max_c: Annotated[float, "degC"]
    period_s: Annotated[float, "s", _POSITIVE]
    rolling_offset_k: Annotated[float, "K", _NOT_NEGATIVE]
    """While rolling between slip pulses the target is this much below the setpoint."""


@dataclass(frozen=True, slots=True)
class LoopsConfig:
    """Gains and times of the loops."""

    load: LoadLoopConfig
    heat: HeatLoopConfig


@dataclass(frozen=True, slots=True)
class GatesConfig:
    """When a sample counts (tester.engine.gates)."""

    load_percent: Annotated[float, "%", _POSITIVE]
    load_filter_s: Annotated[float, "s", _POSITIVE]
    speed_percent: Annotated[float, "%", _POSITIVE]
    slip_percent: Annotated[float, "%", _POSITIVE]
    slip_floor_mm_s: Annotated[float, "mm/s", _NOT_NEGATIVE]
    slip_filter_s: Annotated[float, "s", _POSITIVE]
    ir_lag_s: Annotated[float, "s", _NOT_NEGATIVE]
    contact_transient_s: Annotated[float, "s", _NOT_NEGATIVE]


if TYPE_CHECKING:

    @dataclass(frozen=True, slots=True)
    class InterlocksConfig:
        """The section ``interlocks``: a field for each parameter of the interlock table (tester.interlocks)."""

        def __getattr__(self, name: str) -> float:
            """Return a parameter's value in its unit, by the name of its field (``Parameter.name``)."""
            ...

else:
    InterlocksConfig = make_dataclass(
        "InterlocksConfig",
        [(one.name, Annotated[float, one.unit, one.bounds], field(default=one.value)) for one in PARAMETERS],
        frozen=True,
        slots=True,
        namespace={"__module__": __name__, "__doc__": "The section interlocks; a missing key has its default."},
    )


def interlock_values(section: InterlocksConfig) -> Values:
    """Return what a rig's section ``interlocks`` says, by parameter."""
    return {one: float(getattr(section, one.name)) for one in PARAMETERS}


@dataclass(frozen=True, slots=True)
class ArmingConfig:
    """What is shown before a run may move anything (tester.engine.arming)."""

    listen_s: Annotated[float, "s", _NOT_NEGATIVE]
    """Nothing is sent for this long at first: another master on the bus would be heard."""
    bump_test: bool
    """Turn wheel and belt a little, one after the other: each must follow, and only it."""
    watchdog_proof: bool
    """Withhold the PC's heartbeat with the drives enabled and creeping: every drive must report it and stop."""
    withhold_s: Annotated[float, "s", _POSITIVE]
    creep_m_s: Annotated[float, "m/s", _POSITIVE]
    """Wheel and belt, unloaded, in the bump test and in the proof."""
    unloaded_n: Annotated[float, "N", Range(gt=0.0, le=50.0)]
    """Normal force and friction of an unloaded load cell without tare, at most: at connecting and at a reference tare.

    At most 50 N: a contact firmer than that must not pass for the cell's zero.
    """


@dataclass(frozen=True, slots=True)
class WearConfig:
    """Wear law V = k F s: what the plan predicts and the current diameter is estimated with.

    Then what a check of the diameter reckons with (tester.engine.wear_check); uncertainties are standard ones.
    """

    rate_mm3_per_n_m: Annotated[float, "mm3/(N m)", _NOT_NEGATIVE]
    growth_mm_per_k: Annotated[float, "mm/K", _NOT_NEGATIVE] = 0.0075
    """The diameter, rubber and hub together, grows by this per K of the rubber's mean temperature."""
    reference_c: Annotated[float, "degC", Range(ge=0.0, le=40.0)] = 23.0
    """At which a diameter is called cold: that of a new wheel, of every check and of the record."""
    growth_uncertainty_mm_per_k: Annotated[float, "mm/K", _NOT_NEGATIVE] = 0.0017
    check_press_mm: Annotated[float, "mm", _NOT_NEGATIVE] = 0.002
    """Of where the press stands in a roll check, beside what load and heat do."""
    check_load_n: Annotated[float, "N", _NOT_NEGATIVE] = 0.2
    """Of the mean load in a roll check, from one check to another."""
    check_stiffness_percent: Annotated[float, "%", _NOT_NEGATIVE] = 30.0
    """Of the contact's stiffness, with which a load off its nominal value is corrected."""
    check_rubber_k: Annotated[float, "K", _NOT_NEGATIVE] = 1.0
    """Of the rubber's mean temperature, taken as that of hub and surface by halves."""
    gauge_mm: Annotated[float, "mm", _NOT_NEGATIVE] = 0.05
    """Of a diameter that a person measures on rubber."""
    rate_uncertainty_percent: Annotated[float, "%", _NOT_NEGATIVE] = 1.5
    """Of a wear rate from load, slip and width of the tread."""

    def growth_mm(self, rubber_c: float) -> float:
        """Return what the diameter has gained over the cold one at a mean temperature of the rubber (degC), mm."""
        return self.growth_mm_per_k * (rubber_c - self.reference_c)


@dataclass(frozen=True, slots=True)
class CalibrationConfig:
    """The last days on which the certificates of the sensors hold, as 2027-01-31; "" is not known.

    Nothing is computed with them: the list before a start shows them.
    """

    load_cell: str = ""
    thermometer: str = ""
    jacket: str = ""

    def __post_init__(self) -> None:
        """Refuse what is no date."""
        self.ends()

    def ends(self) -> dict[str, date | None]:
        """Return the last day of each certificate; raises ValueError for a text that is no date."""
        texts = {"load cell": self.load_cell, "thermometer": self.thermometer, "jacket": self.jacket}
        return {name: _day(name, text) for name, text in texts.items()}


def _day(name: str, text: str) -> date | None:
    try:
        return date.fromisoformat(text) if text else None
    except ValueError:
        raise ValueError(f'{name}: expected a date such as 2027-01-31, or "", got "{text}"') from None


@dataclass(frozen=True, slots=True)
class ObserverConfig:
    """What software believes of the wheel's thermal behaviour: heat loop, estimates and thermal interlocks use it.

    The simulated wheel has parameters of its own (``sim``), so that a wrong belief can be tested.
    """

    ambient_c: Annotated[float, "degC", Range(ge=-40.0, le=60.0)]
    """The air around a real rig; a simulated one has its own (``RigConfig.ambient_c``)."""
    friction_heat_fraction: Annotated[float, "1", Range(ge=0.0, le=1.0)]
    """The rubber's share of friction heat."""
    belt_conductance: Annotated[float, "W/K", _NOT_NEGATIVE]
    """Rubber to belt, in contact."""
    wheel: WheelParameters
    thermal: ThermalParameters


@dataclass(frozen=True, slots=True)
class RigConfig:
    """A rig: everything about the machine that software needs to know, and nothing about a test."""

    rig: str
    """What the rig is called."""
    simulated: bool
    geometry: GeometryConfig
    limits: LimitsConfig
    scan: ScanConfig
    can: CanConfig
    axes: AxesConfig
    lines: Mapping[str, LineConfig]
    devices: DevicesConfig
    loops: LoopsConfig
    gates: GatesConfig
    interlocks: InterlocksConfig
    arming: ArmingConfig
    wear: WearConfig
    observer: ObserverConfig
    calibration: CalibrationConfig = field(default_factory=CalibrationConfig)
    sim: SimParameters = field(default_factory=SimParameters)
    """The simulated rig's physics; without meaning on a real one."""

    @property
    def name(self) -> str:
        """What the rig is called."""
        return self.rig

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC: of the simulated rig's air, else as the file states it."""
        return self.sim.ambient if self.simulated else self.observer.ambient_c

    @property
    def tree(self) -> dict[str, object]:
        """The configuration with everything resolved, as it could stand in a file."""
        return as_tree(self)

    @property
    def text(self) -> str:
        """The configuration with everything resolved, as YAML: what a run stores, and what ``load_rig`` reads back."""
        return as_text(self)
