"""The sections that only a rig of this kind has; the types check each section separately.

The numbers and their sources are in the packaged file of the simulated rig, ``sim/rig.yaml``. Each key of the section
``interlocks`` is declared beside its interlock.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields, make_dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Final

from drivers.axis import AxisConfig
from sim.physics.parameters import ThermalParameters, WheelParameters
from tester.base.config_reader import Range
from tester.inputs.rig.config import CalibrationConfig, section_of
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS

HARMFUL_N: Final = 500.0
"""A force on the wheel from this value up counts as harm (sim.harm)."""

VELOCITY_AXES: Final = {"wheel": "rad/s", "belt": "m/s", "press": "mm/s"}
"""The drives of every rig of the kind, with their units; each other drive positions an axis (``axes.POSITIONED``)."""

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

    def touch_at_mm(self, diameter_mm: float) -> float:
        """Return the press travel to touching a wheel of another diameter."""
        return self.touch_mm + 0.5 * (self.wheel_diameter_mm - diameter_mm)


def _with(base: type, further: Iterable[tuple[str, object]]) -> Any:
    """Return a section with further fields for the positioned axes."""
    name = base.__name__.removeprefix("_")
    namespace = {"__module__": __name__, "__doc__": base.__doc__}
    return make_dataclass(name, list(further), bases=(base,), frozen=True, slots=True, namespace=namespace)


@dataclass(frozen=True, slots=True)
class _LimitsConfig:
    """Hard limits: no recipe and no loop exceeds them."""

    load_n: Annotated[float, "N", Range(gt=0.0, le=HARMFUL_N)]
    """At most 500 N: above it is harm (docs/kinds/wheel-on-belt.md)."""
    wheel_speed_m_s: Annotated[float, "m/s", _POSITIVE]
    belt_speed_m_s: Annotated[float, "m/s", _POSITIVE]
    slip_power_w: Annotated[float, "W", _POSITIVE]
    jacket_c: Annotated[float, "degC", Range(gt=0.0, le=155.0)]
    """At most 155 degC: above it is harm (docs/kinds/wheel-on-belt.md)."""
    surface_c: Annotated[float, "degC", Range(gt=0.0, le=130.0)]
    """At most 130 degC: above it is harm (docs/kinds/wheel-on-belt.md)."""

    def positions(self) -> dict[str, float]:
        """Return the limits of the positioned axes to either side, by name."""
        return {axis.name: getattr(self, axis.field) for axis in POSITIONED}


@dataclass(frozen=True, slots=True)
class _AxesConfig:
    """The drives; None for an axis that is set by hand (``manual: true`` in the file)."""

    wheel: AxisConfig
    belt: AxisConfig
    press: AxisConfig

    def driven(self) -> dict[str, AxisConfig]:
        """Return the axes that have a drive, by name."""
        axes: dict[str, AxisConfig | None] = {name: getattr(self, name) for name in (at.name for at in fields(self))}
        return {name: axis for name, axis in axes.items() if axis is not None}


if TYPE_CHECKING:

    class LimitsConfig(_LimitsConfig):
        """Limits, including those of each positioned axis."""

        def __getattr__(self, name: str) -> float:
            """Return the limit of a positioned axis, by the axis's field."""
            ...

    class AxesConfig(_AxesConfig):
        """Drives, including that of each positioned axis."""

        def __getattr__(self, name: str) -> AxisConfig | None:
            """Return the drive of a positioned axis, by the axis's name."""
            ...

else:
    _LIMITS = ((axis.field, Annotated[float, axis.recipe_unit, Range(ge=0.0, le=axis.most)]) for axis in POSITIONED)
    LimitsConfig = _with(_LimitsConfig, _LIMITS)
    AxesConfig = _with(_AxesConfig, ((axis.name, AxisConfig | None) for axis in POSITIONED))


@dataclass(frozen=True, slots=True)
class LoadLoopConfig:
    """Press control: approach, touch, hold (tester.kinds.wheel_on_belt.control.loops)."""

    bandwidth_hz: Annotated[float, "Hz", _POSITIVE]
    rolling_bandwidth_hz: Annotated[float, "Hz", _POSITIVE]
    """Bandwidth while holding in band: too slow to follow the wheel's runout."""
    error_filter_s: Annotated[float, "s", _POSITIVE]
    """Averaging time of the load error that decides between the two bandwidths."""
    stiffness_n_per_mm: Annotated[float, "N/mm", _POSITIVE]
    """Tangent stiffness of the contact at 200 N."""
    integral_s: Annotated[float, "s", _POSITIVE]
    touch_load_n: Annotated[float, "N", _POSITIVE]
    open_share: Annotated[float, "1", _SHARE]
    """Share of the touching force below which the contact was open: only then is the next touch a first touch."""
    follow_rate_n_s: Annotated[float, "N/s", _POSITIVE]
    """Least expected rate of following a change of load: the interlocks' limits of the load move at it."""
    touch_speed_mm_s: Annotated[float, "mm/s", _POSITIVE]
    loading_speed_mm_s: Annotated[float, "mm/s", _POSITIVE]
    lift_speed_mm_s: Annotated[float, "mm/s", _POSITIVE]
    acceleration_mm_s2: Annotated[float, "mm/s2", _POSITIVE]
    """Acceleration of profiles to a position: at most ``axes.press.acceleration``, which a lift uses."""
    clearance_mm: Annotated[float, "mm", _POSITIVE]
    """Distance of the lifted position from the last contact."""


@dataclass(frozen=True, slots=True)
class HeatLoopConfig:
    """Outer heat loop: surface error to hub setpoint (tester.kinds.wheel_on_belt.control.loops)."""

    outer_gain: Annotated[float, "1", _NOT_NEGATIVE]
    """Kelvin of hub setpoint per kelvin of surface error."""
    outer_integral_s: Annotated[float, "s", _POSITIVE]
    integral_band_k: Annotated[float, "K", _POSITIVE]
    """The integral changes only within this error."""
    integral_limit_k: Annotated[float, "K", _NOT_NEGATIVE]
    hub_min_c: Annotated[float, "degC"]
    hub_max_c: Annotated[float, "degC"]
    period_s: Annotated[float, "s", _POSITIVE]
    rolling_offset_k: Annotated[float, "K", _NOT_NEGATIVE]
    """Distance of the target below the setpoint while rolling between slip pulses."""


@dataclass(frozen=True, slots=True)
class LoopsConfig:
    """Gains and times of the loops."""

    load: LoadLoopConfig
    heat: HeatLoopConfig


@dataclass(frozen=True, slots=True)
class GatesConfig:
    """When a sample counts (tester.kinds.wheel_on_belt.procedures.gates)."""

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
        """The section ``interlocks``: a field for each parameter of the interlock table."""

        def __getattr__(self, name: str) -> float:
            """Return a parameter's value in its unit, by the name of its field (``Parameter.name``)."""
            ...

else:
    InterlocksConfig = section_of("InterlocksConfig", PARAMETERS, __name__)


@dataclass(frozen=True, slots=True)
class ArmingConfig:
    """The proofs before a run may move anything (tester.kinds.wheel_on_belt.procedures.arming)."""

    listen_s: Annotated[float, "s", _NOT_NEGATIVE]
    """Time of listening before anything is sent, to detect another master on the bus."""
    bump_test: bool
    """Turn wheel and belt a little, one after the other: each must follow alone."""
    watchdog_proof: bool
    """Withhold the PC's heartbeat with the drives enabled and creeping: every drive must report it and stop."""
    withhold_s: Annotated[float, "s", _POSITIVE]
    creep_m_s: Annotated[float, "m/s", _POSITIVE]
    """Speed of wheel and belt, unloaded, in the bump test and in the watchdog proof."""
    unloaded_n: Annotated[float, "N", Range(gt=0.0, le=50.0)]
    """Greatest normal force and friction of an unloaded cell without tare, at connecting and at a reference tare.

    At most 50 N: a greater contact force must not be taken for the cell's zero.
    """


@dataclass(frozen=True, slots=True)
class WearConfig:
    """Wear law V = k F s, for the plan's predictions and the current diameter.

    The section also has the parameters of a diameter check (procedures.wear_check); uncertainties are standard.
    """

    rate_mm3_per_n_m: Annotated[float, "mm3/(N m)", _NOT_NEGATIVE]
    growth_mm_per_k: Annotated[float, "mm/K", _NOT_NEGATIVE]
    """Growth of the diameter, rubber and hub together, per K of the rubber's mean temperature."""
    reference_c: Annotated[float, "degC", Range(ge=0.0, le=40.0)]
    """Temperature of cold diameters: of a new wheel, of every check and of the record."""
    growth_uncertainty_mm_per_k: Annotated[float, "mm/K", _NOT_NEGATIVE]
    check_press_mm: Annotated[float, "mm", _NOT_NEGATIVE]
    """Uncertainty of the press's position in a roll check, without the effects of load and heat."""
    check_load_n: Annotated[float, "N", _NOT_NEGATIVE]
    """Uncertainty of the mean load in a roll check, between checks."""
    check_stiffness_percent: Annotated[float, "%", _NOT_NEGATIVE]
    """Uncertainty of the contact's stiffness, which corrects for a load off its nominal value."""
    check_rubber_k: Annotated[float, "K", _NOT_NEGATIVE]
    """Uncertainty of the rubber's mean temperature, taken as half hub and half surface."""
    gauge_mm: Annotated[float, "mm", _NOT_NEGATIVE]
    """Uncertainty of a diameter that a person measures on rubber."""
    rate_uncertainty_percent: Annotated[float, "%", _NOT_NEGATIVE]
    """Uncertainty of a wear rate from load, slip and width of the tread."""

    def growth_mm(self, rubber_c: float) -> float:
        """Return the growth over the cold diameter, mm, at a mean temperature of the rubber, degC."""
        return self.growth_mm_per_k * (rubber_c - self.reference_c)


@dataclass(frozen=True, slots=True)
class CertificatesConfig(CalibrationConfig):
    """The sensors that have a certificate, and the load cell's calibration with hung weights."""

    certificates: ClassVar[tuple[str, ...]] = ("load_cell", "thermometer", "jacket")

    load_cell: str = ""
    thermometer: str = ""
    jacket: str = ""
    cell_sensitivity: Annotated[float, "1", Range(ge=0.0, le=0.05)] = 0.0
    """Measured error of Fx over Fz, with its standard uncertainty (commission.weights); 0: not in the budget."""
    record: str = ""
    """Name of the entry with that value: the SHA-256 of the step ``cell`` in the record of the commissioning."""


@dataclass(frozen=True, slots=True)
class ObserverConfig:
    """Assumed thermal behaviour of the wheel, for the heat loop, the estimates and the thermal interlocks.

    The simulated wheel has parameters of its own (``sim``), so that a wrong belief can be tested.
    """

    ambient_c: Annotated[float, "degC", Range(ge=-40.0, le=60.0)]
    """Air temperature around a real rig; a simulated rig has its own (``RigConfig.ambient_c``)."""
    friction_heat_fraction: Annotated[float, "1", Range(ge=0.0, le=1.0)]
    """The rubber's share of friction heat."""
    belt_conductance: Annotated[float, "W/K", _NOT_NEGATIVE]
    """Thermal conductance from rubber to belt, in contact."""
    wheel: WheelParameters
    thermal: ThermalParameters
