"""Our CAN master against PyPI canopen as the device: its SDO server, NMT slave, heartbeat and PDO decoding.

The two share python-can's virtual bus. canopen runs in its own threads; every wait here is bounded.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from threading import Event

import can
import canopen
import pytest
from canopen.objectdictionary import ODVariable

from drivers.canopen.conversation import Conversation, RequestError, SdoRead, SdoWrite
from drivers.canopen.eds import EDS_PATH
from drivers.canopen.master import CanMaster
from drivers.canopen.objects import DataType
from drivers.cia402 import Goal, State
from drivers.servo import ServoDrive
from drivers.transports.can_bus import PythonCanPort, open_can
from tests.drivers.can_bench import NODE, wheel

TEXT_OBJECT = 0x2100
_channels = itertools.count()


class Device:
    """A canopen LocalNode that boots on reset and confirms its mode, on a virtual bus of its own."""

    def __init__(self, channel: str) -> None:
        dictionary = canopen.import_od(str(EDS_PATH), node_id=NODE)
        text = ODVariable("text", TEXT_OBJECT, 0)
        text.data_type, text.access_type, text.default = DataType.TEXT, "rw", ""
        dictionary.add_object(text)
        self.network = canopen.Network()
        self.network.NOTIFIER_CYCLE = 0.02      # s; how long its thread takes to notice the end
        self.network.connect(interface="virtual", channel=channel)
        self.node = canopen.LocalNode(NODE, dictionary)
        self.network.add_node(self.node)
        self.node.set_data(0x6041, 0, b"\x40\x02")
        self.node.add_write_callback(self._on_write)
        self.network.subscribe(0, self._on_nmt)

    def _on_write(self, index: int, data: bytes, **_: object) -> None:
        if index == 0x6060:
            self.node.set_data(0x6061, 0, data)

    def _on_nmt(self, _can_id: int, data: bytes, _timestamp: float) -> None:
        if bytes(data) == bytes((130, NODE)):
            self.node.nmt.send_command(0)
            self.node.nmt.send_command(128)

    def close(self) -> None:
        self.node.nmt.stop_heartbeat()
        self.network.disconnect()


@pytest.fixture
def channel() -> str:
    return f"peer-{next(_channels)}"


@pytest.fixture
def device(channel: str) -> Iterator[Device]:
    made = Device(channel)
    yield made
    made.close()


@pytest.fixture
def port(channel: str, device: Device) -> Iterator[PythonCanPort]:
    opened = open_can("virtual", channel, 500_000)
    yield opened
    opened.close()


def run(master: CanMaster, drive: ServoDrive, port: PythonCanPort, seconds: float) -> None:
    """Serve the master every millisecond or more slowly; time here is the number of rounds."""
    pause = Event()
    for tick in range(round(seconds * 1000)):
        now = tick / 1000
        master.feed(port.receive(now), now)
        master.service(port, now)
        if not master.busy(drive):
            return
        pause.wait(0.001)


def talk_to(port: PythonCanPort, conversation: Conversation) -> None:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    master.start(drive, conversation)
    run(master, drive, port, seconds=3.0)
    assert not master.busy(drive)


@pytest.fixture
def connected(device: Device, port: PythonCanPort) -> tuple[CanMaster, ServoDrive]:
    master = CanMaster()
    drive = ServoDrive(wheel())
    master.add(drive)
    master.start(drive, drive.connect())
    run(master, drive, port, seconds=10.0)
    return master, drive


def test_bring_up_ends_operational_with_every_parameter_in_the_device(
        connected: tuple[CanMaster, ServoDrive], device: Device) -> None:
    _, drive = connected
    assert (drive.refused, drive.online, drive.state) == (None, True, State.SWITCH_ON_DISABLED)
    assert device.node.nmt.state == "OPERATIONAL"
    od = device.node.sdo
    assert od[0x1016][1].raw == 0x007F00C8
    assert (od[0x1017].raw, od[0x6085].raw, od[0x6061].raw) == (50, 60_000, 3)


def test_canopen_decodes_our_rpdo_by_the_mapping_we_configured(
        connected: tuple[CanMaster, ServoDrive], device: Device, port: PythonCanPort, channel: str) -> None:
    master, drive = connected
    drive.goal = Goal.ENABLED
    drive.on_tpdo1(1.0, bytes.fromhex("2702 00000000 0000"))
    drive.target = -12.5
    with can.Bus(interface="virtual", channel=channel) as listener:
        master.scan(port, 1.0)
        message = listener.recv(2.0)
    assert message is not None
    mapped = device.node.rpdo[1]
    mapped.read()
    mapped.data = bytearray(message.data)
    assert message.arbitration_id == mapped.cob_id
    assert [(variable.index, variable.raw) for variable in mapped] == [(0x6040, 0x0F), (0x60FF, -12_500)]


def test_a_long_text_is_read_in_segments(device: Device, port: PythonCanPort) -> None:
    read: list[object] = []

    def talk() -> Conversation:
        read.append((yield SdoRead(0x1008)))
    talk_to(port, talk())
    assert read == ["friction-tester servo drive"]


@pytest.mark.parametrize("text", ["x", "four", "seven..", "fourteen bytes", "a text of more than three segments"])
def test_a_text_of_any_length_is_written_and_read_back(device: Device, port: PythonCanPort, text: str) -> None:
    read: list[object] = []

    def talk() -> Conversation:
        yield SdoWrite(TEXT_OBJECT, 0, text, DataType.TEXT)
        read.append((yield SdoRead(TEXT_OBJECT, 0, DataType.TEXT)))
    talk_to(port, talk())
    assert read == [text]
    assert device.node.get_data(TEXT_OBJECT, 0) == text.encode()


@pytest.mark.parametrize(("request_made", "code"), [
    (SdoRead(0x2FFF, 0, DataType.U8), 0x06020000),
    (SdoRead(0x1018, 9, DataType.U32), 0x06090011),
    (SdoWrite(0x6041, 0, 0), 0x06010002),
    (SdoWrite(0x6040, 0, 0, DataType.U32), 0x06070010),
])
def test_aborts_arrive_with_their_code(device: Device, port: PythonCanPort, request_made: SdoRead | SdoWrite,
                                       code: int) -> None:
    codes: list[int] = []

    def talk() -> Conversation:
        try:
            yield request_made
        except RequestError as error:
            codes.append(error.code)
    talk_to(port, talk())
    assert codes == [code]


def test_an_emergency_of_canopen_arrives(connected: tuple[CanMaster, ServoDrive], device: Device,
                                         port: PythonCanPort) -> None:
    master, drive = connected
    device.node.emcy.send(0x4310, 0x09, b"\x01\x02")
    pause = Event()
    for _ in range(400):
        master.feed(port.receive(1.0), 1.0)
        if drive.emergency is not None:
            break
        pause.wait(0.005)
    assert drive.emergency is not None
    assert (drive.emergency.code, drive.emergency.register) == (0x4310, 0x09)
