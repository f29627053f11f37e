"""Configuration of an axis, and the reports of its drive about itself."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Literal

from drivers.canopen.dictionary import PRODUCT_CODE, VENDOR_ID
from drivers.canopen.messages import register_text
from drivers.canopen.objects import emergency_text
from drivers.digital_io import USUAL_WIRING, DigitalWiring
from drivers.drives.drive_model import DriveProfile
from drivers.drives.reader import GENERIC, drive_profile
from drivers.profiles.model import ProfileError
from drivers.screw import Screw

_I32_MAX, _U32_MAX = 0x7FFF_FFFF, 0xFFFF_FFFF
LEAST_COUNTS = 100
"""Counts of 0x60FF at the greatest speed: with fewer a step of speed is more than 1 % of it [A]."""
_I16_MAX = 0x7FFF
_RPM = 30.0 / math.pi
"""r/min of one rad/s."""
UNIT_SHARE = 0.01
"""Relative difference within which an inverter's counts follow from gear and unit [A]: they are entered rounded."""


@dataclass(frozen=True, slots=True)
class AxisConfig:
    """One axis: its node, its scaling and its limits; raises ValueError where they contradict each other.

    ``unit`` is the axis' engineering unit: a speed for "rad/s", "m/s" and "mm/s" (positions are then rad,
    m, mm), and "deg" for the yaw axes (speeds deg/s). ``velocity_increments`` are counts of 0x60FF, 0x606C, 0x6080,
    0x6081 and 0x6083-85 (of an inverter 0x6042 to 0x604A) per unit of speed or acceleration;
    ``position_increments`` are counts of 0x6064 and 0x607A
    per unit of position; 0 = not used. ``feedback`` names the 32-bit field of TPDO1. Torque: 0x6077 is per mille of
    ``rated_torque_nm`` (0x6076). ``vendor_id``, ``product_code`` and ``serial_number`` are compared with
    0x1018 at connect; 0 = not compared. [A] marks an assumption: check it against the drive's manual.
    ``profile`` names the file that describes the maker's drives (drivers.drives). The two further increments state the
    drive's accelerations or its greatest speed if they do not follow from 0x60FF's counts; 0 = by the profile.
    """

    name: str
    node_id: int                                     # 1..126; 127 is the PC
    mode: Literal["velocity", "position"]
    unit: Literal["rad/s", "m/s", "mm/s", "deg"]
    velocity_increments: float                       # counts per unit/s
    position_increments: float                       # counts per position unit
    feedback: Literal["velocity", "position"]
    rated_torque_nm: Annotated[float, "N.m"]
    max_speed: float                                 # unit (a speed), or deg/s
    acceleration: float                              # speed unit per s
    deceleration: float                              # speed unit per s
    quick_stop_deceleration: float                   # speed unit per s
    max_torque_per_mille: int = 3000                 # 0x6072, of rated; 3000 is a usual servo's peak [A]
    screw: Screw | None = None                       # screw that the torque turns; None: no screw
    software_limits: tuple[float, float] | None = None   # position unit; 0x607D
    home_offset: float = 0.0                         # position unit; 0x607C: the zero lies this far beyond the switch,
                                                     # so the switch is at -home_offset (CiA 402-2, home offset)
    homing_method: int = 19                          # 0x6098; 19: home switch, no index pulse [A]
    homing_speed: float = 0.0                        # 0x6099:01; 0: a fifth of max_speed
    homing_zero_speed: float = 0.0                   # 0x6099:02; 0: a twentieth of max_speed
    home_timeout_s: Annotated[float, "s"] = 60.0
    position_window: float = 0.0                     # position unit; 0x6067; 0: leave the drive's
    speed_zero: float = 0.0                          # unit; 0x606F: a slower axis is at rest, reported at once
                                                     # by PDO 2, not with the next SYNC; 0: the drive's own, no PDO 2
    digital_io: bool = False                         # PDO 2 carries 0x60FE:01 and 0x60FD
    inputs_period_s: Annotated[float, "s"] = 0.1     # 0x1801:05: longest time between two 0x60FD; events come besides
    vendor_id: int = VENDOR_ID                       # default: the simulated drive's
    product_code: int = PRODUCT_CODE
    serial_number: int = 0
    heartbeat_s: Annotated[float, "s"] = 0.05        # 0x1017: the drive's own
    consumer_heartbeat_s: Annotated[float, "s"] = 0.2    # 0x1016: how long the drive waits for ours
    rpdo_deadline_s: Annotated[float, "s"] = 0.0     # 0x1400:05; 0: off, the heartbeat watches
    proves_watchdog: bool = True                     # takes part in the proof at arming; false: it cannot report 0x8130
    profile: str = GENERIC                           # of drivers/profiles/drives, or a path that ends in .toml
    acceleration_increments: float = 0.0             # counts of 0x6083-85 and 0x609A per speed unit per s
    max_speed_increments: float = 0.0                # counts of 0x6080 per unit of speed
    gear: float = 1.0                                # motor turns per turn of the shaft that has rated_torque
    wiring: DigitalWiring | None = None              # bits of 0x60FD and 0x60FE:01; None: USUAL_WIRING of digital_io
    parameters: Mapping[str, float] = field(default_factory=dict[str, float])
    """Values of the profile's further objects (its table ``writes``), by name."""

    def __post_init__(self) -> None:
        for problem in self._problems():
            raise ValueError(f"axis {self.name}: {problem}")

    def _problems(self) -> list[str]:
        problems: list[str] = []
        try:
            self._check_profile(problems)
        except ProfileError as error:
            problems.append(str(error))
        if not 1 <= self.node_id <= 126:
            problems.append(f"node id {self.node_id} is not within 1..126")
        for name in ("velocity_increments", "rated_torque_nm", "max_speed", "acceleration", "deceleration",
                     "quick_stop_deceleration", "gear"):
            value: float = getattr(self, name)
            if not (math.isfinite(value) and value > 0):
                problems.append(f"{name} is {value}, it must be above 0")
        if (self.mode == "position" or self.feedback == "position") and not self.position_increments > 0:
            problems.append("position_increments is needed for a position mode or position feedback")
        if self.mode == "position" and self.feedback != "position":
            problems.append("position mode needs position feedback")
        if self.software_limits is not None and not self.software_limits[0] < self.software_limits[1]:
            problems.append(f"software_limits {self.software_limits} are not in ascending order")
        most, bits = (_I32_MAX, "32 bits of 0x60FF")
        if not problems and self.drive.inverter:
            most, bits = (_I16_MAX, "16 bits of 0x6042")
            self._check_inverter(problems)
        if not LEAST_COUNTS <= self.max_speed * self.velocity_increments <= most:
            problems.append(f"max_speed x velocity_increments is {self.max_speed * self.velocity_increments:g} counts:"
                            f" expected {LEAST_COUNTS} (steps of 1 %) to {most}, the {bits}")
        if not problems:
            self._check_counts(problems)
        for name in ("heartbeat_s", "consumer_heartbeat_s"):
            value = getattr(self, name)
            if not 0.001 <= value <= 65.535:
                problems.append(f"{name} is {value} s, possible are 0.001..65.535 s")
        if not 1 <= self.max_torque_per_mille <= 0xFFFF:
            problems.append(f"max_torque_per_mille is {self.max_torque_per_mille}, possible are 1..65535")
        if self.speed_zero and (self.feedback != "velocity" or self.digital_io):
            problems.append("speed_zero needs velocity feedback and a PDO 2 that no inputs take")
        if not 0.0 <= self.speed_zero * self.velocity_increments <= 0xFFFF:
            problems.append(f"speed_zero is {self.speed_zero}, which does not fit the 16 bits of 0x606F")
        if self.digital_io and not 0.01 <= self.inputs_period_s <= 65.535:
            problems.append(f"inputs_period is {self.inputs_period_s} s, possible are 0.01..65.535 s")
        return problems

    def _check_inverter(self, problems: list[str]) -> None:
        """Note what a frequency inverter cannot do, and counts that contradict its unit."""
        needs = {"mode": self.mode == "position", "feedback": self.feedback == "position",
                 "screw": self.screw is not None}
        for name, needed in needs.items():
            if needed:
                problems.append(f"{name}: {self.drive.title} knows velocity mode only, and no position")
        counts = _RPM * self.gear / self.drive.units.target_rpm
        if self.unit == "rad/s" and abs(self.velocity_increments / counts - 1.0) > UNIT_SHARE:
            problems.append(f"velocity_increments is {self.velocity_increments:g}: gear {self.gear:g} and"
                            f" {self.drive.units.target_rpm:g} r/min a count of 0x6042 make {counts:.6g} per rad/s")

    def _check_counts(self, problems: list[str]) -> None:
        """Note values that do not fit the objects of the drive that they are written to."""
        for name in ("acceleration", "deceleration", "quick_stop_deceleration"):
            counts = getattr(self, name) * self.acceleration_counts
            if not 1.0 <= counts <= _U32_MAX:
                problems.append(f"{name} is {counts:g} counts, possible are 1..2^32 - 1 (0x6083 to 0x6085)")
        counts = self.max_speed * self.max_speed_counts
        if not 1.0 <= counts <= _U32_MAX:
            problems.append(f"max_speed is {counts:g} counts, possible are 1..2^32 - 1 (0x6080)")
        places = {"home_offset": (self.home_offset,), "software_limits": self.software_limits or ()}
        for name, values in places.items():
            if not all(abs(value * self.position_increments) <= _I32_MAX for value in values):
                problems.append(f"{name} x position_increments does not fit the 32 bits of its object")
        for name in ("homing_speed", "homing_zero_speed"):
            if not 0.0 <= getattr(self, name) <= self.max_speed:
                problems.append(f"{name} is {getattr(self, name)}, possible are 0..max_speed")
        if not -128 <= self.homing_method <= 127:
            problems.append(f"homing_method is {self.homing_method}, possible are -128..127 (0x6098)")
        if not 0.0 < self.home_timeout_s <= 3600.0:
            problems.append(f"home_timeout is {self.home_timeout_s} s, possible are up to 3600 s")
        if not 0.0 <= self.rpdo_deadline_s <= 65.535:
            problems.append(f"rpdo_deadline is {self.rpdo_deadline_s} s, possible are 0..65.535 s (0x1400:05)")
        for name in ("vendor_id", "product_code", "serial_number"):
            if not 0 <= getattr(self, name) <= _U32_MAX:
                problems.append(f"{name} is {getattr(self, name)}, possible are 0..2^32 - 1 (0x1018)")

    def _check_profile(self, problems: list[str]) -> None:
        """Raise ProfileError where there is no such profile; note parameters that the profile does not have."""
        known = self.drive.parameters
        for name, value in self.parameters.items():
            if name not in known:
                problems.append(f"profile {self.profile} has no parameter {name} (it has {', '.join(known) or 'none'})")
            elif value != round(value):
                problems.append(f"{name} is {value}, it must be a whole number of counts")
        for name in ("acceleration_increments", "max_speed_increments"):
            if not 0.0 <= getattr(self, name) < math.inf:
                problems.append(f"{name} is {getattr(self, name)}, it must be above 0, or 0: by the profile")

    @property
    def drive(self) -> DriveProfile:
        """Profile of the maker's drives."""
        return drive_profile(self.profile)

    @property
    def acceleration_counts(self) -> float:
        """Counts of 0x6083, 0x6084, 0x6085 and 0x609A per speed unit per s."""
        return self.acceleration_increments or self.velocity_increments * self.drive.units.acceleration

    @property
    def max_speed_counts(self) -> float:
        """Counts of 0x6080 and 0x607F per unit of speed."""
        return self.max_speed_increments or self.velocity_increments * self.drive.units.greatest_speed

    @property
    def profile_speed_counts(self) -> float:
        """Counts of 0x6081 and 0x6099 per unit of speed."""
        return self.velocity_increments * self.drive.units.profile_speed

    @property
    def rated_torque_counts(self) -> float:
        """Counts expected in 0x6076, which is of the motor: the rated torque of the axis over its gear."""
        return self.rated_torque_nm / self.gear / self.drive.units.rated_torque_nm

    @property
    def io(self) -> DigitalWiring:
        """Meaning of the bits of the digital inputs and outputs."""
        return self.wiring or USUAL_WIRING

    @property
    def standstill_by_pdo(self) -> bool:
        """Whether PDO 2 carries the statusword, for its bit 12."""
        return self.speed_zero > 0.0 and self.drive.standstill


@dataclass(frozen=True, slots=True)
class DeviceIdentity:
    """Identity of the device at a node id: 0x1000 and 0x1018."""

    device_type: int
    vendor_id: int
    product_code: int
    revision: int
    serial_number: int


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Fault objects of a drive: 0x603F, 0x1001 and 0x1003 (newest first).

    ``failed`` names the request that was not answered, if any; the other fields then hold what was read before it.
    """

    error_code: int
    register: int
    history: tuple[int, ...]
    failed: str | None = None

    @property
    def text(self) -> str:
        """The diagnosis in one line, for the journal."""
        history = "; ".join(emergency_text(entry & 0xFFFF) for entry in self.history) or "empty"
        line = (f"error code {emergency_text(self.error_code)}, error register {register_text(self.register)}, "
                f"history {history}")
        return f"{line}; {self.failed}" if self.failed else line
