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
from tester.inputs.rig.config import PAPER, CalibrationConfig, section_of
from tester.inputs.rig.key_classes import HIGHER, LOWER, TRUE, Bounded, Free, Held, Inside
from tester.inputs.rig.plain_rig import LISTEN, WITHHOLD
from tester.inputs.rig.section_classes import AXIS, WATCHDOG_PROOF
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS
from tester.kinds.wheel_on_belt.rig.axis_classes import BELT, PRESS, WHEEL
from tester.kinds.wheel_on_belt.rig.loop_sections import HUB

HARMFUL_N: Final = 500.0
"""A force on the wheel from this value up counts as harm (sim.harm)."""

VELOCITY_AXES: Final = {"wheel": "rad/s", "belt": "m/s", "press": "mm/s"}
"""The drives of every rig of the kind, with their units; each other drive positions an axis (``axes.POSITIONED``)."""

_POSITIVE = Range(gt=0.0)
_NOT_NEGATIVE = Range(ge=0.0)


@dataclass(frozen=True, slots=True)
class GeometryConfig:
    """Sizes of the machine."""

    wheel_diameter_mm: Annotated[
        float, "mm", _POSITIVE, Held("observer.wheel, the ramps of wheel and belt, and the place of each first contact")
    ]
    """Outer diameter of a new wheel, at ``wear.reference``."""
    wheel_width_mm: Annotated[float, "mm", _POSITIVE, Held("observer.wheel.width")]
    belt_roller_diameter_mm: Annotated[
        float, "mm", _POSITIVE, Held("friction: the belt drive's torque is compared with it in every contact")
    ]
    touch_mm: Annotated[float, "mm", _POSITIVE, Held("the place of each first contact")]
    """Press travel from fully lifted to touching a new wheel."""

    def touch_at_mm(self, diameter_mm: float) -> float:
        """Return the press travel to touching a wheel of another diameter."""
        return self.touch_mm + 0.5 * (self.wheel_diameter_mm - diameter_mm)


def _with(base: type, further: Iterable[tuple[str, object]]) -> Any:
    """Return a section with further fields for the positioned axes."""
    name = base.__name__.removeprefix("_")
    namespace = {"__module__": __name__, "__doc__": base.__doc__}
    return make_dataclass(name, list(further), bases=(base,), frozen=True, slots=True, namespace=namespace)


_RUNAWAY: Final = Bounded(
    LOWER, "1.5 m/s",
    "a drive that does not stop loses its power after 2.5 s: no later step of a stop",
)  # fmt: skip


HAND_C: Final = 45.0
"""A hub that a hand may touch, degC [A]."""


@dataclass(frozen=True, slots=True)
class _LimitsConfig:
    """Hard limits: no recipe and no loop exceeds them."""

    load_n: Annotated[
        float, "N", Range(gt=0.0, le=HARMFUL_N),
        Bounded(LOWER, "450 N", "the press still comes for some 50 ms after the trip: harm begins at 500 N"),
    ]  # fmt: skip
    """At most 500 N: above it is harm (docs/kinds/wheel-on-belt.md)."""
    wheel_speed_m_s: Annotated[float, "m/s", _POSITIVE, _RUNAWAY]
    belt_speed_m_s: Annotated[float, "m/s", _POSITIVE, _RUNAWAY]
    slip_power_w: Annotated[
        float, "W", _POSITIVE,
        Bounded(LOWER, "400 W", "16 N m of rated torque at 25 rad/s"),
    ]  # fmt: skip
    jacket_c: Annotated[float, "degC", Range(gt=0.0, le=155.0), HUB]
    """At most 155 degC: above it is harm (docs/kinds/wheel-on-belt.md)."""
    surface_c: Annotated[
        float, "degC", Range(gt=0.0, le=130.0),
        Bounded(LOWER, "100 degC", "the contact is some 20 K hotter than the surface [A]; harm begins at 130 degC"),
    ]  # fmt: skip
    """At most 130 degC: above it is harm (docs/kinds/wheel-on-belt.md)."""

    tool_hub_c: Annotated[
        float, "degC", Range(gt=0.0, le=80.0),
        Bounded(LOWER, "45 degC", "a hand may slip off the tool: a hub of 45 degC does not burn it [A]"),
    ]  # fmt: skip
    """Hub temperature below which a person may reach a wheel with a tool (a recipe's step with ``by_tool``).

    At most 80 degC: a wheel at rest is baked on one side, as for ``interlocks.cooldown_hub``.
    """

    def positions(self) -> dict[str, float]:
        """Return the limits of the positioned axes to either side, by name."""
        return {axis.name: getattr(self, axis.field) for axis in POSITIONED}


@dataclass(frozen=True, slots=True)
class _AxesConfig:
    """The drives; None for an axis that is set by hand (``manual: true`` in the file)."""

    wheel: Annotated[AxisConfig, Inside(WHEEL)]
    belt: Annotated[AxisConfig, Inside(BELT)]
    press: Annotated[AxisConfig, Inside(PRESS)]

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
    _LIMITS = (
        (
            axis.field,
            Annotated[
                float, axis.recipe_unit, Range(ge=0.0, le=axis.most), Bounded(LOWER, axis.hardest, axis.because)
            ],
        )
        for axis in POSITIONED
    )  # fmt: skip
    LimitsConfig = _with(_LimitsConfig, _LIMITS)
    AxesConfig = _with(_AxesConfig, ((axis.name, Annotated[AxisConfig | None, Inside(AXIS)]) for axis in POSITIONED))


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

    listen_s: Annotated[float, "s", _NOT_NEGATIVE, LISTEN]
    """Time of listening before anything is sent, to detect another master on the bus."""
    bump_test: Annotated[
        bool, Bounded(HIGHER, TRUE, "without it wheel and belt may be exchanged, or turn the wrong way")
    ]
    """Turn wheel and belt a little, one after the other: each must follow alone."""
    watchdog_proof: Annotated[bool, WATCHDOG_PROOF]
    """Withhold the PC's heartbeat with the drives enabled and creeping: every drive must report it and stop."""
    withhold_s: Annotated[float, "s", _POSITIVE, WITHHOLD]
    creep_m_s: Annotated[
        float, "m/s", _POSITIVE, Bounded(LOWER, "0.1 m/s", "nothing is proven yet: a wheel turns once in three seconds")
    ]
    """Speed of wheel and belt, unloaded, in the bump test and in the watchdog proof."""
    unloaded_n: Annotated[
        float, "N", Range(gt=0.0, le=50.0),
        Bounded(LOWER, "30 N", "with 450 N, the greatest load, it is 480 N; harm begins at 500 N"),
    ]  # fmt: skip
    """Greatest normal force and friction of an unloaded cell without tare, at connecting and at a reference tare.

    At most 50 N: a greater contact force must not be taken for the cell's zero.
    """
    standstill_relay: Annotated[
        bool, Held("the commissioning, which halts wheel and belt; a run names the contacts that only it holds")
    ]
    """A relay takes the torque off wheel and belt, without this program, once one stands and the other turns."""


_WEAR: Final = Held("the place of each touch, and a caliper in a wear check")
_BUDGET: Final = Held("certificates and repeated checks; nothing moves by it, the budget names it")


@dataclass(frozen=True, slots=True)
class WearConfig:
    """Wear law V = k F s, for the plan's predictions and the current diameter.

    The section also has the parameters of a diameter check (procedures.wear_check); uncertainties are standard.
    """

    rate_mm3_per_n_m: Annotated[float, "mm3/(N m)", _NOT_NEGATIVE, _WEAR]
    growth_mm_per_k: Annotated[float, "mm/K", _NOT_NEGATIVE, _WEAR]
    """Growth of the diameter, rubber and hub together, per K of the rubber's mean temperature."""
    reference_c: Annotated[float, "degC", Range(ge=0.0, le=40.0), _WEAR]
    """Temperature of cold diameters: of a new wheel, of every check and of the record."""
    growth_uncertainty_mm_per_k: Annotated[float, "mm/K", _NOT_NEGATIVE, _BUDGET]
    check_press_mm: Annotated[float, "mm", _NOT_NEGATIVE, _BUDGET]
    """Uncertainty of the press's position in a roll check, without the effects of load and heat."""
    check_load_n: Annotated[float, "N", _NOT_NEGATIVE, _BUDGET]
    """Uncertainty of the mean load in a roll check, between checks."""
    check_stiffness_percent: Annotated[float, "%", _NOT_NEGATIVE, _BUDGET]
    """Uncertainty of the contact's stiffness, which corrects for a load off its nominal value."""
    check_rubber_k: Annotated[float, "K", _NOT_NEGATIVE, _BUDGET]
    """Uncertainty of the rubber's mean temperature, taken as half hub and half surface."""
    gauge_mm: Annotated[float, "mm", _NOT_NEGATIVE, _BUDGET]
    """Uncertainty of a diameter that a person measures on rubber."""
    rate_uncertainty_percent: Annotated[float, "%", _NOT_NEGATIVE, _BUDGET]
    """Uncertainty of a wear rate from load, slip and width of the tread."""

    def growth_mm(self, rubber_c: float) -> float:
        """Return the growth over the cold diameter, mm, at a mean temperature of the rubber, degC."""
        return self.growth_mm_per_k * (rubber_c - self.reference_c)


@dataclass(frozen=True, slots=True)
class CertificatesConfig(CalibrationConfig):
    """The sensors that have a certificate, and the load cell's calibration with hung weights."""

    certificates: ClassVar[tuple[str, ...]] = ("load_cell", "thermometer", "jacket")

    load_cell: Annotated[str, PAPER] = ""
    thermometer: Annotated[str, PAPER] = ""
    jacket: Annotated[str, PAPER] = ""
    cell_sensitivity: Annotated[float, "1", Range(ge=0.0, le=0.05), PAPER] = 0.0
    """Measured error of Fx over Fz, with its standard uncertainty (commission.weights); 0: not in the budget."""
    record: Annotated[str, PAPER] = ""
    """Name of the entry with that value: the SHA-256 of the step ``cell`` in the record of the commissioning."""


_MODEL: Final = Held("the thermometer: a surface off the model trips (interlocks.model)")
_HEATED: Final = Held(
    "the heat put in: a heating off by more than 30 % is no evidence, and hides a sensor's drift", within=0.3
)


@dataclass(frozen=True, slots=True)
class ObserverConfig:
    """Assumed thermal behaviour of the wheel, for the heat loop, the estimates and the thermal interlocks.

    The simulated wheel has parameters of its own (``sim``), so that a wrong belief can be tested.
    """

    ambient_c: Annotated[
        float, "degC", Range(ge=-40.0, le=60.0), Free("60 K off they are 9 W of the heat that the shaft takes")
    ]
    """Air temperature around a real rig; a simulated rig has its own (``RigConfig.ambient_c``)."""
    friction_heat_fraction: Annotated[float, "1", Range(ge=0.0, le=1.0), _MODEL]
    """The rubber's share of friction heat."""
    belt_conductance: Annotated[float, "W/K", _NOT_NEGATIVE, _MODEL]
    """Thermal conductance from rubber to belt, in contact."""
    wheel: Annotated[WheelParameters, _HEATED]
    thermal: Annotated[ThermalParameters, _HEATED]
