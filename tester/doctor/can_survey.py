"""Surveys the CAN bus: listens first, then queries node by node."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.scan import ANSWER_S, PATIENCE_S, Key, ObjectAnswer, SdoScan
from drivers.ports import BusLost, CanFrame, CanPort
from drivers.process_data import actual_of
from tester.doctor.open_wires import Wires
from tester.inputs.rig import Rig
from tester.run.kept import IDENTITY, KEPT
from tester.run.set_up import mapped, written

LISTEN_S = 1.0
"""Time of listening without sending, s: twenty heartbeats of 50 ms."""
STEP_S = 0.002
"""Period for reading the wires while waiting for an answer, s."""
MOST_S = 30.0
"""Longest scan of a bus, s: 126 silent nodes, four at a time, take 3.2 s."""
PRESENCE: Key = (o.DEVICE_TYPE, 0)
"""The object that every CANopen node has."""
STATE: tuple[Key, ...] = (
    (o.ERROR_REGISTER, 0),
    (o.STATUSWORD, 0),
    (o.ERROR_CODE, 0),
    (o.DIGITAL_INPUTS, 0),
    (o.POSITION_ACTUAL, 0),
    (o.VELOCITY_ACTUAL, 0),
)
"""Objects with the present state of a drive."""

_FUNCTION, _NODE = 0x780, 0x07F
_OF_A_MASTER = {o.NMT_ID: "NMT", o.SYNC_ID: "SYNC"}
_FUNCTIONS_OF_A_MASTER = {
    o.RPDO1_BASE: "RPDO1", o.RPDO2_BASE: "RPDO2", o.RPDO3_BASE: "RPDO3", o.RPDO4_BASE: "RPDO4",
    o.SDO_REQUEST_BASE: "SDO request",
}  # fmt: skip


@dataclass(slots=True)
class Listened:
    """Frames received while the computer sent none."""

    seconds: float = 0.0
    frames: Counter[int] = field(default_factory=Counter[int])
    """Number of frames with each identifier."""
    lengths: Counter[int] = field(default_factory=Counter[int])
    """Number of frames with each number of data bytes."""
    beats: dict[int, list[float]] = field(default_factory=dict[int, list[float]])
    """Arrival times of the heartbeats of each node, s."""
    states: dict[int, int] = field(default_factory=dict[int, int])
    """The NMT state in each node's last heartbeat."""
    emergencies: dict[int, bytes] = field(default_factory=dict[int, bytes])
    masters: list[str] = field(default_factory=list[str])
    """Frames that only a master sends, the first of each kind, as text."""

    def take(self, frames: Iterable[CanFrame], own_node: int) -> None:
        """Include received frames; ``own_node``: the computer's node number."""
        for t, can_id, data in frames:
            self.frames[can_id] += 1
            self.lengths[len(data)] += 1
            function, node = can_id & _FUNCTION, can_id & _NODE
            if function == o.HEARTBEAT_BASE and len(data) == 1:
                self.beats.setdefault(node, []).append(t)
                self.states[node] = data[0] & 0x7F
            elif function == o.EMERGENCY_BASE and node:
                self.emergencies[node] = data
            what = _of_a_master(can_id, own_node)
            if what and self.frames[can_id] == 1:
                self.masters.append(f"{what} {can_id:03X}#{data.hex().upper()}")


def _of_a_master(can_id: int, own_node: int) -> str:
    """Return the name of a frame that only a master sends; "" for any other."""
    if can_id in _OF_A_MASTER:
        return _OF_A_MASTER[can_id]
    if can_id == o.HEARTBEAT_BASE + own_node:
        return f"heartbeat of node {own_node}, our own number"
    return _FUNCTIONS_OF_A_MASTER.get(can_id & _FUNCTION, "")


@dataclass(slots=True)
class CanSurvey:
    """The results of a survey of the CAN bus."""

    lost: str = ""
    """Why the bus cannot be used; "" if it can."""
    traffic: Listened = field(default_factory=Listened)
    present: tuple[int, ...] = ()
    """Numbers of the nodes that answered."""
    surplus: Mapping[int, int] = field(default_factory=dict[int, int])
    """Number of surplus answers, by node."""
    objects: Mapping[int, Mapping[Key, ObjectAnswer]] = field(default_factory=dict[int, Mapping[Key, ObjectAnswer]])
    answers_at: int = 0
    """The bit rate at which the nodes answer, if it is not the rig file's, bit/s; 0 = none found."""

    def number(self, node: int, key: Key) -> int | None:
        """Return an object of a node as a number; None if there was no answer."""
        answer = self.objects.get(node, {}).get(key)
        return None if answer is None else answer.number

    def text(self, node: int, key: Key) -> str:
        """Return an object of a node as a text; "" if there was no answer."""
        answer = self.objects.get(node, {}).get(key)
        return answer.text if answer is not None and answer.ok else ""


def survey_can(rig: Rig, wires: Wires) -> CanSurvey:
    """Listen to the bus, query every node number, and read the objects of those that answer."""
    survey = CanSurvey()
    try:
        port = wires.can(rig.can.bitrate)
        survey.traffic = listen(port, wires, LISTEN_S, rig.can.node)
        others = [node for node in range(1, 128) if node != rig.can.node]
        scan = scanned(port, wires, {node: [PRESENCE] for node in others})
        configs = {config.node_id: config for config in rig.drives().values()}
        awaited = [*configs, *(node.node_id for node in rig.can.nodes.values())]
        missing = [node for node in awaited if node not in scan.answers]
        late = scanned(port, wires, {node: [PRESENCE] for node in missing}, PATIENCE_S)
        survey.present, survey.surplus = tuple(sorted({*scan.answers, *late.answers})), scan.surplus
        wanted = {node: objects_of(configs[node]) if node in configs else list(IDENTITY) for node in survey.present}
        survey.objects = scanned(port, wires, wanted, PATIENCE_S).answers
    except BusLost as lost:
        survey.lost = str(lost)
    if not survey.present and not survey.traffic.frames:
        survey.answers_at = _other_bitrate(rig, wires)
    return survey


def listen(port: CanPort, wires: Wires, seconds: float, own_node: int) -> Listened:
    """Listen for ``seconds`` without sending; raises BusLost."""
    frames, begun_s = Listened(), wires.now()
    port.receive(begun_s)  # discard earlier frames
    due_s = begun_s
    while due_s < begun_s + seconds:
        due_s += 0.01
        wires.wait_until(due_s)
        frames.take(port.receive(wires.now()), own_node)
    frames.seconds = wires.now() - begun_s
    return frames


def objects_of(config: AxisConfig) -> list[Key]:
    """Return every object to read from an axis' drive, each once: the identity and everything that a set-up writes."""
    return list(dict.fromkeys((*IDENTITY, *STATE, actual_of(config), *KEPT, *written(config), *mapped(config))))


def scanned(port: CanPort, wires: Wires, wanted: Mapping[int, Sequence[Key]], timeout_s: float = ANSWER_S) -> SdoScan:
    """Return the completed scan of some objects, by node; raises BusLost."""
    scan, until_s = SdoScan(wanted, timeout_s), wires.now() + MOST_S
    while not scan.done and wires.now() < until_s:
        scan.feed(port.receive(wires.now()), port, wires.now())
        scan.service(port, wires.now())
        wires.wait_until(wires.now() + STEP_S)
    scan.feed(port.receive(wires.now()), port, wires.now())  # a second answer arrives shortly after the first
    return scan


def _other_bitrate(rig: Rig, wires: Wires) -> int:
    """Return the bit rate at which a node of the rig file answers; 0 if none does."""
    nodes = [config.node_id for config in rig.drives().values()]
    for bitrate in wires.bitrates:
        if bitrate == rig.can.bitrate:
            continue
        try:
            port = wires.can(bitrate)
            if scanned(port, wires, {node: [PRESENCE] for node in nodes}).answers:
                return bitrate
        except BusLost:
            continue
    return 0
