"""What a step of this machine may see and do: the wheel on the rig, its contact, the gates, the load cell's zero."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import inf
from typing import Final, Protocol

from tester.base.quantities import Quantities
from tester.kinds.wheel_on_belt.control.loops import LoadLoop
from tester.kinds.wheel_on_belt.control.observer import ThermalObserver
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings, Setpoints
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.interlocks.heat_balance import HeatBalance
from tester.kinds.wheel_on_belt.procedures.gates import Gates
from tester.kinds.wheel_on_belt.procedures.wheel_life import WheelLife
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
    """The hands at the rig: a simulated rig does a person's work itself; on a real rig nothing happens."""

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        """Mount a new wheel of ``compound``."""
        ...

    def remount(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Put the wheel of an interrupted run back, as worn as it was (mm, m)."""
        ...

    def mount_again(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Put a wheel back on that was on before in this run, as worn as it was (mm, m)."""
        ...

    def belt_travelled(self, travel_m: float) -> None:
        """Have the belt on that an interrupted run has used, m of travel under load."""
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


def nothing_to_tell(now: float) -> None:
    """Take note of nothing: a bench without control."""


class Context(BaseContext[RigConfig, Readings, Demand]):
    """One per run; activities read and write it, nothing else."""

    def __init__(
        self,
        rig: RigConfig,
        readings: Readings,
        demand: Demand,
        gates: Gates,
        prompts: Prompts,
        journal: Recorder,
        attendant: Attendant,
        cell: CellZero,
        wheel: WheelLife,
        contact: LoadLoop,
        ambient_c: float,
        wheel_changed: Callable[[float], None] = nothing_to_tell,
        heat: HeatBalance | None = None,
        heat_known: str = "",
        observer: ThermalObserver | None = None,
        quantities: Quantities = QUANTITIES,
    ) -> None:
        """Take the parts of a rig.

        ``contact``: the press loop, which knows whether it is in contact and where the wheel was touched.
        ``ambient_c``: air temperature at the rig, degC. ``wheel_changed`` tells control that another wheel is on the
        rig, at ambient temperature (s). ``heat``: control's balance of the heater's energy, None on a bench without
        control; ``heat_known``: what earlier runs make known of it, in words. ``observer``: control's model of the
        rubber's temperature, None on a bench without control. ``quantities``: the run's table of channels.
        """
        super().__init__(rig, readings, demand, prompts, journal)
        self.setpoints = Setpoints()
        self.gates = gates
        self.attendant = attendant
        self.cell = cell
        self.wheel = wheel
        self.contact = contact
        self.ambient_c = ambient_c
        self.wheel_changed = wheel_changed
        self.heat = heat
        self.heat_known = heat_known
        self.observer = observer
        self.quantities = quantities
        self.shelf: dict[tuple[int, int], WheelLife] = {}
        """The wheels that were taken off: the last of each specimen and replicate."""
        self.belt_travel_m = 0.0
        """How far the belt has travelled under load since the run began."""
        self._was_in_contact = contact.in_contact
        self._wear_mm3_per_n_m = rig.wear.rate_mm3_per_n_m

    def before_reading(self) -> None:
        """Bring the wheel's diameters up to date: speeds are worked out with them."""
        self.wheel.show(self.readings, self.rig.wear)

    def after_reading(self) -> None:
        """Account for what this scan's sliding takes off the wheel, and for the belt that passes below it."""
        r = self.readings
        if r.force_z_n > CONTACT_N:
            travelled_m = r.belt_speed_m_s * self.dt
            if travelled_m > 0.0:  # also: it is a number
                self.belt_travel_m += travelled_m
        if r.force_z_n > CONTACT_N and r.slip_m_s > SLIDING_M_S:
            self.wheel.slide(r.force_z_n, r.slip_m_s, self.dt, self._wear_mm3_per_n_m)

    def closed_gates(self) -> int:
        """Evaluate the gates."""
        return self.gates.update(self.readings, self.dt)

    def after_control(self) -> None:
        """Note when the wheel touches."""
        in_contact = self.contact.in_contact
        if in_contact is not self._was_in_contact:
            self._was_in_contact = in_contact
            self.gates.touched_s = self.now if in_contact else inf

    def touching(self) -> bool:
        """Tell whether contact is wanted, or measured."""
        return self.readings.force_z_n > CONTACT_N or self.demand.press is _LOAD

    def known(self) -> list[str]:
        """Return what earlier heatings make known."""
        return [f"heat balance: {self.heat_known}"]
