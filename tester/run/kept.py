"""Reads drive settings that this program does not write, at a run's good end, and stores them with the run.

``tester bus params compare`` compares later readings with them. They are read after standstill, with the drives
released, so that reading takes no time from the scan, and no measurement depends on it.
"""

from __future__ import annotations

from collections.abc import Callable

from drivers.canopen import objects as o
from drivers.canopen.dictionary import KNOWN
from drivers.canopen.scan import Key, SdoScan
from drivers.ports import BusLost
from tester.inputs.rig import Rig
from tester.machine.rig_ports import Ports
from tester.machine.tickers import TickedWorld
from tester.store.recorder import Recorder

IDENTITY: tuple[Key, ...] = (
    (o.DEVICE_TYPE, 0),
    (o.IDENTITY, 1),
    (o.IDENTITY, 2),
    (o.IDENTITY, 3),
    (o.IDENTITY, 4),
    (o.DEVICE_NAME, 0),
    (o.HARDWARE_VERSION, 0),
    (o.SOFTWARE_VERSION, 0),
)
"""Objects that identify a node; the texts among them are optional (CiA 301, 7.5.2)."""

KEPT: tuple[Key, ...] = (
    (o.SUPPORTED_MODES, 0),
    (o.RATED_CURRENT, 0),
    (o.RATED_TORQUE, 0),
    (0x607E, 0),
    (o.MAX_PROFILE_VELOCITY, 0),
    (0x608F, 1),
    (0x608F, 2),
    (0x6091, 1),
    (0x6091, 2),
    (0x6092, 1),
    (0x6092, 2),
    (0x60A8, 0),
    (0x60A9, 0),
    (0x6073, 0),
    (0x6410, 1),
)
"""Settings of a drive that this program does not write: ratings, polarity, encoder, gear, feed, units, greatest
current, motor (CiA 402-2, 6.3 and 6.4). Most are optional.
"""

STEP_S = 0.002
"""Period for reading the bus while waiting for answers, s."""
MOST_S = 3.0
"""Longest time that this adds to a run's end, s: reading some twenty objects a drive, four drives at a time, takes a
tenth of it.
"""


def object_key(key: Key) -> str:
    """Return an object's name in records and dumps."""
    return f"0x{key[0]:04X}:{key[1]:02X}"


def object_name(key: Key) -> str:
    """Return an object's title; "" if the dictionary does not contain it."""
    return KNOWN[key].name if key in KNOWN else ""


def record_kept(
    rig: Rig, ports: Ports, world: TickedWorld | None, now_s: float, recorder: Recorder, leapt_s: float = 0.0
) -> None:
    """Store identity and settings of every drive, as far as the drive has them; store nothing if the bus is gone.

    ``now_s``: the run's time; ``leapt_s``: what of it passed without the wires. Drives are only read, by SDO.
    """
    names = {config.node_id: name for name, config in rig.drives().items()}
    scan, wait = SdoScan({node: [*IDENTITY, *KEPT] for node in names}), _waiting(ports, world)
    begun_s = clock_s = now_s - leapt_s
    try:
        while not scan.done and clock_s < begun_s + MOST_S:
            scan.feed(ports.can.receive(clock_s), ports.can, clock_s)
            scan.service(ports.can, clock_s)
            clock_s += STEP_S
            wait(clock_s + leapt_s)
    except BusLost:
        return
    for node, answers in scan.answers.items():
        for key, answer in answers.items():
            if answer.ok:
                recorder.device_parameter(now_s, names[node], object_key(key), answer.text, object_name(key))


def _waiting(ports: Ports, world: TickedWorld | None) -> Callable[[float], object]:
    if world is not None:
        return world.advance
    assert ports.pace is not None
    return ports.pace.wait_until
