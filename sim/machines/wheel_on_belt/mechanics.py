"""The mechanics of a wheel on a belt: the motion and the load of each drive.

The press goes no deeper than the torque limit of its drive (0x6072) allows; wheel and belt give way to friction that
needs more torque than theirs.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import copysign
from typing import Final

from drivers.axis import AxisConfig
from sim.machines.wheel_on_belt.plant import Plant
from sim.machines.wheel_on_belt.standstill_relay import StandstillRelay
from sim.machines.wheel_on_belt.torque import PressScrew, capstan_n, shafts
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.drive_power import ENERGISED
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.motion import VelocityAxis
from sim.nodes.sensor_slave import CellSlave, IrSlave
from sim.physics.laws import LawSetting
from sim.physics.parameters import SimParameters
from sim.rig import LONGEST_STEP_S, RigSpec, SimRig
from sim.wires.can_wire import CanWire

PRESS_LAG_S: Final = 0.03
"""Lag of the press screw behind its velocity command, s [A]."""
PRESS_TRAVEL_MM: Final = 30.0
"""Travel of the press from fully lifted, mm [A]: beyond the hub of a fully worn wheel."""
PRESS_SPRING_MM_S: Final = -20.0
"""Speed of an unpowered press that the spring retracts, mm/s [A]."""
WHEEL_KG_M2: Final = 0.02
BELT_KG_M2: Final = 0.05
"""Inertia of the wheel with its motor, and of rollers, belt and motor at the drive roller's shaft [A]."""
FORCES: Final = ("fx", "fy", "fz")
"""Forces to measure, each by a transmitter of the load cell; one transmitter may measure all."""
_NEAR_LIMIT: Final = 0.5
"""Share of the press' greatest force; below it no single step reaches that force."""


def _measuring(cells: Mapping[str, CellSlave], force: str) -> CellSlave:
    """Return the transmitter that measures a force; the first if none does."""
    return next((cell for cell in cells.values() if force in cell.forces), next(iter(cells.values())))


class WheelMechanics(SimRig):
    """Drives and devices of a rubber friction tester with a wheel on a belt, on simulated wires.

    Drives: wheel (rad/s), belt (m/s), press (mm, mm/s), and those that hold an angle (deg) unless a person sets
    it. Of the angles only sideslip changes the friction; the paper has no data for a tilt.
    Devices: load cell, thermometer, jacket.
    """

    # Slots: CPython 3.11 keeps more than 30 attributes in a dictionary, and every step of the twin gets slower.
    __slots__ = (
        "_belt", "_belt_creep", "_encoders_draw", "_encoders_drawn", "_held_n", "_limit_nm", "_press", "_pressed_mm",
        "_pushed_n", "_roller_m", "_screw", "_seen_s", "_sideslip", "_slip_nm", "_spring_mm_s", "_stalled",
        "_travelled_m", "_turned_rad", "_wheel", "_yields", "belt_shaft", "belt_slip", "cell", "cells", "ir", "jacket",
        "mounted", "plant", "relay", "swapped", "turned", "wheel_shaft",
    )  # fmt: skip

    def __init__(
        self, spec: RigSpec, parameters: SimParameters, seed: int, can_wire: type[CanWire] = CanWire
    ) -> None:
        """Switch everything on at time 0; ``can_wire``: the class of the bus, another one for faults."""
        self.plant = Plant(parameters, seed)
        self._spring_mm_s = PRESS_SPRING_MM_S if parameters.press_on_power_loss == "retract" else 0.0
        super().__init__(spec, self.plant, can_wire)
        self.cell = _measuring(self.cells, "fz")
        """The transmitter of the normal force."""
        self.devices = {"load cell": self.cell, "thermometer": self.ir, "jacket": self.jacket}
        self.devices |= {f"load cell {force}": _measuring(self.cells, force) for force in FORCES}
        drives = parameters.drives
        self.wheel_shaft, self.belt_shaft, efficiency = shafts(drives, parameters.noise, seed)
        spring_n, rate = (drives.press_spring, drives.press_spring_rate) if self._spring_mm_s else (0.0, 0.0)
        self._screw = PressScrew(drives, efficiency, spring_n, rate)
        self._roller_m = 0.0005 * drives.belt_roller_diameter
        self._slip_nm = capstan_n(drives) * self._roller_m
        self._belt_creep = drives.belt_creep
        self.belt_slip = 0.0
        """Share by which the belt is slower than its drive roller: beyond elastic creep the roller slips under it."""
        self._limit_nm = self._pushed_n = self._held_n = 0.0
        self._pressed_mm = 0.0
        self._stalled = self._yields = False
        self.relay = StandstillRelay() if parameters.standstill_relay else None
        self.swapped = False
        """Whether the drives of wheel and belt are swapped: each moves the other's part."""
        self.mounted = 0, 0, ""
        """Specimen, wheel and compound on the rig."""
        self.turned: set[str] = set()
        """Press or positioned axes that move the wrong way round: the motor's direction was never set."""
        self._encoders_drawn: tuple[int, ...] = (0, 0)
        self._encoders_draw: tuple[int, ...] = (0, 0)
        """Numbers that the encoders' noise had taken when counting began, and takes in the time of a leap."""
        self._turned_rad = self._travelled_m = self._seen_s = 0.0
        """Travel of the wheel's shaft and of the belt's surface, and the time of both: what marks on them show."""
        self._wheel, self._belt, self._press = self.axes["wheel"], self.axes["belt"], self.axes["press"]
        self._sideslip = self.axes.get("sideslip")

    def own_devices(self, spec: RigSpec) -> dict[str, ModbusSlave]:
        ir, jacket = (spec.devices[name] for name in ("ir_thermometer", "jacket"))
        self.cells = {
            name: CellSlave(device.profile, device.unit_id, self.plant, device.channels)
            for name, device in spec.devices.items()
            if "load_cell" in (name, device.part_of)
        }
        """The load cell's transmitters: one, or several."""
        self.ir = IrSlave(ir.profile, ir.unit_id, self.plant, sensor_c=self.ambient_c)
        self.jacket = ControllerSlave(jacket.profile, jacket.unit_id, self.plant)
        return {**self.cells, "ir_thermometer": self.ir, "jacket": self.jacket}

    def drive(self, name: str, config: AxisConfig) -> Cia402Slave:
        if name != "press":
            return super().drive(name, config)
        screw = VelocityAxis(config.acceleration, config.deceleration, lag_s=PRESS_LAG_S, low=0.0, high=PRESS_TRAVEL_MM)
        return Cia402Slave(config, self.can, screw, serial_number=config.node_id, unpowered_velocity=self._spring_mm_s)

    # -- interface to the wires -----------------------------------------------------------------------------------

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC."""
        return self.plant.parameters.ambient

    @property
    def by_surface(self) -> bool:
        """Return True: a compound outside the paper rubs by its file."""
        return True

    def take(self, setting: LawSetting) -> None:
        self.plant.setting = setting

    # -- leaps ----------------------------------------------------------------------------------------------------

    def count_readings(self) -> None:
        super().count_readings()
        self._encoders_drawn = self._drawn()

    def readings_since(self) -> dict[str, dict[int, int]]:
        self._encoders_draw = tuple(now - then for now, then in zip(self._drawn(), self._encoders_drawn, strict=True))
        return super().readings_since()

    def _drawn(self) -> tuple[int, ...]:
        """Return how many numbers each encoder's noise has taken."""
        return self.plant.wheel_speed.noise.drawn, self.plant.belt_speed.noise.drawn

    def leap(self, seconds: float, each: Mapping[str, Mapping[int, int]]) -> None:
        """Let time pass in which what turns keeps its speed; only its encoder stands still, by the clock of the wires.
        """
        plant, before = self.plant, self._drawn()
        super().leap(seconds, each)
        left = [due + then - now for due, then, now in zip(self._encoders_draw, before, self._drawn(), strict=True)]
        plant.wheel_speed.noise.skip(left[0])
        plant.belt_speed.noise.skip(left[1])

    def put_back(self, seconds: float) -> None:
        super().put_back(seconds)
        self._seen_s -= seconds

    # -- mechanics ------------------------------------------------------------------------------------------------

    def follow(self, t1: float, still: bool) -> None:
        """Advance the plant with its drives to ``t1`` s, and load the drives."""
        plant, relay = self.plant, self.relay
        wheel_axis, belt_axis, press = self._wheel.axis, self._belt.axis, self._press.axis
        wheel_rad_s, belt_m_s = wheel_axis.value, belt_axis.value
        if self.swapped:
            wheel_rad_s, belt_m_s = belt_m_s / self._roller_m, wheel_rad_s * self._roller_m
        wheel_rad_s /= plant.wheel_speed.factor
        belt_m_s /= plant.belt_speed.factor
        rim_m_s = 0.0005 * plant.diameter_mm * wheel_rad_s
        if relay is not None and (not still or relay.off) and relay.look(rim_m_s, belt_m_s, t1):
            for name in relay.reaches:
                self.axes[name].set_torque_off(relay.off)
        elapsed = t1 - self.plant_s
        if still and elapsed < LONGEST_STEP_S - 1e-6 and plant.force_z_n == 0.0:
            self._seen_s = t1
            return  # only temperatures change, and slowly
        dt, self._seen_s = t1 - self._seen_s, t1
        self._turned_rad += wheel_rad_s * dt
        self._travelled_m += belt_m_s * dt
        self.plant_s = t1
        if plant.force_z_n > 0.0 or self._stalled:
            self._bear(self._press)
        self._pressed_mm = press.position
        press_mm, press_mm_s = press.position, press.value
        sideslip_deg = self._sideslip.axis.position if self._sideslip is not None else 0.0
        if self.turned:
            press_mm, press_mm_s = (-press_mm, -press_mm_s) if "press" in self.turned else (press_mm, press_mm_s)
            sideslip_deg = -sideslip_deg if "sideslip" in self.turned else sideslip_deg
        io = self._press.io
        heater_w = self.jacket.heater_w if io is not None and io.contactor_closed else 0.0  # heat_flowing_w
        plant.advance(elapsed, wheel_rad_s, belt_m_s, press_mm, press_mm_s, sideslip_deg, heater_w)
        belt_nm = -plant.belt_force_n * self._roller_m
        if plant.force_z_n > 0.0 or self._yields:
            wheel_nm, most_nm = plant.drive_torque_nm, self._wheel.torque_limit_nm
            most_belt_nm = self._belt.torque_limit_nm
            # Nearly always no drive is beyond its limit, nor was it: then none gives way.
            if self._yields or not (-most_nm <= wheel_nm <= most_nm and -most_belt_nm <= belt_nm <= most_belt_nm):
                radius_m = 0.0005 * plant.diameter_mm
                wheel = self._give_way(self._wheel, wheel_nm, WHEEL_KG_M2, radius_m, 1.0, elapsed)
                belt = self._give_way(self._belt, belt_nm, BELT_KG_M2, self._roller_m, self._roller_m, elapsed)
                self._yields = wheel or belt
        self._show(wheel_axis.value, belt_axis.value, belt_nm)

    def _give_way(self, drive: Cia402Slave, load_nm: float, inertia: float, arm_m: float, per_rad: float, dt: float
                  ) -> bool:  # fmt: skip
        """Let wheel or belt be slower than its loop wants, where ``load_nm`` is more than its drive's torque limit;
        return whether it is.

        ``arm_m``: from the shaft to the contact; ``per_rad``: the axis's speed at 1 rad/s. What friction takes falls
        with the slip, within a step too.
        """
        axis, limit_nm = drive.axis, drive.torque_limit_nm
        size_nm = -load_nm if load_nm < 0.0 else load_nm
        if not isinstance(axis, VelocityAxis) or (axis.yielded == 0.0 and size_nm <= limit_nm) or dt <= 0.0:
            return False
        slip_rad_s = self.plant.slip_m_s / arm_m
        falls = size_nm / slip_rad_s if slip_rad_s > 1e-6 else 0.0
        rad_s = (size_nm - limit_nm) / (inertia / dt + falls)
        by = axis.yielded + per_rad * (-rad_s if load_nm < 0.0 else rad_s)
        if axis.yielded * by < 0.0 or not drive.energised:
            by = 0.0
        axis.give_way(by)
        return by != 0.0

    @property
    def wheel_rad_s(self) -> float:
        """Speed of the wheel, rad/s: the speed that its drive shows, without the error of its scale."""
        shaft = self._belt.axis.value / self._roller_m if self.swapped else self._wheel.axis.value
        return shaft / self.plant.wheel_speed.factor

    @property
    def belt_m_s(self) -> float:
        """Speed of the belt's surface, m/s."""
        surface = self._wheel.axis.value * self._roller_m if self.swapped else self._belt.axis.value
        return surface / self.plant.belt_speed.factor

    @property
    def heat_flowing_w(self) -> float:
        """Power that reaches the jacket through the contactor, W."""
        io = self._press.io
        return self.jacket.heater_w if io is not None and io.contactor_closed else 0.0

    @property
    def rim_m_s(self) -> float:
        """Speed of the wheel's tread, m/s."""
        return 0.0005 * self.plant.diameter_mm * self.wheel_rad_s

    def _show(self, wheel_rad_s: float, belt_m_s: float, belt_nm: float) -> None:
        """Set the torques that three drives show, and the errors of their encoders, which are noisy during rotation.

        ``belt_nm``: the torque of friction at the belt's roller.
        """
        plant, wheel, belt, press = self.plant, self._wheel, self._belt, self._press
        wheel_nm = plant.drive_torque_nm
        if self.belt_slip > self._belt_creep and self.belt_m_s != 0.0:
            belt_nm = copysign(self._slip_nm, self.belt_m_s)
        if self.swapped:
            wheel_nm, belt_nm = belt_nm, wheel_nm
        wheel_nm = self.wheel_shaft.shown_nm(wheel_nm, wheel_rad_s) if wheel.state in ENERGISED else 0.0
        belt_nm = self.belt_shaft.shown_nm(belt_nm, belt_m_s / self._roller_m) if belt.state in ENERGISED else 0.0
        # What ``load`` does is written out where it would be called in every step.
        if wheel_rad_s != 0.0:
            wheel.torque_nm = wheel.torque_gain * wheel_nm + wheel.torque_offset_nm
            wheel.encoder_error = plant.wheel_speed.error() * 2000.0 / plant.diameter_mm
            wheel.pdos.stale = True
        elif wheel.encoder_error != 0.0 or wheel.torque_nm != wheel_nm:
            wheel.load(wheel_nm, 0.0)
        if belt_m_s != 0.0:
            belt.torque_nm = belt.torque_gain * belt_nm + belt.torque_offset_nm
            belt.encoder_error = plant.belt_speed.error()
            belt.pdos.stale = True
        elif belt.encoder_error != 0.0 or belt.torque_nm != belt_nm:
            belt.load(belt_nm, 0.0)
        press_nm = 0.0
        if press.state in ENERGISED:
            axis = press.axis
            press_nm = self._screw.torque_nm(plant.force_z_n, axis.position)
            if axis.blocked and axis.demand != 0.0:
                press_nm = copysign(press.torque_limit_nm, axis.demand)
        if press.torque_nm != press_nm:
            press.load(press_nm, 0.0)

    def _bear(self, drive: Cia402Slave) -> None:
        """Limit the press to its drive's torque: it stalls; a greater load drives it back."""
        limit_nm, plant = drive.torque_limit_nm, self.plant
        if self._spring_mm_s and drive.state not in ENERGISED:
            # The spring at 0 mm makes coast_deceleration of the screw's inertia; the load pushes the same way.
            axis, screw = drive.axis, self._screw
            grown_n = screw.rate_n_per_mm * axis.position
            rate = drive.coast_deceleration * (1.0 + (plant.force_z_n + grown_n) / screw.spring_n)
            axis.acceleration = axis.deceleration = rate
        if limit_nm != self._limit_nm or self._screw.rate_n_per_mm:
            self._limit_nm, place_mm = limit_nm, drive.axis.position
            self._pushed_n = max(0.0, self._screw.pushed_n(limit_nm, place_mm))
            self._held_n = max(0.0, self._screw.held_n(limit_nm, place_mm))
        if plant.force_z_n > _NEAR_LIMIT * self._pushed_n and drive.energised:
            place_mm = drive.axis.position
            reached_mm = max(self._pressed_mm, plant.press_at_mm(self._pushed_n))
            borne_mm = min(place_mm, reached_mm, plant.press_at_mm(self._held_n))
            if borne_mm < place_mm:
                self._stalled = True
                drive.stall(borne_mm)
                return
        if self._stalled:
            self._stalled = False
            drive.unstall()
