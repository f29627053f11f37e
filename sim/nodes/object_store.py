"""The object dictionary of one simulated device: values, access rights, and effects of writes.

The table of objects is ``drivers.canopen.dictionary``; a store holds the values of one device. Values are plain
integers (text for names) in ``values``; the hot path reads and writes them there directly. Measured objects have a
reader instead of a stored value. A guard may refuse a value before it is written, a hook acts on it afterwards.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from copy import deepcopy

from drivers.canopen import objects as o
from drivers.canopen import sdo
from drivers.canopen.dictionary import DICTIONARY, KNOWN, Entry
from drivers.canopen.objects import DataType

Key = tuple[int, int]
Reader = Callable[[], int]
Guard = Callable[[int, int], None]
"""Called with (sub-index, value); raises SdoAbortError to refuse it."""

_COMMUNICATION = range(0x1000, 0x2000)
"""Objects that a communication reset sets back (CiA 301, 7.3.2.2.1)."""


class SdoAbortError(Exception):
    """An access that the object dictionary refuses; ``code`` is the abort code (``drivers.canopen.sdo``)."""

    def __init__(self, code: int) -> None:
        super().__init__(f"SDO abort 0x{code:08X}")
        self.code = code


class ObjectStore:
    """The values of one device; SDO access through ``upload`` and ``download``."""

    def __init__(
        self,
        node_id: int,
        overrides: Mapping[Key, int | str] | None = None,
        entries: Mapping[Key, Entry] = DICTIONARY,
    ) -> None:
        """Create a device's values: the table's defaults, replaced by ``overrides`` (identity, ratings).

        ``entries``: the objects of the device. Objects of the table that the device lacks keep their defaults inside.
        """
        self.node_id = node_id
        self.entries = entries
        self._all: Mapping[Key, Entry] = DICTIONARY if entries is DICTIONARY else {**KNOWN, **entries}
        self.guards: dict[int, Guard] = {}
        self.hooks: dict[int, Guard] = {}
        self.readers: dict[Key, Reader] = {}
        self._overrides: dict[Key, int | str] = dict(overrides or {})
        self._saved: dict[Key, int] = {}
        self.values: dict[Key, int] = {}
        self.reset()

    def reset(self, communication_only: bool = False) -> None:
        """Set the objects to their power-on values, or only those of the communication profile."""
        for key, entry in self._all.items():
            if entry.type is DataType.TEXT or (communication_only and key[0] not in _COMMUNICATION):
                continue
            value = self._saved.get(key)
            self.values[key] = self._default(key, entry) if value is None else value

    def save(self) -> None:
        """Keep the present values of all writable parameters as power-on values (0x1010 "save")."""
        for key, entry in self._all.items():
            if entry.access == "rw" and not entry.mappable and key[0] != o.ERROR_HISTORY:
                self._saved[key] = self.values[key]

    def restore_defaults(self) -> None:
        """Make the table's defaults the power-on values again (0x1011 "load"); they take effect with the next reset."""
        self._saved.clear()

    def read(self, key: Key) -> int:
        """Return the present value of an integer object that exists."""
        reader = self.readers.get(key)
        return self.values[key] if reader is None else reader()

    def upload(self, index: int, sub: int) -> bytes:
        """Return an object's bytes; raises SdoAbortError."""
        entry = self._entry(index, sub)
        if not entry.readable:
            raise SdoAbortError(sdo.WRITE_ONLY)
        if entry.type is DataType.TEXT:
            text = self._overrides.get((index, sub), entry.default)
            return str(text).encode("latin-1", "replace")
        return o.CODEC[entry.type].pack(self.read((index, sub)))

    def check_writable(self, index: int, sub: int) -> None:
        """Raise SdoAbortError when the object is missing or read only."""
        if not self._entry(index, sub).writable:
            raise SdoAbortError(sdo.READ_ONLY)

    def download(self, index: int, sub: int, data: bytes, exact: bool) -> None:
        """Write an object from its bytes; surplus bytes are cut unless ``exact``; raises SdoAbortError."""
        self.check_writable(index, sub)
        codec = o.CODEC[self.entries[(index, sub)].type]
        if not exact:
            data = data[: codec.size]
        if len(data) != codec.size:
            raise SdoAbortError(sdo.LENGTH_MISMATCH)
        value: int = codec.unpack(data)[0]
        self.write(index, sub, value)

    def write(self, index: int, sub: int, value: int) -> None:
        """Write a value of an existing object, with its guard and hook; raises SdoAbortError."""
        guard = self.guards.get(index)
        if guard is not None:
            guard(sub, value)
        self.values[(index, sub)] = value
        hook = self.hooks.get(index)
        if hook is not None:
            hook(sub, value)

    def __deepcopy__(self, memo: dict[int, object]) -> ObjectStore:
        """Copy the values flat (keys and values are immutable), and references to the device deeply."""
        copy = object.__new__(ObjectStore)
        memo[id(self)] = copy
        copy.node_id = self.node_id
        copy.entries = self.entries
        copy._all = self._all
        copy.values = self.values.copy()
        copy._saved = self._saved.copy()
        copy._overrides = self._overrides
        copy.guards = deepcopy(self.guards, memo)
        copy.hooks = deepcopy(self.hooks, memo)
        copy.readers = dict(zip(self.readers, deepcopy(list(self.readers.values()), memo), strict=True))
        return copy

    def _default(self, key: Key, entry: Entry) -> int:
        value = self._overrides.get(key)
        if value is None:
            value = entry.initial(self.node_id)
        if isinstance(value, str):
            raise TypeError(f"0x{key[0]:04X}:{key[1]:02X} is a number, not text")
        return value

    def _entry(self, index: int, sub: int) -> Entry:
        entry = self.entries.get((index, sub))
        if entry is None:
            known = any(index == one for one, _ in self.entries)
            raise SdoAbortError(sdo.NO_SUB_INDEX if known else sdo.NO_OBJECT)
        return entry
