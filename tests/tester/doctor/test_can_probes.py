"""Error frames on the CAN bus, and an adapter's state, in the watch."""

from __future__ import annotations

from dataclasses import dataclass, field

from drivers.ports import CanFrame
from tester.doctor.bus_watch import RigWatch, watched
from tester.doctor.can_probes import errors
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, Severity
from tester.doctor.open_wires import SimulatedWires
from tester.kinds import load_rig
from tests.tester.doctor.fake_computer import FakeComputer

RIG = load_rig()


class Looked(Examination):
    """A check after its watch."""

    def __init__(self, watch: RigWatch) -> None:
        super().__init__(RIG, FakeComputer(), SimulatedWires(RIG))
        self.__dict__["watch"] = watch


def found(counted: dict[str, int] | None, state: str = "") -> list[Finding]:
    return list(errors(Looked(RigWatch(seconds=60.0, can_errors=counted, can_state=state))))


def test_error_frames_are_reported_by_kind_with_a_remedy() -> None:
    (finding,) = found({"no acknowledgement": 7, "bus error": 2})
    assert finding.severity is Severity.WARNING
    assert finding.found == "error frames in 60 s: 7 no acknowledgement, 2 bus error"
    assert "terminators" in finding.todo


def test_their_absence_is_reported_except_for_an_adapter_that_never_passes_them_on() -> None:
    assert [(one.severity, one.found) for one in found({}, "active")] == [(Severity.OK, "no error frame in 60 s")]
    assert found(None) == []


def test_a_passive_adapter_is_a_fault() -> None:
    assert [one.severity for one in found(None, "passive")] == [Severity.FAULT]


@dataclass
class NoisyPort:
    """A bus without nodes, with errors."""

    errors: dict[str, int] = field(default_factory=dict[str, int])
    state: str = "passive"

    def send(self, can_id: int, data: bytes, now: float) -> None: ...

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None: ...

    def receive(self, now: float) -> list[CanFrame]:
        self.errors["bus error"] = self.errors.get("bus error", 0) + 1
        return []

    def watch(self, watcher: object) -> None: ...


class NoisyWires(SimulatedWires):
    """Wires of a rig whose bus is noisy."""

    def can(self, bitrate: int) -> NoisyPort:  # type: ignore[override]
        return NoisyPort()


def test_the_watch_takes_them_from_the_adapter() -> None:
    watch = watched(RIG, NoisyWires(RIG), {}, 0.1, can=True)
    assert watch.can_errors is not None
    assert watch.can_errors["bus error"] >= 10
    assert watch.can_state == "passive"
    assert watched(RIG, SimulatedWires(RIG), {}, 0.1, can=True).can_errors is None
