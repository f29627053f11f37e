"""Each drive profile against a simulated drive with its maker's dictionary."""

from __future__ import annotations

from dataclasses import replace

import pytest

from drivers.axis import AxisConfig
from drivers.cia402 import REMOTE, Goal, State
from drivers.digital_io import DigitalWiring
from drivers.drives.reader import drive_profile, drive_profile_names
from drivers.screw import Screw
from drivers.servo import ServoDrive
from sim.nodes.cia402_slave import Cia402Slave
from sim.nodes.safety_io import CONTACTOR, GUARD, REQUEST, SAFETY_CHAIN
from tests.sim.drive_bench import NODE, PRESS, WHEEL, YAW, DriveBench, SdoRefusedError
from tests.sim.test_master_meets_drives import Bus

SCREW = Screw(5.0, 0.87, 0.93, 0.010, 0.020, 40.0)
DEADLINE_S = 0.2
PROFILES = [name for name in drive_profile_names() if not drive_profile(name).inverter]
PRESSES = ["cia402", "elmo_gold", "maxon_epos4", "nanotec"]
NO_OBJECT, NO_SUB_INDEX, READ_ONLY = 0x0602_0000, 0x0609_0011, 0x0601_0002


def axes(profile: str) -> tuple[AxisConfig, ...]:
    """A wheel that reports standstill, a press with inputs where the profile suits one, and a yaw axis."""
    press = profile if profile in PRESSES else "cia402"
    return (
        replace(WHEEL, node_id=1, profile=profile, rpdo_deadline_s=DEADLINE_S, speed_zero=0.05),
        replace(PRESS, node_id=3, profile=press, rpdo_deadline_s=DEADLINE_S, screw=SCREW, max_torque_per_mille=400),
        replace(YAW, node_id=4, profile=profile, software_limits=(-30.0, 30.0), position_window=0.05),
    )


def refusal(config: AxisConfig, node: AxisConfig | None = None) -> str:
    """Return the messages of connecting an axis; ``node``: the node as which the drive is built."""
    bus = Bus((config,))
    if node is not None:
        bus.nodes[0].power(False)
        bus.nodes = [Cia402Slave(node, bus.wire)]
    bus.connect()
    return bus.drives[0].refused or ""


@pytest.mark.parametrize("profile", PROFILES)
def test_every_axis_connects_in_one_attempt(profile: str) -> None:
    bus = Bus(axes(profile)).connect()
    assert [(drive.refused, drive.online) for drive in bus.drives] == [(None, True)] * 3


def test_the_generic_profile_does_without_nothing() -> None:
    assert [drive.plan.without for drive in Bus(axes("cia402")).connect().drives] == [[], [], []]


def test_an_epos4_reports_the_objects_it_lacks() -> None:
    wheel, press, _ = Bus(axes("maxon_epos4")).connect().drives
    told = "\n".join(wheel.plan.without)
    assert "0x605D:00 (halt option code): how the axis slows down on halt is the drive's own" in told
    assert "0x1400:05 (RPDO1 event timer (ms)): a PC that sends heartbeats but no setpoints" in told
    assert "no statusword bit 12" in told
    told = "\n".join(press.plan.without)
    assert "0x60FE:02" in told
    assert "0x1801:05 (TPDO2 event timer (ms)): the digital inputs come with every SYNC instead" in told


def test_an_epos4_under_the_generic_profile_is_refused_with_every_object_at_once() -> None:
    config = replace(PRESS, rpdo_deadline_s=DEADLINE_S)
    said = refusal(config, replace(config, profile="maxon_epos4", rated_torque_nm=0.02))
    for missing in ("0x605D:00", "0x6072:00", "0x1400:05", "0x60FE:02", "0x1801:05"):
        assert f"{missing} (" in said


@pytest.mark.parametrize(("profile", "said"), [
    ("kinco_fd", ["0x6072:00", "0x60FE:01", "0x60FD:00", "the torque limit caps the force"]),
    ("elmo_simpliq", ["0x60FE:01"]),
])
def test_a_drive_that_is_not_fit_for_the_press_is_refused_by_name(profile: str, said: list[str]) -> None:
    refused = refusal(replace(PRESS, profile=profile, screw=SCREW))
    assert all(one in refused for one in said), refused


@pytest.mark.parametrize("profile", PRESSES)
def test_the_torque_limit_of_the_press_is_kept(profile: str) -> None:
    bus = Bus(axes(profile)).connect()
    assert bus.nodes[1].torque_limit_nm == pytest.approx(0.4 * PRESS.rated_torque_nm)


@pytest.mark.parametrize("profile", PROFILES)
def test_the_shaft_follows_its_command_in_the_expected_time(profile: str) -> None:
    bus = Bus(axes(profile)).connect().enable()
    wheel, node = bus.drives[0], bus.nodes[0]
    assert wheel.state is State.OPERATION_ENABLED
    wheel.target = 20.0
    bus.tick(100)
    assert node.axis.value == pytest.approx(10.0, abs=0.3)        # 10 rad/s2 for 1 s, less a scan or two
    bus.tick(120)
    assert (node.axis.value, wheel.actual) == (pytest.approx(20.0, abs=0.01), pytest.approx(20.0, abs=0.01))


@pytest.mark.parametrize("profile", PROFILES)
def test_a_quick_stop_slows_down_at_the_rate_of_the_configuration(profile: str) -> None:
    bus = Bus(axes(profile)).connect().enable()
    bus.drives[0].target = 20.0
    bus.tick(250)
    bus.drives[0].goal = Goal.QUICK_STOP
    bus.tick(25)
    assert bus.nodes[0].axis.value == pytest.approx(20.0 - 40.0 * 0.25, abs=1.5)
    bus.tick(40)
    assert bus.nodes[0].axis.value == 0.0


@pytest.mark.parametrize("profile", PROFILES)
def test_without_the_pc_every_drive_stops(profile: str) -> None:
    bus = Bus(axes(profile)).connect().enable()
    bus.drives[0].target, bus.drives[1].target = 20.0, 5.0
    bus.tick(250)
    assert bus.nodes[0].axis.value > 19.0 and bus.nodes[1].axis.value > 4.0
    bus.advance(bus.now + 1.5)
    assert [node.axis.value for node in bus.nodes[:2]] == [0.0, 0.0]


@pytest.mark.parametrize("profile", PROFILES)
def test_a_yaw_axis_is_homed_and_goes_to_its_target(profile: str) -> None:
    bus = Bus(axes(profile)).connect()
    yaw, node = bus.drives[2], bus.nodes[2]
    bus.master.start(yaw, yaw.home())
    bus.converse()
    assert (yaw.refused, yaw.homed) == (None, True)
    yaw.goal = Goal.ENABLED
    bus.tick(30)
    yaw.target = 8.0
    bus.tick(300)
    assert node.axis.position - node.origin == pytest.approx(8.0, abs=0.02)


def test_a_kinco_shows_no_remote_bit_and_is_enabled_all_the_same() -> None:
    bus = Bus(axes("kinco_fd")).connect().enable()
    assert bus.drives[0].statusword & REMOTE == 0
    assert bus.drives[0].state is State.OPERATION_ENABLED


def test_an_acceleration_in_a_kincos_counts_has_a_thousandth_of_a_speeds() -> None:
    drive = Bus(axes("kinco_fd")).connect().drives[0]
    assert drive.parameters[0x6083, 0] == round(WHEEL.acceleration * WHEEL.velocity_increments / 1000)


def test_the_torque_limit_of_an_epos4_is_one_of_current() -> None:
    drive = Bus(axes("maxon_epos4")).connect().drives[1]
    assert drive.parameters[0x3001, 2] == round(0.4 * drive.parameters[0x3001, 1]) == 3200


def test_another_rated_torque_is_refused_by_name() -> None:
    said = refusal(WHEEL, replace(WHEEL, rated_torque_nm=22.0))
    assert "0x6076:00 (motor rated torque (mN m)): read 22000, 22 N m at the shaft" in said
    assert "rated_torque is 20 N m" in said


def test_a_gear_is_between_the_rated_torque_of_the_motor_and_of_the_axis() -> None:
    assert refusal(replace(WHEEL, gear=5.0), replace(WHEEL, rated_torque_nm=4.0)) == ""


def test_a_drive_that_states_no_rated_torque_is_believed() -> None:
    assert refusal(WHEEL, replace(WHEEL, rated_torque_nm=1e-9)) == ""


@pytest.mark.parametrize(("profile", "index", "sub", "code"), [
    ("maxon_epos4", 0x605D, 0, NO_OBJECT), ("maxon_epos4", 0x6072, 0, NO_OBJECT),
    ("maxon_epos4", 0x1400, 5, NO_SUB_INDEX), ("maxon_epos4", 0x60FE, 2, NO_SUB_INDEX),
    ("elmo_gold", 0x1400, 5, NO_SUB_INDEX), ("elmo_simpliq", 0x60FE, 1, NO_OBJECT),
    ("elmo_simpliq", 0x1400, 1, READ_ONLY), ("elmo_simpliq", 0x1801, 1, READ_ONLY),
])
def test_the_simulated_drive_refuses_as_the_makers_does(profile: str, index: int, sub: int, code: int) -> None:
    bench = DriveBench(replace(WHEEL, profile=profile)).boot()
    with pytest.raises(SdoRefusedError) as refused:
        bench.write(index, sub, 1, 4)
    assert refused.value.code == code


def test_the_makers_bits_are_the_programs() -> None:
    wiring = DigitalWiring(safety_chain=2, guard=0, contactor=5, request=1, contactor_inverted=True)
    bus = Bus((replace(PRESS, node_id=3, wiring=wiring),)).connect()
    drive, node = bus.drives[0], bus.nodes[0]
    assert drive.refused is None
    assert drive.inputs == SAFETY_CHAIN | GUARD
    assert node.store.read((0x60FD, 0)) == 1 << 2 | 1 << 0 | 1 << 5
    drive.outputs = REQUEST
    bus.tick(10)
    assert node.store.read((0x60FE, 1)) == 1 << 1
    assert drive.inputs == SAFETY_CHAIN | GUARD | CONTACTOR


def test_parameters_are_written_and_read_back() -> None:
    parameters = {"gear_motor_revolutions": 5, "encoder_increments": 4096}
    drive = Bus((replace(WHEEL, profile="elmo_gold", parameters=parameters),)).connect().drives[0]
    assert (drive.parameters[0x6091, 1], drive.parameters[0x608F, 1]) == (5, 4096)


def test_a_parameter_the_profile_does_not_have_is_refused() -> None:
    with pytest.raises(ValueError, match="profile elmo_gold has no parameter gear"):
        replace(WHEEL, profile="elmo_gold", parameters={"gear": 5})


def test_without_heartbeat_consumer_and_deadline_a_drive_is_refused() -> None:
    config = replace(WHEEL, node_id=NODE)
    without = ServoDrive(config)
    assert without.plan.watched
    from drivers.drive_settings import plan

    made = plan(config, [(0x1016, 1)])
    assert any("it would run on without the PC" in one for one in made.refused)
    made = plan(replace(config, rpdo_deadline_s=0.2, proves_watchdog=False), [(0x1016, 1)])
    assert (made.refused, made.watched) == ([], False)
    assert "only the setpoints are watched" in made.without[0]


@pytest.mark.parametrize("profile", PROFILES)
def test_every_profile_states_its_checks(profile: str) -> None:
    one = drive_profile(profile)
    assert one.title and len(one.checked) > 60
