"""Objects of many nodes read at once, by bytes."""

from __future__ import annotations

from drivers.canopen.scan import ANSWER_S, AT_ONCE, SdoScan
from drivers.ports import CanFrame, FrameByFrame


class Bus(FrameByFrame):
    """A bus whose answers a test writes."""

    def __init__(self) -> None:
        super().__init__()
        self.sent: list[tuple[int, bytes]] = []

    def send(self, can_id: int, data: bytes, now: float) -> None:
        self.sent.append((can_id, data))

    def receive(self, now: float) -> list[CanFrame]:
        return []


ASKED = bytes.fromhex("40 00 10 00 00 00 00 00")
DEVICE_TYPE = bytes.fromhex("43 00 10 00 92 01 02 00")
NO_OBJECT = bytes.fromhex("80 76 60 00 00 00 02 06")


def test_every_node_is_asked_by_an_upload_and_nothing_else() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x1000, 0)], 2: [(0x1000, 0)]})
    scan.service(bus, 0.0)
    assert bus.sent == [(0x601, ASKED), (0x602, ASKED)]


def test_an_answer_is_the_object_of_its_node() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x1000, 0)]})
    scan.service(bus, 0.0)
    scan.feed([(0.001, 0x581, DEVICE_TYPE)], bus, 0.001)
    assert scan.done
    assert scan.answers[1][0x1000, 0].number == 0x20192


def test_a_node_that_is_silent_is_asked_no_more_and_is_no_answer() -> None:
    bus, scan = Bus(), SdoScan({5: [(0x1000, 0), (0x1018, 1)]})
    scan.service(bus, 0.0)
    scan.service(bus, ANSWER_S)
    assert scan.done
    assert scan.answers == {}
    assert not any(data[:4] == bytes.fromhex("40 18 10 01") for _, data in bus.sent)


def test_a_missing_object_is_reported_and_the_next_is_asked() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x6076, 0), (0x1000, 0)]})
    scan.service(bus, 0.0)
    scan.feed([(0.001, 0x581, NO_OBJECT)], bus, 0.001)
    scan.feed([(0.002, 0x581, DEVICE_TYPE)], bus, 0.002)
    assert scan.answers[1][0x6076, 0].missing
    assert scan.answers[1][0x1000, 0].ok


def test_a_second_answer_to_one_question_is_counted() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x1000, 0)], 2: [(0x1000, 0)]})
    scan.service(bus, 0.0)
    scan.feed([(0.001, 0x581, DEVICE_TYPE), (0.001, 0x581, DEVICE_TYPE), (0.001, 0x582, DEVICE_TYPE)], bus, 0.001)
    assert scan.surplus == {1: 1}


def test_an_answer_that_comes_too_late_is_no_second_one() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x1000, 0)]})
    scan.service(bus, 0.0)
    scan.service(bus, ANSWER_S)
    scan.feed([(0.15, 0x581, DEVICE_TYPE)], bus, 0.15)
    assert scan.surplus == {}


def test_no_more_nodes_are_asked_at_once_than_an_adapter_queues() -> None:
    bus, scan = Bus(), SdoScan({node: [(0x1000, 0)] for node in range(1, 20)})
    scan.service(bus, 0.0)
    assert len(bus.sent) == AT_ONCE


def test_a_text_comes_in_segments() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x1008, 0)]})
    scan.service(bus, 0.0)
    scan.feed([(0.001, 0x581, bytes.fromhex("41 08 10 00 09 00 00 00"))], bus, 0.001)
    scan.feed([(0.002, 0x581, b"\x00servo d")], bus, 0.002)
    scan.feed([(0.003, 0x581, b"\x1bri" + bytes(5))], bus, 0.003)
    assert scan.answers[1][0x1008, 0].text == "servo dri"


def test_an_object_outside_the_dictionary_is_a_number_without_a_sign() -> None:
    bus, scan = Bus(), SdoScan({1: [(0x2ABC, 1)]})
    scan.service(bus, 0.0)
    scan.feed([(0.001, 0x581, bytes.fromhex("4F BC 2A 01 FE 00 00 00"))], bus, 0.001)
    answer = scan.answers[1][0x2ABC, 1]
    assert (answer.number, answer.text, answer.describe()) == (0xFE, "254", "0x2ABC:01")
