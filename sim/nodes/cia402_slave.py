"""A simulated CiA 402 servo drive: it answers on the wire like a real one and moves a simulated axis.

Built in layers: ``canopen_device`` (CiA 301), ``drive_power`` (power state machine), ``drive_modes`` (velocity,
position, homing), ``drive_objects`` (readers, guards and effects of the profile's objects).
"""

from __future__ import annotations

import struct
from math import floor, inf
from typing import Final

from drivers import cia402
from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.objects import OperationMode
from drivers.canopen.pdo import RPDO1_VELOCITY, TPDO1_POSITION, TPDO1_VELOCITY
from drivers.cia402 import State
from drivers.process_data import mode_of
from sim.nodes import drive_objects
from sim.nodes.drive_modes import InverterVelocity, ProfileVelocity
from sim.nodes.drive_objects import clamped_i16, wrapped_i32
from sim.nodes.drive_positioning import Homing, ProfilePosition
from sim.nodes.drive_power import FAULTY, Axis, DrivePower
from sim.nodes.motion import PositionAxis, VelocityAxis
from sim.nodes.object_store import ObjectStore
from sim.nodes.pdo_channels import ReceivePdo, TransmitPdo
from sim.wires.can_wire import CanWire

_CONTROLWORD: Final = (o.CONTROLWORD, 0)
_OUTPUTS: Final = (o.DIGITAL_OUTPUTS, 1)
_OUTPUT_MASK: Final = (o.DIGITAL_OUTPUTS, 2)
_NO_MASK: Final = 0xFFFF_FFFF
_OPERATING: Final = State.OPERATION_ENABLED  # bound once: a look-up on the enum class costs several times as much
_TARGET_VELOCITY: Final = (o.TARGET_VELOCITY, 0)
_MAX_TORQUE: Final = (o.MAX_TORQUE, 0)

_RPDO1: Final = struct.Struct("<Hi").unpack
_TPDO1: Final = struct.Struct("<Hih").pack

_URGENT_BITS: Final = 0x006F | cia402.VOLTAGE | cia402.REMOTE | cia402.FOLLOWING_ERROR
"""Statusword bits whose change asks for an early tick: the state, voltage, remote, deviation."""
_URGENT_IN_POSITION_MODES: Final = _URGENT_BITS | cia402.TARGET_REACHED | cia402.SET_POINT_ACKNOWLEDGED
"""... and in a move, its acknowledgement and its end."""


class Cia402Slave(DrivePower):
    """One servo drive with its axis.

    For the plant: ``axis.value`` (velocity) and ``axis.position`` are in units of the axis. ``torque_nm`` is the load
    torque for 0x6077 with the error of its measuring (``torque_gain``, ``torque_offset_nm``), set from outside,
    ``torque_limit_nm`` the true torque at the limit of 0x6072 and
    ``encoder_error`` the error of TPDO1's reading. ``io`` are the safety inputs and the contactor of a drive with
    digital I/O. While the power stage is off the axis is driven to ``unpowered_velocity`` (unit/s; a spring; 0: it
    coasts to rest) with ``coast_deceleration`` (unit/s2; by default the configured deceleration [A]).
    """

    __slots__ = (
        "_by_position", "_increments", "_mode_bits", "_offset", "_per_mille", "_remote_bit", "_velocity", "homed",
        "homing",
        "torque_limit_nm",
    )  # fmt: skip

    def __init__(
        self,
        config: AxisConfig,
        wire: CanWire,
        axis: Axis | None = None,
        *,
        serial_number: int = 0,
        unpowered_velocity: float = 0.0,
        coast_deceleration: float | None = None,
        home_position: float = 0.0,
        lag_s: float = 0.004,
        boot_s: float = 0.2,
        turnaround_s: float = 0.0005,
        powered: bool = True,
        now: float = 0.0,
    ) -> None:
        """Build a drive for ``config`` on ``wire``; it boots ``boot_s`` after ``now`` unless not ``powered``.

        ``axis``: by default an axis at rest at 0 with the ramps of ``config`` and, under velocity control, the closed
        loop's ``lag_s`` (s) [A]. ``home_position``: position of a positioning axis' home switch (axis unit).
        ``turnaround_s`` (s): from an SDO request to its answer [A].
        """
        entries = drive_objects.entries(config)
        store = ObjectStore(config.node_id, drive_objects.overrides(config, serial_number), entries)
        axis = drive_objects.default_axis(config, lag_s) if axis is None else axis
        super().__init__(config, wire, store, axis, boot_s, turnaround_s, now)
        self.unpowered_velocity = unpowered_velocity
        self.coast_deceleration = config.deceleration if coast_deceleration is None else coast_deceleration
        self.homed = False
        self.homing: Homing | None = None
        self._velocity: ProfileVelocity | None = None
        self._add_modes(axis, home_position)
        self._mode_bits = 0
        self._by_position = config.feedback == "position"
        self._increments = config.position_increments if self._by_position else config.velocity_increments
        self._per_mille = 1000.0 / config.rated_torque_nm * config.drive.units.torque
        self._remote_bit = cia402.REMOTE if config.drive.remote else 0
        self.torque_limit_nm = 0.0
        store.hooks[o.MAX_TORQUE] = self._on_max_torque
        drive_objects.install(self)
        self._application_reset()
        self.power(powered)

    def _add_modes(self, axis: Axis, home_position: float) -> None:
        """Add the modes of operation of this sort of axis."""
        if isinstance(axis, PositionAxis):
            self.homing = Homing(self, axis, home_position)
            self.modes = {
                OperationMode.PROFILE_POSITION: ProfilePosition(self, axis),
                OperationMode.HOMING: self.homing,
            }
        else:
            made = InverterVelocity if self.config.drive.inverter else ProfileVelocity
            self._velocity = made(self, axis)
            self.modes = {mode_of(self.config): self._velocity}

    # time ----------------------------------------------------------------------------------------------------

    def advance(self, t0: float, t1: float) -> None:
        while self.due_s <= t1:
            t = self.due_s
            if t > t0:
                self.move(t0, t)
                t0 = t
            self.fire(t0)
        if self.watching:
            self.move(t0, t1)
            return
        if not self.axis.still:
            self.axis.step(t1 - t0)
            self.pdos.stale = True
        self.now_s = t1

    def move(self, t0: float, t1: float) -> None:
        """Step the axis from ``t0`` to ``t1`` s, without a timer, and update the drive's state for its motion."""
        axis, mode = self.axis, self.mode
        if not axis.still:
            axis.step(t1 - t0)
            self.pdos.stale = True
        self.now_s = t1
        if self._leaving is None and mode is not None:  # as ``_watch``, without the call: nearly always
            self.watching = mode.watch(t1, self.state is _OPERATING)
            if mode.bits != self._mode_bits:
                self.update(t1)
            return
        if self._leaving is not None and self._at_rest():
            self._arrived_at_rest()
            self.update(t1)
        self._watch(t1)

    def _watch(self, t: float) -> None:
        """Update the statusword for the axis' motion."""
        mode = self.mode
        if mode is None:
            self.watching = self._leaving is not None
            return
        leaving = self._leaving is not None
        self.watching = mode.watch(t, self.state is _OPERATING and not leaving) or leaving
        if mode.bits != self._mode_bits:
            self.update(t)

    def _application_due(self) -> float:
        return inf if self.io is None else self.io.due_s

    def _application_fire(self, t: float) -> None:
        if self.io is not None and self.io.fire(t):
            self.pdos.send_events(t)

    # surroundings of the drive -------------------------------------------------------------------------------

    def load(self, torque_nm: float, encoder_error: float) -> None:
        """Put a torque on the shaft (N m) and an error on the encoder's reading (units of the axis)."""
        self.torque_nm = self.torque_gain * torque_nm + self.torque_offset_nm
        self.encoder_error = encoder_error
        self.pdos.stale = True

    def misread_torque(self, gain: float, offset_nm: float) -> None:
        """Measure the torque with a gain (above 0) and an offset (N m) from now on; 1 and 0 is right."""
        true_nm = (self.torque_nm - self.torque_offset_nm) / self.torque_gain
        self.torque_gain, self.torque_offset_nm = gain, offset_nm
        self._on_max_torque(0, self.store.values[_MAX_TORQUE])
        self.load(true_nm, self.encoder_error)

    def _on_max_torque(self, sub: int, value: int) -> None:
        """Find the true torque at the limit of 0x6072, ``value``: the drive limits the torque that it measures."""
        self.torque_limit_nm = (value / self._per_mille - self.torque_offset_nm) / self.torque_gain

    def stall(self, position: float) -> None:
        """Stand at ``position`` (axis unit) with the torque limit of 0x6072; bit 11 shows it until ``unstall``."""
        if isinstance(self.axis, VelocityAxis):
            self.axis.stall(position)
        self._at_torque_limit(True)

    def unstall(self) -> None:
        """Follow the demand again."""
        self._at_torque_limit(False)

    def _at_torque_limit(self, limited: bool) -> None:
        if self._velocity is not None:
            self._velocity.at_torque_limit = limited
        self.watching = True
        self.pdos.stale = True

    def set_safety_chain(self, healthy: bool) -> None:
        """Set input bit 16; an open chain lets the contactor drop out."""
        if self.io is not None:
            self.io.set_chain(healthy, self.now_s)
            self.pdos.send_events(self.now_s)

    def set_guard(self, closed: bool) -> None:
        """Set input bit 17: the guard is closed."""
        if self.io is not None:
            self.io.set_guard(closed)
            self.pdos.send_events(self.now_s)

    def block(self, blocked: bool) -> None:
        """Hold the shaft by force, or free it: the drive notices the standstill at once."""
        self.axis.block(blocked)
        self._watch(self.now_s)
        self.watching = True

    # commands ------------------------------------------------------------------------------------------------

    def process(self, t: float) -> None:
        """Act on controlword, mode, targets and outputs in the object store."""
        values = self.store.values
        controlword = values[_CONTROLWORD]
        if self.io is not None:
            mask = values[_OUTPUT_MASK] if _OUTPUT_MASK in self.store.entries else _NO_MASK
            self._switch_outputs(self.config.io.outputs_meant(values[_OUTPUTS] & mask), t)
        if self.local:
            return
        self.select_mode(values[(o.MODE, 0)])
        self._command(controlword, t)
        mode = self.mode
        if mode is not None:
            self._steady = self.state is _OPERATING and self._leaving is None
            if self._steady:
                mode.follow(controlword, t)
            else:
                mode.note(controlword)
        self.watching = True
        self.update(t)

    def _take_velocity(self, data: bytes, t: float) -> None:
        """Apply controlword and target velocity; in steady operation only the target can be new."""
        fields: tuple[int, int] = _RPDO1(data)
        controlword, target = fields
        values = self.store.values
        values[_TARGET_VELOCITY] = target
        if self._steady and controlword == self._controlword and self._velocity is not None:
            self._velocity.retarget(target)
            self.watching = True
        else:
            values[_CONTROLWORD] = controlword
            self.process(t)

    def _application_reset(self) -> None:
        """Reset to power-on: no torque, no mode, position counted from here unless the encoder is absolute."""
        self.mode = None
        self.reload_ramps()
        self._on_max_torque(0, self.store.values[_MAX_TORQUE])
        self._controlword = 0
        self._power_stage_off(State.NOT_READY)
        if self.config.mode == "position":
            self.homed = False
            self.origin = self.axis.position
        self._forget_sample()
        self._drop_outputs(self.now_s)
        self.update(self.now_s)

    def _application_ready(self, t: float) -> None:
        if self.state is State.NOT_READY:
            self.state = State.SWITCH_ON_DISABLED
        self.update(t)
        for code in self._causes:
            self.fault(code)

    # readings ------------------------------------------------------------------------------------------------

    def set_home(self) -> None:
        """Make the present position the home position: the zero position lies 0x607C beyond it (CiA 402-2, 8.3)."""
        offset = self.store.values[(o.HOME_OFFSET, 0)]
        self.origin = self.axis.position + offset / self.config.position_increments
        self.homed = True
        self._forget_sample()

    def counts_to_position(self, counts: int) -> float:
        """Return the machine position (axis unit) of a position in counts."""
        return counts / self.config.position_increments + self.origin

    def update(self, t: float) -> None:
        """Compose the statusword; a change goes into the TPDOs, a change of state asks for an early tick."""
        state = self.state
        word = cia402.STATUS_BITS[state]
        urgent = _URGENT_BITS
        mode = self.mode
        self._mode_bits = 0
        if mode is not None:
            self._mode_bits = mode.bits
            word |= mode.bits
            if not isinstance(mode, ProfileVelocity):
                urgent = _URGENT_IN_POSITION_MODES
        if state is State.QUICK_STOP_ACTIVE and self._leaving is None:
            word |= cia402.TARGET_REACHED
        if not self.torque_off:
            word |= cia402.VOLTAGE
        if not self.local:
            word |= self._remote_bit
        if self.emergencies.present and state not in FAULTY:
            word |= cia402.WARNING
        if word != self.statusword:
            if (word ^ self.statusword) & urgent:
                self.pdos.make_urgent()
            self.statusword = word
            self.pdos.stale = True
            self.pdos.status_changed(t)

    def prepare_source(self, pdo: TransmitPdo) -> None:
        usual = TPDO1_POSITION if self._by_position else TPDO1_VELOCITY
        if pdo.fields == usual.fields:
            pdo.source = self._sample

    def prepare_sink(self, pdo: ReceivePdo) -> None:
        if pdo.fields == RPDO1_VELOCITY.fields:
            pdo.sink = self._take_velocity

    def _forget_sample(self) -> None:
        self._offset = self.origin if self._by_position else 0.0
        self.pdos.stale = True

    def _sample(self) -> bytes:
        """Return statusword, actual value and torque packed; the wire asks only after one of them may have changed."""
        axis, pdos = self.axis, self.pdos
        value = (axis.position if self._by_position else axis.value) + self.encoder_error
        counts = floor((value - self._offset) * self._increments + 0.5)
        per_mille = floor(self.torque_nm * self._per_mille + 0.5)
        try:
            data = _TPDO1(self.statusword, counts, per_mille)
        except struct.error:
            data = _TPDO1(self.statusword, wrapped_i32(counts), clamped_i16(per_mille))
        pdos.sample = data
        pdos.stale = False
        return data
