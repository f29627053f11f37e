"""A rig of this kind: its sections together, and the knowledge for reading its file (tester.inputs.rig.config)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import ClassVar

from drivers.axis import AxisConfig
from sim.physics.parameters import SimParameters
from tester.base.quantities import Quantities
from tester.base.source import Location
from tester.inputs.rig.ceilings import Ceiling
from tester.inputs.rig.config import OwnDevice, Rig
from tester.inputs.rig.parameter import Parameter
from tester.kinds.wheel_on_belt import KIND
from tester.kinds.wheel_on_belt.image.axes import POSITIONED
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.interlocks.table import TABLE
from tester.kinds.wheel_on_belt.rig.ceilings import CEILINGS
from tester.kinds.wheel_on_belt.rig.checks import problems_between
from tester.kinds.wheel_on_belt.rig.press import with_torque_limit
from tester.kinds.wheel_on_belt.rig.sections import (
    ArmingConfig,
    AxesConfig,
    CertificatesConfig,
    GatesConfig,
    GeometryConfig,
    InterlocksConfig,
    LimitsConfig,
    LoopsConfig,
    ObserverConfig,
    WearConfig,
)
from tester.machine.interlock_table import InterlockTable


@dataclass(frozen=True, slots=True, kw_only=True)
class RigConfig(Rig):
    """A rig: everything about the machine that software needs to know, and nothing about a test."""

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
        "observer.friction_heat_fraction",
        "observer.belt_conductance",
        "observer.thermal",
    )
    stated: ClassVar[tuple[str, ...]] = ("observer.wheel",)
    manual: ClassVar[tuple[str, ...]] = tuple(axis.name for axis in POSITIONED)
    own: ClassVar[Mapping[str, OwnDevice]] = {
        "load_cell": OwnDevice("load cell", "load_cell", channels=("fx", "fy", "fz"), joined=True),
        "jacket": OwnDevice("jacket", "jacket"),
        "ir_thermometer": OwnDevice("infrared thermometer", "ir_thermometer"),
    }
    quantities: ClassVar[Quantities] = QUANTITIES
    table: ClassVar[InterlockTable] = TABLE
    """The rows that control evaluates; a laboratory's own kind may have more."""
    parameters: ClassVar[tuple[Parameter, ...]] = TABLE.parameters
    watched: ClassVar[tuple[str, ...]] = TABLE.channels
    ceilings: ClassVar[tuple[Ceiling, ...]] = CEILINGS
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
    sim: SimParameters = field(default_factory=SimParameters)
    """The simulated rig's physics; without meaning on a real one."""

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC: of the simulated rig's air, else as the file states it."""
        return self.sim.ambient if self.simulated else self.observer.ambient_c

    def in_air(self, ambient_c: float) -> RigConfig:
        """Return a rig whose file states this temperature of the air around a real one, degC."""
        return replace(self, observer=replace(self.observer, ambient_c=ambient_c))

    def stale_limits(self) -> Mapping[str, tuple[str, float]]:
        """Return the keys and values, s, of how old readings may be."""
        limits = self.interlocks
        return {
            "load_cell": ("interlocks.stale_cell", limits.stale_cell_s),
            "ir_thermometer": ("interlocks.stale_ir", limits.stale_ir_s),
            "jacket": ("interlocks.stale_jacket", limits.stale_jacket_s),
        }

    def drives(self) -> Mapping[str, AxisConfig]:
        """Return the axes that have a drive, by name."""
        return self.axes.driven()

    def settled(self) -> RigConfig:
        """Return the rig with the limit of the press's torque."""
        return with_torque_limit(self)

    def problems(self) -> Iterator[tuple[Location, str]]:
        """Yield what does not fit together between the kind's sections, with its place."""
        return problems_between(self)
