"""The context of this machine's steps: the wheel on the rig, its contact, the gates, the load cell's zero."""

from __future__ import annotations

from collections.abc import Mapping
from math import inf
from typing import ClassVar, Final, Protocol

from tester.base.quantities import Quantities
from tester.kinds.wheel_on_belt.control.interlock_inputs import InterlockInputs
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings, Setpoints
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.procedures.gates import GATES, Gates
from tester.kinds.wheel_on_belt.procedures.wheel_life import WheelLife, wheel_of
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.context import BaseContext
from tester.machine.prompts import Prompts
from tester.store.recorder import Recorder

CONTACT_N: Final = 5.0
"""Above this force the wheel counts as in contact, for recording and for its wear."""
SLIDING_M_S: Final = 0.002
"""Below this slip a contact rolls: it wears nothing."""
_LOAD: Final = Press.LOAD


class Attendant(Protocol):
    """A person's work at the rig. A simulated rig does it itself; on a real rig the calls do nothing."""

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        """Mount a new wheel of ``compound``."""
        ...

    def remount(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount the wheel of an interrupted run again, with its wear (mm, m)."""
        ...

    def mount_again(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount an earlier wheel of this run again, with its wear (mm, m)."""
        ...

    def belt_travelled(self, travel_m: float) -> None:
        """Keep the belt of an interrupted run, with its travel under load, m."""
        ...

    def begin_repeat(self, condition: int, repeat: int, attempt: int, held: Mapping[str, float]) -> None:
        """Mark the start of a repeat at setpoints by axis (keys of the simulator's random streams)."""
        ...


class CellZero(Protocol):
    """The load cell's zero."""

    @property
    def tare(self) -> tuple[float, ...]:
        """Offsets in use: Fx, Fy, Fz in N, Mz in N m."""
        ...

    def set_tare(self, values: tuple[float, ...]) -> None:
        """Use these offsets from now on."""
        ...


class Context(BaseContext[RigConfig, Readings, Demand]):
    """One per run; only activities read and write it."""

    gate_bits: ClassVar[Mapping[str, int]] = GATES

    def __init__(
        self,
        rig: RigConfig,
        readings: Readings,
        prompts: Prompts,
        journal: Recorder,
        attendant: Attendant,
        cell: CellZero,
        view: InterlockInputs,
        quantities: Quantities = QUANTITIES,
    ) -> None:
        """Take the parts of a rig; ``view``: control's inputs, ``quantities``: the run's table of channels."""
        super().__init__(rig, readings, Demand(), prompts, journal)
        self.setpoints = Setpoints()
        self.gates = Gates(rig.gates)
        self.attendant = attendant
        self.cell = cell
        self.quantities = quantities
        self.view = view
        self.contact = view.state.load
        """The press loop: whether the wheel is in contact, and where it was touched."""
        self.heat = view.heat
        self.observer = view.observer
        self.wheel = wheel_of(rig.geometry)
        self.shelf: dict[tuple[int, int], WheelLife] = {}
        """The wheels that were taken off: the last of each specimen and replicate."""
        self.belt_travel_m = 0.0
        """How far the belt has travelled under load since the run began."""
        self._was_in_contact = self.contact.in_contact
        self._wear_mm3_per_n_m = rig.wear.rate_mm3_per_n_m

    def put_on(self, wheel: WheelLife) -> None:
        """Use another wheel from now on: its place of contact is unknown, and its turns count from zero."""
        self.wheel = wheel
        self.contact.forget_contact()
        self.readings.wheel_angle_rev = 0.0

    def before_reading(self) -> None:
        """Update the wheel's diameters, from which speeds are computed."""
        self.wheel.show(self.readings, self.rig.wear)

    def after_reading(self) -> None:
        """Add this scan's wear of the wheel, and the belt's travel under load."""
        r = self.readings
        if r.force_z_n > CONTACT_N:
            travelled_m = r.belt_speed_m_s * self.dt
            if travelled_m > 0.0:  # also false for NaN
                self.belt_travel_m += travelled_m
        if r.force_z_n > CONTACT_N and r.slip_m_s > SLIDING_M_S:
            self.wheel.slide(r.force_z_n, r.slip_m_s, self.dt, self._wear_mm3_per_n_m)

    def closed_gates(self) -> int:
        """Evaluate the gates."""
        return self.gates.update(self.readings, self.dt)

    def after_control(self) -> None:
        """Record when the wheel touches."""
        in_contact = self.contact.in_contact
        if in_contact is not self._was_in_contact:
            self._was_in_contact = in_contact
            self.gates.touched_s = self.now if in_contact else inf

    def touching(self) -> bool:
        """Return whether contact is wanted, or measured."""
        return self.readings.force_z_n > CONTACT_N or self.demand.press is _LOAD

    def known(self) -> list[str]:
        """Return the rig's history of heatings."""
        return [f"heat balance: {self.view.heat_known}"]
