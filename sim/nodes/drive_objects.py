"""Readers, guards and effects of the simulated drive's profile objects (0x6000-0x6FFF)."""

from __future__ import annotations

from collections.abc import Mapping

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen import sdo
from drivers.canopen.dictionary import DICTIONARY, Entry
from drivers.canopen.objects import OperationMode
from drivers.cia402 import State
from drivers.drives.drive_model import Substitute
from drivers.drives.reader import GENERIC
from drivers.process_data import mode_of
from sim.nodes.drive_power import DrivePower
from sim.nodes.motion import PositionAxis, VelocityAxis
from sim.nodes.object_store import Key, SdoAbortError

_OPTIONS: dict[int, tuple[int, ...]] = {
    o.ABORT_CONNECTION_OPTION: (0, 1, 2, 3),
    o.QUICK_STOP_OPTION: (0, 1, 2, 5, 6),
    o.SHUTDOWN_OPTION: (0, 1),
    o.DISABLE_OPERATION_OPTION: (0, 1),
    o.HALT_OPTION: (1, 2),
    o.FAULT_REACTION_OPTION: (0, 1, 2),
    o.HOMING_METHOD: (0, 1, 2, *range(17, 31), 33, 34, 35, 37),
}
"""Accepted values; drives support subsets of the standard's."""

_RATES = (
    o.PROFILE_ACCELERATION,
    o.PROFILE_DECELERATION,
    o.QUICK_STOP_DECELERATION,
    o.HOMING_ACCELERATION,
    o.VL_ACCELERATION,
    o.VL_DECELERATION,
    o.VL_QUICK_STOP,
)
_RAMP_OBJECTS = (
    *_RATES,
    o.HALT_OPTION,
    o.MAX_MOTOR_SPEED,
    o.MAX_PROFILE_VELOCITY,
    o.VL_MIN_MAX,
    o.MAX_SLIPPAGE,
    o.VELOCITY_WINDOW,
    o.VELOCITY_WINDOW_TIME,
    o.VELOCITY_THRESHOLD,
    o.VELOCITY_THRESHOLD_TIME,
    o.POSITION_WINDOW,
    o.POSITION_WINDOW_TIME,
    o.FOLLOWING_ERROR_WINDOW,
    o.FOLLOWING_ERROR_TIME,
)
_COMMANDS = (o.CONTROLWORD, o.MODE, o.TARGET_VELOCITY, o.VL_TARGET_VELOCITY, o.TARGET_POSITION, o.DIGITAL_OUTPUTS)


def entries(config: AxisConfig) -> Mapping[Key, Entry]:
    """Return the objects of a drive with the axis' profile."""
    return DICTIONARY if config.profile == GENERIC else config.drive.dictionary()


def overrides(config: AxisConfig, serial_number: int) -> dict[Key, int | str]:
    """Return the dictionary values of this axis' drive: identity, ratings, modes."""
    modes = 1 << (mode_of(config) - 1)
    if config.mode == "position":
        modes |= 1 << (OperationMode.HOMING - 1)
    return {
        (o.IDENTITY, 1): config.vendor_id,
        (o.IDENTITY, 2): config.product_code,
        (o.IDENTITY, 4): serial_number or config.serial_number or config.node_id,
        (o.RATED_TORQUE, 0): round(config.rated_torque_counts),
        (o.SUPPORTED_MODES, 0): modes,
    }


def default_axis(config: AxisConfig, lag_s: float) -> VelocityAxis | PositionAxis:
    """Return an axis at rest at 0 that moves as configured; ``lag_s`` (s) is for its velocity loop."""
    if config.mode == "position":
        return PositionAxis(config.max_speed, config.acceleration, config.deceleration)
    return VelocityAxis(config.acceleration, config.deceleration, lag_s)


def install(drive: DrivePower) -> None:
    """Connect the drive's objects with their readers, guards and effects."""
    _Objects(drive)


class _Objects:
    """Readers, guards and hooks of one drive's objects."""

    def __init__(self, drive: DrivePower) -> None:
        self._drive = drive
        store = drive.store
        store.readers.update(
            {
                (o.STATUSWORD, 0): self._statusword,
                (o.MODE_DISPLAY, 0): self._mode_display,
                (o.POSITION_ACTUAL, 0): self._position,
                (o.FOLLOWING_ERROR, 0): self._following_error,
                (o.VELOCITY_DEMAND, 0): self._demand,
                (o.VELOCITY_ACTUAL, 0): self._velocity,
                (o.VL_VELOCITY_DEMAND, 0): self._inverter_demand,
                (o.VL_VELOCITY_ACTUAL, 0): self._inverter_velocity,
                (o.TORQUE_ACTUAL, 0): self._torque,
                (o.CURRENT_ACTUAL, 0): self._torque,
                (o.DIGITAL_INPUTS, 0): self._inputs,
            }
        )
        for index, values in _OPTIONS.items():
            store.guards[index] = _Choice(values).check
        for index in _RATES:
            store.guards[index] = self._guard_rate
        store.guards[o.MODE] = self._guard_mode
        store.guards[o.CONTROLWORD] = self._guard_control
        for index in _RAMP_OBJECTS:
            store.hooks[index] = self._on_ramp
        for index in _COMMANDS:
            store.hooks[index] = self._on_command
        for key, one in drive.config.drive.substitutes.items():
            store.hooks[one.key[0]] = _Stands(drive, key, one).on_write

    # readers -------------------------------------------------------------------------------------------------

    def _statusword(self) -> int:
        return self._drive.statusword

    def _mode_display(self) -> int:
        return self._drive.mode_display

    def _position(self) -> int:
        drive = self._drive
        return wrapped_i32((drive.axis.position - drive.origin) * drive.config.position_increments)

    def _following_error(self) -> int:
        drive = self._drive
        if isinstance(drive.axis, VelocityAxis):
            return 0
        return wrapped_i32((drive.axis.demand - drive.axis.position) * drive.config.position_increments)

    def _demand(self) -> int:
        drive = self._drive
        demand = drive.axis.demand if isinstance(drive.axis, VelocityAxis) else drive.axis.value
        return wrapped_i32(demand * drive.config.velocity_increments)

    def _velocity(self) -> int:
        drive = self._drive
        return wrapped_i32(drive.axis.value * drive.config.velocity_increments)

    def _inverter_demand(self) -> int:
        return clamped_i16(self._demand())

    def _inverter_velocity(self) -> int:
        drive = self._drive
        return clamped_i16((drive.axis.value + drive.encoder_error) * drive.config.velocity_increments)

    def _torque(self) -> int:
        drive = self._drive
        return clamped_i16(drive.torque_nm * 1000.0 / drive.config.rated_torque_nm * drive.config.drive.units.torque)

    def _inputs(self) -> int:
        io = self._drive.io
        return 0 if io is None else self._drive.config.io.inputs_shown(io.inputs)

    # guards --------------------------------------------------------------------------------------------------

    def _guard_rate(self, sub: int, value: int) -> None:
        if value == 0:
            raise SdoAbortError(sdo.VALUE_TOO_LOW)

    def _guard_mode(self, sub: int, value: int) -> None:
        drive = self._drive
        if value and value not in drive.modes:
            raise SdoAbortError(sdo.VALUE_RANGE)
        if value != drive.mode_display and not drive.axis.still:
            raise SdoAbortError(sdo.DEVICE_STATE)

    def _guard_control(self, sub: int, value: int) -> None:
        if self._drive.local:
            raise SdoAbortError(sdo.LOCAL_CONTROL)
        if self._drive.state is State.NOT_READY:
            raise SdoAbortError(sdo.DEVICE_STATE)

    # effects -------------------------------------------------------------------------------------------------

    def _on_ramp(self, sub: int, value: int) -> None:
        self._drive.reload_ramps()
        self._drive.process(self._drive.now_s)

    def _on_command(self, sub: int, value: int) -> None:
        self._drive.process(self._drive.now_s)


class _Stands:
    """Effect of a maker's object that replaces a standard object."""

    def __init__(self, drive: DrivePower, standard: Key, one: Substitute) -> None:
        self._drive = drive
        self._standard = standard
        self._one = one

    def on_write(self, sub: int, value: int) -> None:
        """Write the value into the standard object, inside the drive."""
        one, store = self._one, self._drive.store
        if sub == one.key[1]:
            reference = 0 if one.per_mille_of is None else store.values[one.per_mille_of]
            if reference or one.per_mille_of is None:
                store.write(*self._standard, one.standard(value, reference))


class _Choice:
    """A guard for an object with a few accepted values."""

    def __init__(self, values: tuple[int, ...]) -> None:
        self._values = values

    def check(self, sub: int, value: int) -> None:
        """Refuse every other value."""
        if value not in self._values:
            raise SdoAbortError(sdo.VALUE_RANGE)


def wrapped_i32(counts: float) -> int:
    """Return counts rounded to an I32: a position counter wraps around."""
    return (round(counts) + 0x8000_0000) % 0x1_0000_0000 - 0x8000_0000


def clamped_i16(value: float) -> int:
    """Return a value rounded and limited to the range of an I16."""
    return max(-0x7FFF, min(0x7FFF, round(value)))
