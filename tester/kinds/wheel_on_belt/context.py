"""The context of this machine's steps: the wheel on the rig, its contact, the gates, the load cell's zero."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import hypot, inf, isfinite, nan
from typing import ClassVar, Final, Protocol

from tester.analysis.wear_rate import NO_CONDITION, TOUCH, WearCheck
from tester.base.quantities import Quantities
from tester.kinds.wheel_on_belt.budget import TOUCHES_U_MM
from tester.kinds.wheel_on_belt.control.interlock_inputs import InterlockInputs
from tester.kinds.wheel_on_belt.image.process_image import Demand, Press, Readings, Setpoints
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.interlocks.contact_force import UNLOADED_N, depth_mm
from tester.kinds.wheel_on_belt.procedures.belts import Belts
from tester.kinds.wheel_on_belt.procedures.gates import GATES, Gates
from tester.kinds.wheel_on_belt.procedures.wear_estimate import PRIOR_RATE, LoadMemory, loss_per_n_m
from tester.kinds.wheel_on_belt.procedures.wheel_life import WheelLife, wheel_of
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.machine.context import BaseContext
from tester.machine.prompts import Prompts
from tester.store.recorder import Recorder

CONTACT_N: Final = 5.0
"""Above this force the wheel counts as in contact, for recording and for its wear."""
SLIDING_M_S: Final = 0.002
"""Below this slip a contact rolls: it wears nothing."""
LEARNT_SHARE: Final = 0.2
"""A wear rate is learnt once its standard uncertainty is at most this share of it [A]."""
RATE_DIFFERS: Final = 0.1
"""Share by which the rates of two wheels of one compound differ [A]."""
CALM_M_S: Final = 0.02
"""Wheel and belt turn at their constant speed within this [A]: in a cool-down the creep swells by half of it."""
CALM_MM_S: Final = 0.1
"""A press that is commanded no faster is back [A]."""
_LOAD: Final = Press.LOAD


class Attendant(Protocol):
    """A person's work at the rig. A simulated rig does it itself; on a real rig the calls do nothing."""

    def install(self, specimen: int, wheel: int, compound: str, *, new_specimen: bool) -> None:
        """Mount a new wheel of ``compound``."""
        ...

    def remount(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount a worn wheel, with its wear (mm, m)."""
        ...

    def keep(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Keep the wheel of an interrupted run on the rig, or mount it with its wear (mm, m)."""
        ...

    def mount_again(self, specimen: int, wheel: int, compound: str, diameter_mm: float, sliding_m: float) -> None:
        """Mount an earlier wheel of this run again, with its wear (mm, m)."""
        ...

    def cover(self, surface: str) -> None:
        """Put a belt of this name on, clean."""
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

    # Slots: CPython 3.11 looks the methods of an object with more than 30 attributes up anew in every scan.
    __slots__ = (
        "_open_since_s", "_place_mm", "_was_in_contact", "_wear_mm3_per_n_m", "attendant", "belts", "cell",
        "contact", "gates", "heat", "observer", "quantities", "rates", "shelf", "view", "wheel",
    )  # fmt: skip

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
        self.belts = Belts()
        """The belts of the run, and how far each has travelled under load since it began."""
        self.rates: dict[str, tuple[float, float]] = {}
        """Wear rates learnt in this run by compound, mm3/(N m), with their standard uncertainties."""
        self._was_in_contact = self.contact.in_contact
        self._open_since_s = -inf
        self._place_mm = nan
        self._wear_mm3_per_n_m = rig.wear.rate_mm3_per_n_m
        self._layer_mm = rig.observer.wheel.rubber_layer

    def put_on(self, wheel: WheelLife) -> None:
        """Use another wheel from now on: its place of contact is unknown, and its turns count from zero."""
        self.wheel = wheel
        rate, u_rate = self.rates.get(wheel.compound, (self._wear_mm3_per_n_m, PRIOR_RATE))
        if wheel.compound in self.rates:
            wheel.rate_mm3_per_n_m = rate
        wheel.loads = LoadMemory()
        u_mm = TOUCHES_U_MM if wheel.loss_mm > 0.0 else 0.0
        wheel.estimate.begin(rate, u_rate, wheel.loss_mm, wheel.exposure_n_m, u_mm)
        self.contact.forget_contact()
        self._place_mm = nan
        self.readings.wheel_angle_rev = 0.0

    def change_belt(self, belt: str) -> None:
        """Use another belt from now on. Belts differ in thickness: the place of contact is that of a wheel just put on.
        """
        self.belts.put_on(belt)
        if self.wheel.wheel:
            self.put_on(replace(self.wheel, reference=None, last_check=None))

    def before_reading(self) -> None:
        """Update the wheel's diameters, from which speeds are computed."""
        self.wheel.show(self.readings, self.rig.wear)

    def after_reading(self) -> None:
        """Add this scan's wear of the wheel, and the belt's travel under load."""
        r = self.readings
        self.wheel.loads.add(r.force_z_n if r.force_z_n > CONTACT_N else 0.0, self.dt)
        if r.force_z_n > CONTACT_N:
            travelled_m = r.belt_speed_m_s * self.dt
            if travelled_m > 0.0:  # also false for NaN
                self.belts.travelled(travelled_m)
        if r.force_z_n > CONTACT_N and r.slip_m_s > SLIDING_M_S:
            self.wheel.slide(r.force_z_n, r.slip_m_s, self.dt, self._wear_mm3_per_n_m)

    def most_loss_mm(self, load_n: float) -> float:
        """Return the loss of diameter, mm, that the wheel may reach under a load: least diameter, travel of the press.

        The press must reach the rubber and press it in; softer rubber gives way more.
        """
        wheel, rig = self.wheel, self.rig
        most_mm = wheel.installed_mm - rig.interlocks.least_diameter_mm
        limits, place_mm = rig.axes.press.software_limits, self.contact.contact_mm
        if limits is None or not isfinite(place_mm):
            return most_mm
        deep_mm = rig.interlocks.depth_factor * depth_mm(load_n, rig.loops.load.stiffness_n_per_mm)
        return min(most_mm, wheel.loss_mm + 2.0 * (limits[1] - deep_mm - place_mm))

    def closed_gates(self) -> int:
        """Evaluate the gates."""
        return self.gates.update(self.readings, self.dt)

    def after_control(self) -> None:
        """Record when the wheel touches, and where."""
        in_contact = self.contact.in_contact
        if in_contact is not self._was_in_contact:
            self._was_in_contact = in_contact
            self.gates.touched_s = self.now if in_contact else inf
            if not in_contact:
                self._open_since_s = self.now
            elif self.contact.contact_mm != self._place_mm and self.wheel.wheel:
                self._place_mm = self.contact.contact_mm
                self._touched()

    def _touched(self) -> None:
        """Let the wheel's diameter follow from the place of a first touch."""
        wheel, r, load = self.wheel, self.readings, self.rig.loops.load
        touch_n, stiffness, estimate = load.touch_load_n, load.stiffness_n_per_mm, wheel.estimate
        place_mm = self._place_mm - depth_mm(r.force_z_n, stiffness) + depth_mm(touch_n, stiffness)
        place_mm += 0.5 * wheel.grown_mm
        if not isfinite(place_mm):
            return
        estimate.slid(wheel.exposure_n_m, loss_per_n_m(wheel.cold_mm, wheel.width_mm))
        estimate.warmed(wheel.rubber_c, wheel.growth_u_mm_per_k(self.rig.wear, self._layer_mm))
        remembered_n, open_s = wheel.loads.remembered_n(), self.now - self._open_since_s
        if not estimate.touch(place_mm, touch_n, remembered_n, open_s, stiffness):
            text = f"a touch and the learnt wear disagree by {estimate.off_mm:+.2f} mm of diameter: it is not used"
            self.journal.event(self.now, "wear", text, "warning")
            return
        believed_mm, off_mm = wheel.loss_mm, wheel.follow()
        if off_mm and not wheel.followed:
            wheel.followed = True
            text = f"loss of diameter {wheel.loss_mm:.2f} mm by the place of the touch (u {estimate.u_mm:.2f} mm)"
            self.journal.event(self.now, "wear", f"{text}, {believed_mm:.2f} mm believed: speeds follow the touch")
        # The place of contact is worn on from the diameter that it was touched with.
        self.contact.diameter_mm = wheel.cold_mm + wheel.grown_mm
        self._note_rate()
        wheel.touched = self._touch_record(r.force_z_n)

    def _note_rate(self) -> None:
        """Keep a rate that the touches show clearly, and report it once where it is not the believed one."""
        wheel, believed = self.wheel, self._wear_mm3_per_n_m
        rate, u_rate = wheel.estimate.rate_mm3_per_n_m, wheel.estimate.u_rate
        if not wheel.followed or u_rate > LEARNT_SHARE * rate:
            return
        self.rates[wheel.compound] = rate, hypot(u_rate, RATE_DIFFERS * rate)
        if wheel.reported or abs(rate - believed) <= 2.0 * u_rate:
            return
        wheel.reported = True
        how = "faster" if rate > believed else "more slowly"
        text = f"wheel {wheel.wheel} wears {how} than believed: {rate:.3f} ± {2.0 * u_rate:.3f} mm3/(N m) by touches,"
        text += f" wear.rate is {believed:g}; the run continues at the rate that was learnt"
        self.journal.event(self.now, "wear", text, "warning" if rate > believed else "info")

    def _touch_record(self, force_n: float) -> WearCheck:
        """Return the last touch as a check of the diameter."""
        wheel, estimate = self.wheel, self.wheel.estimate
        rate = estimate.rate_mm3_per_n_m
        return WearCheck(
            wheel.wheel, TOUCH, self.now, self.now, NO_CONDITION, wheel.condition,
            wheel.installed_mm - max(estimate.loss_mm, 0.0), wheel.u_mm, wheel.rubber_c,
            self.rig.wear.growth_uncertainty_mm_per_k, self._place_mm, force_n, wheel.sliding_m, wheel.exposure_n_m,
            wheel.width_mm, 100.0 * estimate.u_rate / rate if rate > 0.0 else 100.0, 1, wheel.cold_mm,
        )  # fmt: skip

    def calm(self) -> tuple[float, ...]:
        r, out = self.readings, self.view.setpoints
        if out.heat or out.contactor or r.contactor_closed or not r.heat_percent <= 0.0:
            return ()
        if self.contact.in_contact or not r.force_z_n < UNLOADED_N or not abs(out.press_mm_s) <= CALM_MM_S:
            return ()
        wheel_m_s = out.wheel_rad_s * r.diameter_mm * 0.5e-3
        if not (abs(r.wheel_speed_m_s - wheel_m_s) <= CALM_M_S and abs(r.belt_speed_m_s - out.belt_m_s) <= CALM_M_S):
            return ()
        return (r.surface_c, r.hub_c) if r.surface_valid and r.jacket_valid else ()

    def touching(self) -> bool:
        """Return whether contact is wanted, or measured."""
        return self.readings.force_z_n > CONTACT_N or self.demand.press is _LOAD

    def known(self) -> list[str]:
        """Return the rig's history of heatings."""
        return [f"heat balance: {self.view.heat_known}"]
