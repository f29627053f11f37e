"""Errors of a simulated device: register 0x1001, history 0x1003, EMCY with inhibit time (CiA 301, 7.2.7)."""

from __future__ import annotations

from math import inf

from drivers.canopen import objects as o
from drivers.canopen import sdo
from drivers.canopen.messages import encode_emergency
from sim.nodes.object_store import ObjectStore, SdoAbortError
from sim.wires.can_wire import CanWire

_HISTORY_LENGTH = 8

# Bits of the error register (CiA 301, table 47); bit 0 is set with every other bit.
GENERIC = 0x01
CURRENT = 0x02
VOLTAGE = 0x04
TEMPERATURE = 0x08
COMMUNICATION = 0x10
PROFILE = 0x20
MANUFACTURER = 0x80

_REGISTER_BY_CLASS = {
    0x2: CURRENT,
    0x3: VOLTAGE,
    0x4: TEMPERATURE,
    0x8: COMMUNICATION,
    0x7: PROFILE,
    0xF: MANUFACTURER,
}


def register_bits(code: int) -> int:
    """Return the error register bits of an EMCY code (0x0001..0xFFFF) by its class (CiA 301, table 26)."""
    if code >> 8 in (0x84, 0x85, 0x86):
        return GENERIC | PROFILE
    return GENERIC | _REGISTER_BY_CLASS.get(code >> 12, GENERIC)


class Emergencies:
    """The errors present in a device, and their messages on the wire.

    ``allowed`` follows the NMT state: EMCY frames are sent in PRE-OPERATIONAL and OPERATIONAL only.
    """

    def __init__(self, wire: CanWire, store: ObjectStore) -> None:
        """Report on ``wire``; register and history are in ``store``."""
        self._wire = wire
        self._store = store
        self.allowed = False
        self.present: list[int] = []
        self._last_s = -inf
        store.guards[o.ERROR_HISTORY] = self._guard_history
        store.hooks[o.ERROR_HISTORY] = self._clear_history
        store.guards[o.EMERGENCY_COB_ID] = self._guard_cob_id

    def reset(self, communication_only: bool) -> None:
        """Forget all errors, as after power-on, or those of the communication; nothing is sent."""
        self.present = [
            code for code in self.present if communication_only and register_bits(code) != GENERIC | COMMUNICATION
        ]
        self._last_s = -inf

    def refresh(self) -> None:
        """Set the register for the present errors again, after the communication objects were reset."""
        self._store.values[(o.ERROR_REGISTER, 0)] = self._register()

    def add(self, code: int, t: float) -> None:
        """Report error ``code`` at ``t`` s, unless it is present already."""
        if code in self.present:
            return
        self.present.append(code)
        values = self._store.values
        count = min(values[(o.ERROR_HISTORY, 0)] + 1, _HISTORY_LENGTH)
        for sub in range(count, 1, -1):
            values[(o.ERROR_HISTORY, sub)] = values[(o.ERROR_HISTORY, sub - 1)]
        values[(o.ERROR_HISTORY, 1)] = code
        values[(o.ERROR_HISTORY, 0)] = count
        self._report(code, t)

    def remove(self, code: int, t: float) -> None:
        """Report at ``t`` s that error ``code`` has gone (EMCY 0x0000 with the remaining bits of the register)."""
        if code in self.present:
            self.present.remove(code)
            self._report(0x0000, t)

    def remove_all(self, t: float) -> None:
        """Report at ``t`` s that no error is left; nothing is sent when there was none."""
        if self.present:
            self.present.clear()
            self._report(0x0000, t)

    def _report(self, code: int, t: float) -> None:
        register = self._register()
        values = self._store.values
        values[(o.ERROR_REGISTER, 0)] = register
        cob_id = values[(o.EMERGENCY_COB_ID, 0)]
        if not self.allowed or cob_id & o.COB_INVALID:
            return
        # A message held back by the inhibit time is sent as soon as that has passed.
        t = max(t, self._last_s + values[(o.EMERGENCY_INHIBIT, 0)] * 1e-4)
        self._last_s = t
        self._wire.transmit(cob_id & o.COB_ID_MASK, encode_emergency(code, register), t, True)

    def _register(self) -> int:
        register = 0
        for error in self.present:
            register |= register_bits(error)
        return register

    def _guard_history(self, sub: int, value: int) -> None:
        if value != 0:
            raise SdoAbortError(sdo.VALUE_RANGE)

    def _clear_history(self, sub: int, value: int) -> None:
        for entry in range(1, _HISTORY_LENGTH + 1):
            self._store.values[(o.ERROR_HISTORY, entry)] = 0

    def _guard_cob_id(self, sub: int, value: int) -> None:
        if value & ~o.COB_INVALID != o.EMERGENCY_BASE + self._store.node_id:
            raise SdoAbortError(sdo.VALUE_RANGE)
