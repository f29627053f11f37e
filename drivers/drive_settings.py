"""The objects and values that an axis needs in its drive, and the treatment of objects that the drive lacks.

Pure functions. From the axis' configuration and the absent objects they derive the writes, the objects that are
dispensable (and the loss without each), and the refusals. Connecting (drivers.servo_setup), the check of a data sheet
(drivers.canopen.data_sheet) and lists of a drive's parameters all use this module.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Final

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen import pdo
from drivers.canopen.dictionary import describe
from drivers.canopen.objects import DataType
from drivers.drives.drive_model import Key, Substitute
from drivers.process_data import PdoSetting, pdo_settings

ABORT_CONNECTION_QUICK_STOP: Final = 3     # 0x6007: heartbeat lost -> quick stop
NO_STATE_CHANGE: Final = 1                 # 0x1029:01: a communication error leaves the NMT state as it is
STATUS_INHIBIT_100_US: Final = 50          # 0x1801:03: 5 ms between two statuswords sent by themselves [A]
UNIT_DENOMINATOR: Final = 1000
"""Greatest denominator of 0x604C [A]: units are whole r/min, or tenths to thousandths of it."""
RATED_TORQUE_SHARE: Final = 0.02
"""Greatest relative difference of 0x6076 from the rig file: it is entered rounded, from a nameplate [A]."""

_DEADLINE: Final = (o.RPDO_COMMUNICATION, 5)
_WATCH: Final = (o.CONSUMER_HEARTBEAT, 1)
_MASK: Final = (o.DIGITAL_OUTPUTS, 2)
_INPUTS_TIMER: Final = (o.TPDO_COMMUNICATION + 1, 5)

LOST: Final[Mapping[Key, str]] = {
    (o.SYNC_PERIOD, 0): "",
    (o.ERROR_BEHAVIOUR, 1): "",
    (o.SHUTDOWN_OPTION, 0): "",         # never sent from operation
    (o.DISABLE_OPERATION_OPTION, 0): "how the axis slows down when it is disabled is the drive's own",
    (o.HALT_OPTION, 0): "how the axis slows down on halt is the drive's own",
    (o.VL_MIN_MAX, 1): "the drive's own setting decides below which speed the axis does not turn",
    (o.VL_MIN_MAX, 2): "the drive limits its speed by its own setting only; the PC limits what it asks for",
    (o.VL_DIMENSION_FACTOR, 1): "",     # its speeds are in the profile's target_rpm by themselves
    (o.VL_DIMENSION_FACTOR, 2): "",
    (o.MAX_MOTOR_SPEED, 0): "the drive limits its speed by its own setting only; the PC limits what it asks for",
    (o.SOFTWARE_LIMIT, 1): "the drive has no least position; the PC limits what it asks for",
    (o.SOFTWARE_LIMIT, 2): "the drive has no greatest position; the PC limits what it asks for",
    (o.POSITION_WINDOW, 0): "the drive's own setting decides within which window a position counts as reached",
    (o.VELOCITY_THRESHOLD, 0): "the drive's own setting decides below which speed the axis is at rest",
    (o.VELOCITY_THRESHOLD_TIME, 0): "the drive's own setting decides for how long it has to be slow",
    (o.TPDO_COMMUNICATION + 1, 3): "a statusword that chatters is not held back on the bus",
    _MASK: "the drive sets every output by 0x60FE:01",
    _INPUTS_TIMER: "the digital inputs come with every SYNC instead",
    (o.HOME_OFFSET, 0): "the home switch is at position 0",
    (o.RATED_TORQUE, 0): "the drive does not report its rated torque: the rig file's counts",
}
"""Objects that a profile may call missing, and the loss without each; "" = nothing. Any other missing object is
refused, unless ``_Planner`` has a replacement for it."""


USED: Final = frozenset({*LOST, _DEADLINE, (o.MAX_TORQUE, 0)})
"""Objects that are used if present; some axes can do without them."""


@dataclass(frozen=True, slots=True)
class Setting:
    """One write; only bits of ``mask`` have to read back. ``per_mille_of``: see
    drivers.drives.drive_model.Substitute."""

    index: int
    sub: int
    value: int
    type: DataType | None = None
    substitute: Substitute | None = None
    name: str = ""

    @property
    def key(self) -> Key:
        """Address of the object."""
        return self.index, self.sub


@dataclass(slots=True)
class DrivePlan:
    """The writes at the connect of an axis, the objects that its drive lacks, and the reasons to refuse it."""

    settings: list[Setting] = field(default_factory=list[Setting])
    pdos: list[PdoSetting] = field(default_factory=list[PdoSetting])
    homing: list[Setting] = field(default_factory=list[Setting])
    watched: bool = True
    """Whether 0x1016 is armed."""
    rated_torque: bool = True
    """Whether 0x6076 is read and compared."""
    without: list[str] = field(default_factory=list[str])
    """Each missing object, and the loss without it, in one sentence."""
    refused: list[str] = field(default_factory=list[str])


def plan(config: AxisConfig, absent: Collection[Key] = ()) -> DrivePlan:
    """Return the plan for an axis; ``absent``: objects that the drive lacks besides those that its profile lists."""
    return _Planner(config, frozenset(absent)).plan()


def tried(config: AxisConfig) -> tuple[Key, ...]:
    """Return the objects to ask the drive for before the plan is made: some drives of the make lack them."""
    silent = (o.SYNC_PERIOD, 0), (o.ERROR_BEHAVIOUR, 1)
    return tuple(sorted(key for key in config.drive.optional if key not in silent))


class _Planner:
    """The plan of one axis while it is made."""

    def __init__(self, config: AxisConfig, absent: frozenset[Key]) -> None:
        self.config = config
        self.profile = config.drive
        self.absent = absent
        self.made = DrivePlan()

    def lacks(self, *key: int) -> bool:
        """Return whether the drive lacks an object."""
        index, sub = key
        return (index, sub) in self.absent or self.profile.lacks((index, sub))

    def plan(self) -> DrivePlan:
        """Return the finished plan."""
        made, config = self.made, self.config
        for parameter in self._parameters():
            made.settings.append(parameter)
        for index, sub, value in _settings(config):
            self._take(made.settings, index, sub, value)
        if config.feedback == "position":
            before = len(made.without), len(made.refused)
            for index, sub, value in _homing(config):
                self._take(made.homing, index, sub, value)
            if config.mode != "position":        # no homing during a run
                del made.without[before[0]:], made.refused[before[1]:]
        self._watches()
        self._torque()
        self._bits()
        made.pdos = list(self._pdos())
        return made

    def _parameters(self) -> Iterator[Setting]:
        for name, one in self.profile.parameters.items():
            value = self.config.parameters.get(name, one.value)
            if value is not None:
                yield Setting(*one.key, round(value), one.type, None, name.replace("_", " "))

    def _take(self, settings: list[Setting], index: int, sub: int, value: int) -> None:
        """Add one write or its substitute, or note the refusal."""
        key = index, sub
        if not self.lacks(index, sub):
            settings.append(Setting(index, sub, self.profile.options.get(key, value)))
            return
        instead = self.profile.substitutes.get(key)
        if instead is not None:
            settings.append(Setting(*instead.key, value, instead.type, instead, f"in place of {describe(*key)}"))
        elif key == (o.HOME_OFFSET, 0) and value:
            self._refuse(key, "the rig file has a home_offset")
        elif key in LOST:
            self._lose(key, LOST[key])
        elif key not in (_DEADLINE, (o.MAX_TORQUE, 0)):      # see _watches, _torque
            self._refuse(key, "nothing replaces it")

    def _lose(self, key: Key, lost: str) -> None:
        if lost:
            self.made.without.append(f"no {describe(*key)}: {lost}")

    def _refuse(self, key: Key, why: str) -> None:
        """Note a refusal once for each object, with the first reason."""
        absent = f"{describe(*key)}: the drive does not have it"
        if not any(text.startswith(absent) for text in self.made.refused):
            self.made.refused.append(f"{absent}; {why}")

    def _watches(self) -> None:
        """Make the drive stop without the PC: it watches the PC's heartbeat, or else the arrival of its setpoints."""
        deadline = self.config.rpdo_deadline_s > 0.0 and not self.lacks(*_DEADLINE)
        self.made.watched = not self.lacks(*_WATCH)
        if not self.made.watched and not deadline:
            self._refuse(_WATCH, "and no RPDO deadline (0x1400:05, rpdo_deadline): it would run on without the PC")
        elif not self.made.watched:
            self._lose(_WATCH, "only the setpoints are watched, by 0x1400:05; it cannot be stopped by silence alone")
            if self.config.proves_watchdog:
                self._refuse(_WATCH, "the proof at arming needs it: proves_watchdog: false")
        elif self.config.rpdo_deadline_s > 0.0 and not deadline:
            self._lose(_DEADLINE, "a PC that sends heartbeats but no setpoints is not noticed by the drive; "
                                  "its heartbeat is watched by 0x1016")

    def _torque(self) -> None:
        """Refuse a press without a torque limit, because it caps the force whatever the load cell shows."""
        key = o.MAX_TORQUE, 0
        if not self.profile.torque:
            self.made.rated_torque = False
            self._lose((o.TORQUE_ACTUAL, 0), "the drive does not report its torque")
        elif self.lacks(o.RATED_TORQUE, 0):
            self.made.rated_torque = False
            self._lose((o.RATED_TORQUE, 0), LOST[o.RATED_TORQUE, 0])
        if not self.lacks(*key) or key in self.profile.substitutes:
            return
        if self.config.screw is not None:
            self._refuse(key, "nothing replaces it, and the torque limit caps the force of this axis")
        else:
            self._lose(key, "the drive limits its torque by its own setting only")

    def _bits(self) -> None:
        if not self.profile.remote:
            self.made.without.append("no statusword bit 9: that a person has taken the drive into local control at its "
                                     "keypad is not seen")
        if self.config.speed_zero and not self.profile.standstill:
            self.made.without.append("no statusword bit 12 for standstill: it is seen with the next SYNC, not at once")

    def _pdos(self) -> Iterator[PdoSetting]:
        limits = self.profile.pdo
        for one in pdo_settings(self.config, inputs_with_sync=self.lacks(*_INPUTS_TIMER)):
            if one.mapped is not None:
                name = describe(one.mapping, 0)
                if len(one.mapped.fields) > limits.entries:
                    self.made.refused.append(
                        f"{name}: the drive takes {limits.entries} objects, {len(one.mapped.fields)} are needed")
                if one.kind == pdo.SYNCHRONOUS and not limits.synchronous:
                    kind = describe(one.communication, 2)
                    self.made.refused.append(f"{kind}: the drive has no type 1, with every SYNC")
                for index, sub, _ in one.mapped.fields:
                    if self.lacks(index, sub):
                        self._refuse((index, sub), "it is needed in a PDO")
            yield one


def _settings(config: AxisConfig) -> Iterator[tuple[int, int, int]]:
    """Yield (index, sub-index, value) of the drive parameters that follow from the configuration."""
    rate = config.acceleration_counts
    yield o.ABORT_CONNECTION_OPTION, 0, ABORT_CONNECTION_QUICK_STOP
    yield o.QUICK_STOP_OPTION, 0, 2             # quick stop ramp, then SWITCH_ON_DISABLED
    yield o.SHUTDOWN_OPTION, 0, 0               # power off; never sent from operation
    yield o.DISABLE_OPERATION_OPTION, 0, 1      # slow down ramp, then power off
    yield o.HALT_OPTION, 0, 1                   # slow down ramp, stay enabled
    yield o.FAULT_REACTION_OPTION, 0, 2         # quick stop ramp
    if config.drive.inverter:
        yield from _velocity_mode(config)
    else:
        yield o.PROFILE_ACCELERATION, 0, round(config.acceleration * rate)
        yield o.PROFILE_DECELERATION, 0, round(config.deceleration * rate)
        yield o.QUICK_STOP_DECELERATION, 0, round(config.quick_stop_deceleration * rate)
    yield o.MAX_TORQUE, 0, round(config.max_torque_per_mille * config.drive.units.torque)
    if not config.drive.inverter:
        yield o.MAX_MOTOR_SPEED, 0, round(config.max_speed * config.max_speed_counts)
    if config.mode == "position":
        yield o.PROFILE_VELOCITY, 0, round(config.max_speed * config.profile_speed_counts)
        if config.software_limits is not None:
            low, high = config.software_limits
            yield o.SOFTWARE_LIMIT, 1, round(low * config.position_increments)
            yield o.SOFTWARE_LIMIT, 2, round(high * config.position_increments)
        if config.position_window:
            yield o.POSITION_WINDOW, 0, round(config.position_window * config.position_increments)
    if config.standstill_by_pdo:
        threshold = config.velocity_increments * config.drive.units.threshold
        yield o.VELOCITY_THRESHOLD, 0, round(config.speed_zero * threshold)
        yield o.VELOCITY_THRESHOLD_TIME, 0, 0
        # 65 bits in 5 ms: a statusword that changes all the time takes 3 % of a 500 kbit/s bus.
        yield o.TPDO_COMMUNICATION + 1, 3, STATUS_INHIBIT_100_US
    if config.digital_io:
        yield o.DIGITAL_OUTPUTS, 2, config.io.mask
        yield o.DIGITAL_OUTPUTS, 1, 0
        # An event is sent once, and a lost frame is not repeated: frames by timer show that the inputs still arrive.
        yield o.TPDO_COMMUNICATION + 1, 5, round(config.inputs_period_s * 1000)
    if config.rpdo_deadline_s:
        yield o.RPDO_COMMUNICATION, 5, round(config.rpdo_deadline_s * 1000)


def _velocity_mode(config: AxisConfig) -> Iterator[tuple[int, int, int]]:
    """Yield (index, sub-index, value) of an inverter's unit, limits and ramps; a ramp is counts in one second."""
    unit = Fraction(config.drive.units.target_rpm).limit_denominator(UNIT_DENOMINATOR)
    yield o.VL_DIMENSION_FACTOR, 1, unit.numerator
    yield o.VL_DIMENSION_FACTOR, 2, unit.denominator
    # With a least speed above 0 the axis would turn at a target of 0.
    yield o.VL_MIN_MAX, 1, 0
    yield o.VL_MIN_MAX, 2, round(config.max_speed * config.max_speed_counts)
    rate = config.acceleration_counts
    ramps = (
        (o.VL_ACCELERATION, config.acceleration), (o.VL_DECELERATION, config.deceleration),
        (o.VL_QUICK_STOP, config.quick_stop_deceleration),
    )  # fmt: skip
    for index, value in ramps:
        yield index, 1, round(value * rate)
        yield index, 2, 1


def _homing(config: AxisConfig) -> Iterator[tuple[int, int, int]]:
    """Yield (index, sub-index, value) of the homing parameters."""
    per = config.profile_speed_counts
    yield o.HOMING_METHOD, 0, config.homing_method
    yield o.HOMING_SPEED, 1, round((config.homing_speed or config.max_speed / 5) * per)
    yield o.HOMING_SPEED, 2, round((config.homing_zero_speed or config.max_speed / 20) * per)
    yield o.HOMING_ACCELERATION, 0, round(config.acceleration * config.acceleration_counts)
    yield o.HOME_OFFSET, 0, round(config.home_offset * config.position_increments)
