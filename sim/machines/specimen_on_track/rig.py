"""The rig of a specimen on a track: drives, end switches and stops of the travel, and the sensors on their wires.

A linear track runs between two stops. The end switches, a little before the stops, open the safety chain at the drive
with the inputs; an attendant moves the track back by hand.
"""

from __future__ import annotations

from math import degrees
from typing import Final

from drivers.axis import AxisConfig
from sim.machines.specimen_on_track.plant import DISC_RADIUS_MM, TrackPlant
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.controller_slave import ControllerSlave
from sim.nodes.modbus_slave import ModbusSlave
from sim.nodes.motion import PositionAxis, VelocityAxis
from sim.nodes.sensor_slave import CellSlave, IrSlave, SensorSlave
from sim.physics.laws import LawSetting
from sim.physics.track import Interface, TrackParameters
from sim.rig import DeviceSpec, RigSpec, SimRig
from sim.wires.can_wire import CanWire

TRACK_LAG_S: Final = 0.004
"""Lag of the track behind its velocity command, s [A]."""
TRACK_LEVER_M: Final = 0.05
"""Torque at the track's drive per force at the specimen, m [A]."""
_METRES: Final = {"mm/s": 1e-3, "m/s": 1.0}
"""Metres in the track's unit of length."""
OWN: Final = ("load_cell", "chamber", "pyrometer", "thermometer", "height_sensor")
"""Keys of the machine's own devices in the wiring; all but the load cell may be missing."""


class AmbientAir:
    """The air that a thermometer beside the rig measures."""

    def __init__(self, plant: TrackPlant) -> None:
        """Take the plant, for its room temperature."""
        self._plant = plant

    def surface_measured_c(self, t: float) -> float:
        """Return the temperature of the room's air, degC."""
        return self._plant.parameters.ambient


class TrackRig(SimRig):
    """A friction tester with a specimen on a track, on simulated wires.

    Drives: track (mm/s or m/s at the specimen), and lift (mm, 0 lowered) unless the arm is moved by hand. Devices by
    their keys in the wiring: load_cell, and any of chamber, pyrometer, thermometer, height_sensor. The other methods
    are the actions of the attendant.
    """

    def __init__(
        self, spec: RigSpec, parameters: TrackParameters, seed: int, can_wire: type[CanWire] = CanWire
    ) -> None:
        """Switch everything on at time 0, the arm raised; ``can_wire``: the class of the bus, another one for faults.

        Raises UnknownQuantityError for a further sensor of a quantity that the plant does not have.
        """
        self.plant = TrackPlant(parameters, seed)
        self._raised_mm = parameters.contact.lift_travel
        self.hand_mm = self._raised_mm
        """Position of an arm without a drive, mm."""
        super().__init__(spec, self.plant, can_wire)
        self.cell = self.devices["load cell"]
        chamber = self.devices.get("chamber")
        self.chamber = chamber if isinstance(chamber, ControllerSlave) else None
        self._track = self.axes["track"]
        self._lift = self.axes.get("lift")
        self.metres = _METRES[spec.axes["track"].unit]
        """Metres in the track's unit of length."""
        self._linear = parameters.motion == "linear"
        self.mounted = 0, ""
        """Specimen and rubber on the arm."""
        self.turned: set[str] = set()
        """Axes that move the wrong way round: the motor's direction was never set."""
        self.swapped = False
        """Whether the drives of track and lift are swapped: each moves the other's part."""
        self.radius_mm = DISC_RADIUS_MM
        """Radius of the track on a disc, mm."""
        self._travelled_m = 0.0
        """Way of a disc's track, m."""
        self.held_switch = False
        """Whether a finger holds an end switch."""
        self.switches_work = True
        """Whether the end switches work."""
        self.beyond_switch = False
        self.hit_stop = False
        """Whether the track has hit a stop of its travel."""

    def drive(self, name: str, config: AxisConfig) -> Cia402Slave:
        p, can, serial = self.plant.parameters, self.can, config.node_id
        if name == "track" and p.motion == "linear":
            low, high = 0.0, p.travel * 1e-3 / _METRES[config.unit]
            axis = VelocityAxis(config.acceleration, config.deceleration, TRACK_LAG_S, 0.5 * high, low, high)
            return Cia402Slave(config, can, axis, serial_number=serial)
        if name == "lift":
            arm = PositionAxis(config.max_speed, config.acceleration, config.deceleration, position=self._raised_mm)
            return Cia402Slave(config, can, arm, serial_number=serial, home_position=self._raised_mm)
        return Cia402Slave(config, can, serial_number=serial, lag_s=TRACK_LAG_S)

    def own_devices(self, spec: RigSpec) -> dict[str, ModbusSlave]:
        return {name: self._device(name, spec.devices[name]) for name in OWN if name in spec.devices}

    def _device(self, name: str, device: DeviceSpec) -> ModbusSlave:
        profile, unit_id = device.profile, device.unit_id
        if name == "load_cell":
            return CellSlave(profile, unit_id, self.plant)
        if name == "chamber":
            return ControllerSlave(profile, unit_id, self.plant)
        if name == "height_sensor":
            return SensorSlave(profile, unit_id, {"height": self.plant.height_measured})
        if name == "pyrometer":
            return IrSlave(profile, unit_id, self.plant, sensor_c=self.plant.parameters.ambient)
        return IrSlave(profile, unit_id, AmbientAir(self.plant), sensor_c=self.plant.parameters.ambient)

    # -- interface to the wires -----------------------------------------------------------------------------------

    @property
    def ambient_c(self) -> float:
        """Temperature of the air around the rig, degC."""
        return self.plant.parameters.ambient

    # -- mechanics ------------------------------------------------------------------------------------------------

    @property
    def track_m_s(self) -> float:
        """Speed of the track under the specimen, m/s."""
        return self.metres * self._track.axis.value * (-1.0 if "track" in self.turned else 1.0)

    @property
    def track_mm(self) -> float:
        """Place of a linear track in its travel, mm."""
        place_mm = self._track.axis.position * self.metres * 1e3
        return self.plant.parameters.travel - place_mm if "track" in self.turned else place_mm

    @property
    def lift_mm(self) -> float:
        """Position of the arm, mm: 0 lowered."""
        return self._lift.axis.position if self._lift is not None else self.hand_mm

    def follow(self, t1: float, still: bool) -> None:
        """Advance the plant with its drives to ``t1`` s, and load the track's drive."""
        elapsed, self.plant_s = t1 - self.plant_s, t1
        chamber = self.chamber
        if not self._linear:
            self._travelled_m += self.track_m_s * elapsed
        self.plant.advance(elapsed, self.track_m_s, self.lift_mm, chamber.output if chamber is not None else 0.0)
        torque_nm = -self.plant.force_n * TRACK_LEVER_M if self._track.energised else 0.0
        if torque_nm != self._track.torque_nm:
            self._track.load(torque_nm, 0.0)
        if self._linear:
            self._look_at_the_ends()

    def _look_at_the_ends(self) -> None:
        """Open or close the end switches, and note a hit on a stop."""
        p = self.plant.parameters
        at_mm = self.track_mm
        if at_mm <= 0.0 or at_mm >= p.travel:
            self.hit_stop = True
        beyond = self.switches_work and (self.held_switch or not p.switches <= at_mm <= p.travel - p.switches)
        if beyond != self.beyond_switch:
            self.beyond_switch = beyond
            for drive in self.axes.values():
                drive.set_safety_chain(not beyond)
                drive.set_torque_off(beyond)

    @property
    def by_surface(self) -> bool:
        """Whether the friction law asks for the surface; ``take`` sets it, and the source of materials."""
        return self.plant.parameters.by_surface

    def take(self, setting: LawSetting) -> None:
        """Set the source of the materials, before a specimen is mounted."""
        self.plant.setting = setting

    # -- actions of the attendant ---------------------------------------------------------------------------------

    def install(self, specimen: int, compound: str) -> None:
        """Put specimen ``specimen`` of a rubber on the arm."""
        self.plant.install(specimen, compound)
        self.mounted = specimen, compound

    def keep(self, specimen: int, compound: str) -> None:
        """Put the specimen of an interrupted run on the arm, unless this rig has lived on with it."""
        if self.mounted != (specimen, compound):
            self.install(specimen, compound)

    def put_on(self, weights_n: float) -> None:
        """Hang calibrated weights on the arm, N."""
        self.plant.put_on(weights_n)

    def cover(self, surface: str) -> None:
        """Cover the track with a surface of this name, clean and dry."""
        self.plant.cover(surface)

    def prepare(self, interface: Interface) -> None:
        """Dry, wet or powder the track."""
        self.plant.prepare(interface)

    def raise_arm(self) -> None:
        """Raise an arm that has no drive."""
        self.hand_mm = self._raised_mm

    def lower_arm(self) -> None:
        """Lower an arm that has no drive."""
        self.hand_mm = 0.0

    # -- actions of the person who commissions ----------------------------------------------------------------------

    def ruler(self, what: str) -> float:
        """Return what an instrument shows: a linear "track" in mm, a disc in deg, the "lift" in mm downwards;
        "radius" of a disc's track, mm; "left" to the nearer end switch, mm; the arm's "load", N; "air" at the specimen,
        degC.
        """
        if what == "track":
            moved_mm = self.track_mm if self._linear else 1e3 * self._travelled_m
            other = self._lift.axis.position if self.swapped and self._lift is not None else 0.0
            moved_mm = other if self.swapped else moved_mm
            return moved_mm if self._linear else degrees(moved_mm / self.radius_mm)
        if what == "lift":
            down_mm = self.track_mm if self.swapped else -self.lift_mm
            return -down_mm if "lift" in self.turned else down_mm
        if what == "radius":
            return self.radius_mm
        if what == "left":
            p = self.plant.parameters
            return min(self.track_mm - p.switches, p.travel - p.switches - self.track_mm)
        if what == "load":
            return self.plant.weights_n + self.plant.arm_n
        if what == "air":
            return self.plant.air_c
        raise LookupError(f"no instrument shows {what}")

    def hang(self, force_n: float) -> None:
        """Let a weight pull the arm over a pulley, N, above 0 in the direction of the track; 0 takes it off."""
        self.plant.hung_n = force_n

    def gauge(self, block_mm: float | None) -> None:
        """Put the arm down by hand on a gauge block between specimen and track, mm; None: take the block away."""
        self.plant.block_mm = block_mm

    def hold_switch(self, held: bool) -> None:
        """Hold an end switch by a finger, or let it go."""
        self.held_switch = held
        if self._linear:
            self._look_at_the_ends()

    def begin_repeat(self, condition: int, repeat: int, attempt: int) -> None:
        """Restart the random streams and the sensors' dither for a repeat."""
        self.plant.begin_repeat(condition, repeat, attempt)
        self.restart_dither()
