"""The rig file of a plain machine: drives by name, sensors by their profiles, without further program code.

A kind inherits from ``PlainRig`` and adds its sections: ``interlocks`` (``section_of`` its table's parameters), ``sim``
with its twin's parameters, and the limits of its rows and its recipes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, ClassVar, Final, TypeVar

from drivers.axis import AxisConfig
from tester.base.config_reader import Range
from tester.base.source import Location
from tester.inputs.rig.config import NOT_REAL, Rig
from tester.inputs.rig.key_classes import HIGHER, Bounded, Free, Inside
from tester.inputs.rig.parameter import SECTION
from tester.inputs.rig.section_classes import AXIS, WATCHDOG_PROOF

OneRig = TypeVar("OneRig", bound="PlainRig")

LISTEN: Final = Bounded(HIGHER, "0.5 s", "another master sends twice a second or oftener [A]")
WITHHOLD: Final = Bounded(
    HIGHER, "300 ms", "a drive reports the missing heartbeat after 200 ms"
)


@dataclass(frozen=True, slots=True)
class ArmingSection:
    """Proofs before a run may move anything (tester.machine.proof)."""

    listen_s: Annotated[float, "s", Range(ge=0.0), LISTEN]
    """Time of silence at first, in which another master on the bus is detected."""
    watchdog_proof: Annotated[bool, WATCHDOG_PROOF]
    """Withhold the PC's heartbeat with the drives enabled at standstill: every drive must report it and drop out."""
    withhold_s: Annotated[float, "s", Range(gt=0.0), WITHHOLD]


@dataclass(frozen=True, slots=True)
class PlainSim:
    """Common part of every twin's section ``sim``; a kind's own inherits from it."""

    noise: Annotated[float, "1", Range(ge=0.0)] = 1.0
    """Scale of every sensor's imperfection."""
    faults: tuple[str, ...] = ()
    """A fault script (sim.faults.language)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlainRig(Rig):
    """A rig of drives and sensors."""

    may_lack: ClassVar[tuple[str, ...]] = (
        *Rig.may_lack, "axes.*.rpdo_deadline", "axes.*.inputs_period", "arming", SECTION,
    )  # fmt: skip

    air_c: Annotated[float, "degC", Range(ge=-40.0, le=60.0), Free("it is recorded, and moves nothing")]
    """Temperature of the air around the rig."""
    axes: Annotated[Mapping[str, AxisConfig], Inside(AXIS)]
    arming: ArmingSection
    sim: Annotated[PlainSim, NOT_REAL] = field(default_factory=PlainSim)
    """The simulated rig's physics; without effect on a real one."""

    @property
    def ambient_c(self) -> float:
        return self.air_c

    def in_air(self: OneRig, ambient_c: float) -> OneRig:
        return replace(self, air_c=ambient_c)

    def drives(self) -> Mapping[str, AxisConfig]:
        return self.axes

    def problems(self) -> Iterator[tuple[Location, str]]:
        """Yield the faults of a plain machine; a kind with further checks yields from this first."""
        for name, axis in self.axes.items():
            if axis.mode != "velocity" or axis.feedback != "velocity":
                yield ("axes", name, "mode"), "this kind gives its drives speeds (expected mode and feedback: velocity)"
        if sum(axis.digital_io for axis in self.axes.values()) != 1:
            yield ("axes",), "one drive carries the safety chain's inputs (expected digital_io: true at one axis)"
        if not any(name in self.devices for name in self.own):
            yield ("devices",), f"no sensor of the machine's own (expected {', '.join(self.own)})"
