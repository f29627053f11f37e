"""The rig file: the packaged one, overrides, consistency."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.physics.parameters import SimParameters
from tester.base.source import InvalidSource
from tester.inputs.rig.checks import bus_load
from tester.kinds import hardware_text, load_rig, packaged_text
from tester.kinds.wheel_on_belt.rig import RigConfig


@pytest.fixture(scope="module")
def rig() -> RigConfig:
    return load_rig()


def problems(*overrides: str) -> list[str]:
    with pytest.raises(InvalidSource) as caught:
        load_rig("sim", overrides)
    return [str(problem) for problem in caught.value.problems]


def file_problems(path: Path, text: str) -> list[str]:
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InvalidSource) as caught:
        load_rig(path)
    return [str(problem) for problem in caught.value.problems]


def test_packaged_rig_has_the_hard_limits_of_the_interface(rig: RigConfig) -> None:
    limits = rig.limits
    assert (limits.load_n, limits.wheel_speed_m_s, limits.belt_speed_m_s, limits.slip_power_w) == (440, 1.1, 1.3, 350)
    assert (limits.jacket_c, limits.surface_c, limits.sideslip_deg, limits.camber_deg) == (138, 95, 30, 10)


def test_packaged_rig_has_nodes_1_to_5_and_the_pc_at_127(rig: RigConfig) -> None:
    assert {name: axis.node_id for name, axis in rig.axes.driven().items()} == {
        "wheel": 1, "belt": 2, "press": 3, "sideslip": 4, "camber": 5,
    }  # fmt: skip
    assert rig.can.node == 127


def test_packaged_rig_writes_out_the_defaults_of_the_simulated_physics(rig: RigConfig) -> None:
    assert rig.sim == SimParameters()


def test_packaged_observer_matches_the_simulated_wheel(rig: RigConfig) -> None:
    assert (rig.observer.wheel, rig.observer.thermal) == (rig.sim.wheel, rig.sim.thermal)


def test_packaged_bus_load_is_26_percent_at_100_hz(rig: RigConfig) -> None:
    assert bus_load(rig, rig.scan.sliding_hz) == pytest.approx(0.261)


def test_axes_get_their_heartbeats_from_the_bus_section() -> None:
    rig = load_rig("sim", ["can.drive_heartbeat=80 ms", "can.consumer_heartbeat=240 ms"])
    assert {(axis.heartbeat_s, axis.consumer_heartbeat_s) for axis in rig.axes.driven().values()} == {(0.08, 0.24)}


def test_axes_are_named_by_their_keys(rig: RigConfig) -> None:
    assert all(axis.name == name for name, axis in rig.axes.driven().items())


def test_an_axis_may_be_manual() -> None:
    rig = load_rig("sim", ["axes.camber={manual: true}"])
    assert rig.axes.camber is None and "camber" not in rig.axes.driven()


@pytest.mark.parametrize("axis", ["wheel", "belt", "press"])
def test_an_axis_that_the_scan_turns_cannot_be_manual(axis: str) -> None:
    assert any('unknown key "manual"' in problem for problem in problems(f"axes.{axis}={{manual: true}}"))


def test_ambient_of_a_simulated_rig_is_the_simulation_s() -> None:
    assert load_rig("sim", ["sim.ambient=27 degC"]).ambient_c == 27.0


@pytest.mark.parametrize(
    ("override", "section", "key", "value"),
    [
        ("sim.noise=0", "sim", "noise", 0.0),
        ("sim.ambient=25 degC", "sim", "ambient", 25.0),
        ("sim.ambient=25", "sim", "ambient", 25.0),
        ("sim.friction_heat_fraction=0.5", "sim", "friction_heat_fraction", 0.5),
        ("sim.friction_model=v2", "sim", "friction_model", "v2"),
        ("limits.load=0.3 kN", "limits", "load_n", 300.0),
    ],
)
def test_set_replaces_one_key(override: str, section: str, key: str, value: object) -> None:
    assert getattr(getattr(load_rig("sim", [override]), section), key) == value


def test_the_last_of_two_overrides_of_a_key_counts() -> None:
    assert load_rig("sim", ["sim.noise=0", "sim.noise=2"]).sim.noise == 2.0


def test_set_of_an_unknown_key_names_the_nearest() -> None:
    (problem,) = problems("sim.nosie=0")
    assert problem.startswith('--set sim.nosie=0:1:1: unknown key "nosie", did you mean noise?')


def test_set_of_an_unknown_section_names_the_nearest() -> None:
    (problem,) = problems("gate.load=2 %")
    assert problem.startswith('--set gate.load=2 %:1:1: unknown key "gate", did you mean gates?')


def test_set_of_a_wrong_unit_names_those_accepted() -> None:
    (problem,) = problems("limits.load=3 m/s")
    assert "--set limits.load=3 m/s" in problem and "units accepted: N, kN" in problem


def test_set_of_a_value_that_a_section_refuses_is_reported_as_the_override_s() -> None:
    (problem,) = problems("sim.thermal.cells=1")
    assert problem.startswith("--set sim.thermal.cells=1:1:1: ")


@pytest.mark.parametrize("override", ["sim.noise", "=3", "sim..noise=3", "sim.noise=", "sim.noise.x=1", "sim.noise=["])
def test_set_that_is_no_key_and_value_is_refused(override: str) -> None:
    (problem,) = problems(override)
    assert problem.startswith("--set ")


def test_every_bad_override_is_reported() -> None:
    assert len(problems("sim.nosie=0", "limits.load=1 m", "scan.idle=0")) == 3


@pytest.mark.parametrize(
    ("override", "place"),
    [
        ("axes.press.node_id=2", "belt already"),
        ("can.node=3", "the PC already"),
        ("can.node=128", "not a CANopen node"),
        ("axes.press.node_id=0", "node id 0 is not within 1..126"),
        ("axes.belt.deceleration=3", "must be equal within 5 %"),
        ("axes.wheel.quick_stop_deceleration=300", "must be equal within 5 %"),
        ("axes.wheel.max_speed=20", "less than limits.wheel_speed"),
        ("axes.belt.max_speed=1", "less than limits.belt_speed"),
        ("axes.belt.unit=mm/s", "the belt axis is in m/s"),
        ("axes.press.digital_io=false", "safety chain"),
        ("axes.sideslip.mode=velocity", "driven by position"),
        ("axes.belt.name=wheel", "expected belt"),
        ("axes.press.software_limits=[-1, 40]", "expected within -9 to 27"),
        ("axes.camber.software_limits=[-90, 11]", "expected within -20 to 20"),
        ("observer.wheel.width=40 mm", "geometry.wheel_width is 30 mm"),
        ("geometry.wheel_diameter=96 mm", "geometry.wheel_diameter is 96 mm"),
        ("can.bitrate=250000", "loads the CAN bus with 52 %"),
        ("devices.jacket.line=heet", "did you mean heat?"),
        ("devices.jacket.unit_id=2", "2 on line heat is jacket already"),
        ("devices.jacket.unit_id=0", "not a Modbus address"),
        ("devices.jacket.profile=eurotherm", "no device profile 'eurotherm'"),
        ("devices.jacket.profile=calex_pyrominibus", "kind ir_thermometer (expected jacket)"),
        ("lines.heat.baud=0", "baud rate above 0"),
        ("loops.heat.hub_max=141 degC", "above limits.jacket"),
        ("loops.heat.hub_min=140 degC", "not below hub_max"),
        ("loops.load.lift_speed=70 mm/s", "above axes.press.max_speed"),
        ("loops.load.acceleration=1.1 m/s2", "above what axes.press can follow"),
        ("lines.heat.port=/dev/ttyUSB0", 'a simulated rig has "sim" here'),
        ("can.interface=socketcan", 'a simulated rig has "sim" here'),
        ("limits.load=501 N", "too large"),
        ("limits.load=450 N", "press with 498 N with the least"),
        ("axes.press.screw.efficiency_least=0.8", "lower limits.load, or narrow down efficiency"),
        ("axes.press.max_torque_per_mille=200", "surely press with 375 N only"),
        ("axes.press.screw.lead=0 mm", "lead must be above 0 mm"),
    ],
)
def test_inconsistent_values_are_refused(override: str, place: str) -> None:
    assert any(place in problem for problem in problems(override))


def test_one_port_for_two_lines_is_refused() -> None:
    found = problems("lines.heat.port=/dev/ttyUSB0", "lines.load_cell.port=/dev/ttyUSB0")
    assert any("/dev/ttyUSB0 is the port of line" in problem for problem in found)


def test_a_file_that_is_not_there_is_a_problem(tmp_path: Path) -> None:
    with pytest.raises(InvalidSource, match="no such file"):
        load_rig(tmp_path / "none.yaml")


def test_a_problem_of_a_file_has_its_line_and_column(tmp_path: Path) -> None:
    text = packaged_text().replace("  load: 440 N ", "  laod: 440 N ")
    line = text[: text.index("laod")].count("\n") + 1
    found = file_problems(tmp_path / "rig.yaml", text)
    (problem,) = found  # the missing key is not a second mistake
    assert f'rig.yaml:{line}:3: unknown key "laod", did you mean load?' in problem


def test_a_limit_is_never_taken_from_the_program(tmp_path: Path) -> None:
    text = packaged_text().replace("  surface: 95 degC ", "  # surface: ")
    assert any("surface is missing" in problem for problem in file_problems(tmp_path / "rig.yaml", text))


@pytest.mark.parametrize(("load", "per_mille"), [("440 N", 230), ("300 N", 166), ("100 N", 75)])
def test_press_gets_the_torque_for_the_limit_of_the_load_and_no_more(load: str, per_mille: int) -> None:
    assert load_rig("sim", [f"limits.load={load}"]).axes.press.max_torque_per_mille == per_mille


def test_press_gets_less_torque_where_the_file_limits_it() -> None:
    rig = load_rig("sim", ["limits.load=300 N", "axes.press.max_torque_per_mille=500"])
    assert rig.axes.press.max_torque_per_mille == 166
    assert rig.axes.wheel.max_torque_per_mille == 3000


def test_press_without_a_known_screw_keeps_the_torque_of_its_file(tmp_path: Path) -> None:
    text = packaged_text()
    begin = text.index("    screw:")
    path = tmp_path / "rig.yaml"
    path.write_text(text[:begin] + text[text.index("    max_speed: 60   ") :], encoding="utf-8")
    press = load_rig(path).axes.press
    assert press.screw is None and press.max_torque_per_mille == 3000


def test_resolved_text_reads_back_as_the_same_rig(tmp_path: Path) -> None:
    rig = load_rig("sim", ["sim.noise=0.3", "axes.camber={manual: true}", "limits.load=123.456 N"])
    path = tmp_path / "rig.yaml"
    path.write_text(rig.text, encoding="utf-8")
    assert load_rig(path) == rig


def test_hardware_file_is_a_rig_without_simulated_wires(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(hardware_text(), encoding="utf-8")
    rig = load_rig(path)
    assert not rig.simulated and rig.can.interface == "socketcan"
    assert {line.port for line in rig.lines.values()} == {"/dev/ttyUSB0", "/dev/ttyUSB1"}


def test_hardware_file_does_not_speak_of_the_simulation() -> None:
    body = hardware_text().partition("\nrig: ")[2]
    assert "sim" not in body.replace("simulated: false", "")


def test_hardware_file_has_every_limit_and_interlock_of_the_packaged_one(tmp_path: Path, rig: RigConfig) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(hardware_text(), encoding="utf-8")
    own = load_rig(path)
    assert (own.limits, own.interlocks, own.loops, own.gates) == (rig.limits, rig.interlocks, rig.loops, rig.gates)


def test_inputs_may_not_go_stale_by_a_single_lost_frame() -> None:
    (problem,) = problems("interlocks.stale_inputs=150 ms")
    assert "a single lost frame would stop the rig" in problem


@pytest.mark.parametrize("value", ["0 N", "51 N"])
def test_the_reading_of_an_unloaded_cell_is_bounded(value: str) -> None:
    assert problems(f"arming.unloaded={value}")


def test_the_file_for_a_real_machine_states_the_bound_of_an_unloaded_cell() -> None:
    assert "  unloaded: 20 N" in hardware_text() and "  stale_inputs: 250 ms" in hardware_text()
