"""Reads or writes one object of one node, while no run is under way."""

from __future__ import annotations

from typing import Final

from drivers import cia402
from drivers.canopen import objects as o
from drivers.canopen.objects import DataType
from drivers.canopen.scan import PATIENCE_S, Key, ObjectAnswer
from drivers.canopen.sdo import SdoClient
from drivers.cia402 import State
from drivers.ports import CanPort
from tester.doctor.can_survey import STEP_S, scanned
from tester.doctor.open_wires import Wires

BOOT_S = 0.5
"""Time of listening after the bus is opened, s: simulated drives boot in 0.2 s."""
COMMANDS: Final = frozenset(
    {
        (o.CONTROLWORD, 0), (o.DIGITAL_OUTPUTS, 1), (o.VL_TARGET_VELOCITY, 0), (o.TARGET_VELOCITY, 0),
        (o.TARGET_POSITION, 0),
    }
)  # fmt: skip
"""Objects that command a drive or switch an output, which only a run may write."""
_OFF = (State.NOT_READY, State.SWITCH_ON_DISABLED, State.READY_TO_SWITCH_ON, State.FAULT)
"""States in which a drive has no power."""


class WriteRefusedError(Exception):
    """The object must not be written at present; the message gives the reason."""


class NodeAccess:
    """The objects of one node. Raises BusLost if the bus is gone."""

    def __init__(self, port: CanPort, wires: Wires, node: int) -> None:
        """``node``: number of the node, 1..127."""
        self._port = port
        self._wires = wires
        self._node = node
        wires.wait_until(wires.now() + BOOT_S)
        port.receive(wires.now())

    def read(self, key: Key) -> ObjectAnswer:
        """Upload an object: read it from the node."""
        scan = scanned(self._port, self._wires, {self._node: [key]}, PATIENCE_S)
        answer = scan.answers.get(self._node, {}).get(key)
        return answer or ObjectAnswer(key, error=f"nothing answers at node {self._node} within {PATIENCE_S:g} s")

    def may_write(self, key: Key) -> None:
        """Raise WriteRefusedError if the object is a command, or if the node is a drive that has power."""
        if key in COMMANDS:
            raise WriteRefusedError(f"0x{key[0]:04X} commands the drive: only a run sends it")
        statusword = self.read((o.STATUSWORD, 0))
        if statusword.silent or (not statusword.ok and not statusword.missing):
            raise WriteRefusedError(f"whether the drive has power is not known: {statusword.error}")
        word = statusword.number
        if word is not None and cia402.decode(word) not in _OFF:
            raise WriteRefusedError(f"the drive has power ({cia402.decode(word).name}): nothing is written to it now")

    def write(self, key: Key, kind: DataType, value: int | str) -> ObjectAnswer:
        """Download a value to the node; return the object's new value, or why the node refused it.

        Raises WriteRefusedError, and ValueError if the value does not fit the type.
        """
        data = o.encode(kind, value)
        self.may_write(key)
        client, wires, port = SdoClient(PATIENCE_S), self._wires, self._port
        port.send(o.SDO_REQUEST_BASE + self._node, client.download(*key, data, wires.now()), wires.now())
        while client.busy:
            wires.wait_until(wires.now() + STEP_S)
            now = wires.now()
            answers = [each for _, can_id, each in port.receive(now) if can_id == o.SDO_REPLY_BASE + self._node]
            for frame in [*(client.feed(each, now) for each in answers), client.expire(now)]:
                if frame is not None:
                    port.send(o.SDO_REQUEST_BASE + self._node, frame, now)
        if client.error is not None:
            return ObjectAnswer(key, error=str(client.error), code=client.error.code)
        return self.read(key)
