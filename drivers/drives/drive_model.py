"""Contents of a drive profile: objects that a maker's drive lacks or has elsewhere, its units, bits and PDO limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from drivers.canopen import objects as o
from drivers.canopen.dictionary import DICTIONARY, INVERTER, Access, Entry
from drivers.canopen.objects import DataType

Key = tuple[int, int]
"""Index and sub-index of an object."""


def address(key: Key) -> str:
    """Return an object's address in the notation of profiles and messages: ``0x1400:05``."""
    return f"0x{key[0]:04X}:{key[1]:02X}"


@dataclass(frozen=True, slots=True)
class Substitute:
    """The maker's object in the place of a missing one: ``factor`` times the standard object's value is written to it.

    ``per_mille_of``: an object that is read first; its value / 1000 is a further factor.
    """

    key: Key
    type: DataType
    factor: float = 1.0
    per_mille_of: Key | None = None
    reference: int = 0
    """Value of the object ``per_mille_of`` on the simulated drive."""

    def value(self, standard: int, reference: int) -> int:
        """Convert a value of the standard object to the value to write to the maker's object."""
        scale = self.factor if self.per_mille_of is None else self.factor * reference / 1000.0
        return round(standard * scale)

    def standard(self, value: int, reference: int) -> int:
        """Convert a value of the maker's object to the standard object's value."""
        scale = self.factor if self.per_mille_of is None else self.factor * reference / 1000.0
        return round(value / scale)


@dataclass(frozen=True, slots=True)
class FurtherObject:
    """A further object, written and read back at every connect; without ``value`` the rig file states its value."""

    key: Key
    type: DataType
    value: int | None
    text: str


@dataclass(frozen=True, slots=True)
class Units:
    """Counts of other objects for each count of 0x60FF; also the units of torque and rated torque."""

    acceleration: float = 1.0
    """0x6083, 0x6084, 0x6085, 0x609A."""
    greatest_speed: float = 1.0
    """0x6080 and 0x607F."""
    profile_speed: float = 1.0
    """0x6081 and 0x6099."""
    threshold: float = 1.0
    """0x606F."""
    torque: float = 1.0
    """Counts of 0x6072 and 0x6077 per mille of the rated torque."""
    target_rpm: float = 1.0
    """Velocity mode: r/min of the motor for each count of 0x6042, written to 0x604C where the drive has it."""
    rated_torque_nm: float = 0.001
    """N m per count of 0x6076."""


@dataclass(frozen=True, slots=True)
class PdoLimits:
    """Limits on changes of a drive's process data."""

    cob_ids: Literal["set", "fixed"] = "set"
    mapping: Literal["free", "fixed"] = "free"
    entries: int = 8
    """Most objects in one PDO."""
    synchronous: bool = True
    """Whether transmission type 1 is accepted."""


@dataclass(frozen=True, slots=True)
class DriveProfile:
    """The differences between one make and other CiA 402 drives. Immutable: a deep copy is the profile itself."""

    name: str
    title: str
    checked: str
    """Parts of the profile that were compared with a manual or data sheet, and parts that were not."""
    vendor_id: int = 0
    """Vendor id of the maker in 0x1018:01, 0 = not known; the rig file's is compared at connect."""
    missing: frozenset[Key] = frozenset()
    """Objects that the drive does not have."""
    optional: frozenset[Key] = frozenset()
    """Objects that only some drives of the maker have: the drive is asked for them."""
    substitutes: Mapping[Key, Substitute] = field(default_factory=dict[Key, Substitute])
    options: Mapping[Key, int] = field(default_factory=dict[Key, int])
    """Values of option objects that replace the usual values."""
    velocity_mode: Literal["pv", "vl"] = "pv"
    """Mode of an axis of speed: profile velocity (3), or the velocity mode of frequency inverters (2)."""
    parameters: Mapping[str, FurtherObject] = field(default_factory=dict[str, FurtherObject])
    units: Units = field(default_factory=Units)
    pdo: PdoLimits = field(default_factory=PdoLimits)
    remote: bool = True
    """Whether statusword bit 9 shows that the drive obeys the bus; the bit then has to be set."""
    standstill: bool = True
    """Whether statusword bit 12 shows standstill in profile velocity mode."""

    def __deepcopy__(self, memo: dict[int, object]) -> DriveProfile:
        return self

    def __copy__(self) -> DriveProfile:
        return self

    def lacks(self, key: Key) -> bool:
        """Return whether the drive lacks an object; an object missing at sub-index 0 lacks all its sub-indices."""
        return key in self.missing or (key[0], 0) in self.missing

    @property
    def inverter(self) -> bool:
        """Whether the drive is a frequency inverter: it turns an axis in velocity mode, and has no other mode."""
        return self.velocity_mode == "vl"

    @property
    def torque(self) -> bool:
        """Whether the drive reports a torque (0x6077)."""
        return not self.lacks((o.TORQUE_ACTUAL, 0))

    def dictionary(self) -> dict[Key, Entry]:
        """Return the drive's objects that are used here, by address."""
        known = INVERTER if self.inverter else DICTIONARY
        found = {key: self._entry(entry) for key, entry in known.items() if not self.lacks(key)}
        for key, one in self.substitutes.items():
            found[one.key] = Entry(*one.key, one.type, "rw", 0, f"in place of {address(key)}")
            if one.per_mille_of is not None:
                found[one.per_mille_of] = Entry(*one.per_mille_of, DataType.U32, "rw", one.reference, "reference")
        for name, one in self.parameters.items():
            default = 0 if one.value is None else one.value
            found[one.key] = Entry(*one.key, one.type, "rw", default, name.replace("_", " "))
        return dict(sorted(found.items()))

    def _entry(self, entry: Entry) -> Entry:
        """Return an entry with this drive's access: COB-IDs and mappings may be read only."""
        pdo = 0x1400 <= entry.index < 0x1C00
        mapped = pdo and entry.index & 0x0200
        fixed = pdo and not mapped and entry.sub == 1 and self.pdo.cob_ids == "fixed"
        fixed = fixed or (mapped and self.pdo.mapping == "fixed")
        access: Access = "ro" if fixed else entry.access
        default = entry.default
        if isinstance(default, int) and pdo and not mapped and entry.sub == 1 and self.pdo.cob_ids == "fixed":
            default &= 0x7FFF_FFFF
        return Entry(entry.index, entry.sub, entry.type, access, default, entry.name, entry.mappable, entry.plus_node)
