"""The drives' set-up that a run keeps at its good end."""

from __future__ import annotations

from drivers.canopen.objects import RATED_TORQUE
from sim.machines.wheel_on_belt.rig import WheelRig
from tester.kinds import load_rig
from tester.run.kept import record_kept
from tester.run.simulated import simulated_ports

RIG = load_rig("sim")


class Notes:
    """A recorder that keeps the parameters it is given."""

    def __init__(self) -> None:
        self.rows: dict[tuple[str, str], tuple[str, str]] = {}

    def device_parameter(self, t_s: float, device: str, parameter: str, value: str, name: str = "") -> None:
        self.rows[device, parameter] = value, name


def kept(rig: WheelRig, ports: object) -> Notes:
    notes = Notes()
    record_kept(RIG, ports, rig, rig.now_s, notes)  # type: ignore[arg-type]
    return notes


def made() -> tuple[object, WheelRig]:
    ports, rig, _ = simulated_ports(RIG, 0, None)
    assert isinstance(rig, WheelRig)
    rig.advance(1.0)
    return ports, rig


def test_identity_and_ratings_of_every_drive_are_kept() -> None:
    ports, rig = made()
    rows = kept(rig, ports).rows
    for name, config in RIG.drives().items():
        assert rows[name, "0x1018:04"][0] == str(config.node_id)
        assert rows[name, "0x6076:00"] == (str(round(config.rated_torque_nm * 1000)), "motor rated torque (mN m)")


def test_an_object_that_a_drive_does_not_have_is_left_out() -> None:
    ports, rig = made()
    assert ("belt", "0x6091:01") not in kept(rig, ports).rows


def test_drives_answer_by_the_clock_of_the_wires_which_leaps_hold() -> None:
    track = load_rig("grosch")
    ports, rig, _ = simulated_ports(track, 0, None)
    rig.advance(1.0)
    rig.leap(600.0, {})
    notes, before_s = Notes(), rig.can.occupied_s
    record_kept(track, ports, rig, 601.0, notes, 600.0)  # type: ignore[arg-type]
    assert {device for device, _ in notes.rows} == set(track.drives())
    assert rig.can.occupied_s - before_s < 0.1  # no heartbeats of ten minutes


def test_nothing_of_a_drive_changes() -> None:
    ports, rig = made()
    before = {name: dict(drive.store.values) for name, drive in rig.axes.items()}
    kept(rig, ports)
    assert {name: dict(drive.store.values) for name, drive in rig.axes.items()} == before


def test_a_drive_that_is_gone_leaves_the_others() -> None:
    ports, rig = made()
    rig.axes["belt"].power(False)
    devices = {device for device, _ in kept(rig, ports).rows}
    assert devices == set(RIG.drives()) - {"belt"}


def test_a_bus_that_is_gone_leaves_nothing_and_no_error() -> None:
    ports, rig = made()
    rig.can.disconnect()
    assert kept(rig, ports).rows == {}


def test_a_value_that_was_changed_by_a_person_is_kept_as_it_is() -> None:
    ports, rig = made()
    rig.axes["press"].store.values[RATED_TORQUE, 0] = 1234
    assert kept(rig, ports).rows["press", "0x6076:00"][0] == "1234"
