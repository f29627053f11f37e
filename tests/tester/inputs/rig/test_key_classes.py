"""Classes of keys: keys that need an accepted risk, and keys that only a real rig's file sets."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from drivers.axis import AxisConfig
from drivers.canopen.dictionary import VENDOR_ID
from drivers.canopen.node_config import NodeConfig
from tester.base.config_reader import entries
from tester.base.source import InvalidSource
from tester.inputs.rig.config import Rig
from tester.inputs.rig.key_classes import LOWER, Ceiling
from tester.inputs.rig.key_table import classed, in_words
from tester.inputs.rig.rig_files import risks_of
from tester.inputs.rig.rig_keys import RigKey, ceilings_of, keys_of
from tester.inputs.rig.risks import beyond, counts_as_simulated
from tester.inputs.rig.section_classes import AXIS, NODE
from tester.kinds import PACKAGED, find, load_rig, load_rig_text, packaged_text
from tester.kinds.wheel_on_belt.rig import RigConfig
from tester.kinds.wheel_on_belt.rig.axis_classes import BELT, PRESS, WHEEL
from tests.tester.machine.plain.bench import BenchRig

CEILINGS = ceilings_of(RigConfig)
NONSENSE = (
    "interlocks.depth_factor=1e9", "interlocks.late_scan=1000", "limits.slip_power=1e6",
    "arming.watchdog_proof=false", "arming.bump_test=false", "limits.load=1e4 N", "limits.jacket=-1 degC",
    "limits.surface=.nan",
    "limits.wheel_speed=.inf", "arming.creep=100 m/s", "interlocks.stale_cell=1 h", "interlocks.overload_factor=50",
    "interlocks.model=1000 K", "interlocks.stop_timeout=1e6 s", "interlocks.cooldown_hub=300 degC",
    "interlocks.contact_share=0", "can.consumer_heartbeat=60 s", "axes.belt.rpdo_deadline=0 s", "scan.sliding=0.001 Hz",
    "loops.load.lift_speed=1e-6 mm/s",
)  # fmt: skip


def refused(path: Path | str, *overrides: str, accept_risk: str = "") -> str:
    with pytest.raises(InvalidSource) as caught:
        load_rig(path, overrides, accept_risk)
    return str(caught.value)


@pytest.fixture
def machine(tmp_path: Path) -> Path:
    """Return the file of a real rig, whose drives are not the simulator's."""
    text = packaged_text().replace("simulated: true", "simulated: false")
    text = text.replace("interface: sim ", "interface: socketcan ")
    for port in range(text.count("port: sim")):
        text = text.replace("port: sim", f"port: /dev/ttyUSB{port}", 1)
    path = tmp_path / "rig.yaml"
    path.write_text(text.replace(f"0x{VENDOR_ID:08X}", "0x00000123"), encoding="utf-8")
    return path


def edited(path: Path, before: str, after: str) -> Path:
    text = path.read_text(encoding="utf-8")
    assert text.count(before) == 1
    path.write_text(text.replace(before, after), encoding="utf-8")
    return path


@pytest.mark.parametrize("override", NONSENSE)
def test_nonsense_is_refused_by_its_key_on_any_rig(override: str, machine: Path) -> None:
    assert len(NONSENSE) == 20
    for rig in ("sim", machine):
        assert f"--set {override}" in refused(rig, override)


@pytest.mark.parametrize("override", NONSENSE)
def test_nonsense_in_a_rig_file_is_refused_without_a_word_for_it(override: str, tmp_path: Path) -> None:
    key, _, value = override.partition("=")
    content = yaml.safe_load(packaged_text())
    *sections, last = key.split(".")
    section = content
    for name in sections:
        section = section.setdefault(name, {})
    section[last] = yaml.safe_load(value)
    path = tmp_path / "rig.yaml"
    path.write_text(yaml.safe_dump(content), encoding="utf-8")
    said = refused(path)
    assert last in said or "is not a finite number" in said


@pytest.mark.parametrize("kind", [*(find(name).rig() for name in PACKAGED), BenchRig])
def test_every_key_has_a_class(kind: type[Rig]) -> None:
    """Fails for an unclassified key of a section, of a row, or of a plain kind."""
    assert [one.key for one in keys_of(kind) if not one.classes] == []
    assert all(any(in_words(one)) and in_words(one)[1] for _, one in classed(kind))


def test_only_the_file_sets_a_key_without_a_class() -> None:
    assert RigKey(("new",), "", ()).described


def test_every_class_that_a_section_states_belongs_to_a_key_of_it() -> None:
    for stated, of in (
        (AXIS, AxisConfig),
        (WHEEL, AxisConfig),
        (BELT, AxisConfig),
        (PRESS, AxisConfig),
        (NODE, NodeConfig),
    ):
        assert stated.keys() <= {entry.key for entry in entries(of)}


def test_the_packaged_rig_is_within_every_ceiling() -> None:
    rig = load_rig()
    assert beyond(rig) == () and risks_of(rig) == ()
    assert len({(one.key, one.bound.direction) for one in CEILINGS}) == len(CEILINGS)


@pytest.mark.parametrize("ceiling", CEILINGS, ids=lambda one: one.key)
def test_a_ceiling_allows_its_hardest_value_and_nothing_looser(ceiling: Ceiling) -> None:
    limit, step = ceiling.limit, 1e-6 if ceiling.bound.direction is LOWER else -1e-6
    assert not ceiling.looser(limit, limit) and not ceiling.looser(limit - step, limit)
    assert ceiling.looser(limit + step, limit) and ceiling.looser(float("nan"), limit)
    assert ceiling.bound.because


def test_a_refusal_names_value_hardest_value_reason_and_remedy() -> None:
    said = refused("sim", "limits.slip_power=500 W")
    assert "limits.slip_power: 500 W is looser than 400 W" in said
    assert "rated torque" in said and "--accept-risk REASON" in said


def test_a_value_of_the_file_is_reported_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(packaged_text().replace("watchdog_proof: true ", "watchdog_proof: false "), encoding="utf-8")
    line = next(i for i, text in enumerate(path.read_text().splitlines(), 1) if "watchdog_proof: false" in text)
    assert f"rig.yaml:{line}:" in refused(path)


def test_a_simulated_rig_is_set_freely_within_the_hardest_values_and_beyond_with_a_reason() -> None:
    assert risks_of(load_rig("sim", ["limits.slip_power=400 W"])) == ()
    rig = load_rig("sim", ["limits.slip_power=500 W"], "a try")
    assert [str(one) for one in risks_of(rig)] == ["limits.slip_power 500 W is looser than 400 W"]


def test_a_heartbeat_that_all_drives_share_is_one_risk() -> None:
    rig = load_rig("sim", ["can.consumer_heartbeat=2 s"], "a try")
    assert [one.key for one in risks_of(rig)] == ["can.consumer_heartbeat"]


def test_on_a_real_rig_set_may_tighten_and_nothing_else_even_with_a_reason(machine: Path) -> None:
    assert load_rig(machine, ["limits.load=300 N"]).limits.load_n == 300.0
    edited(machine, "load: 440 N ", "load: 300 N ")
    for reason in ("", "because"):
        assert "--set may only tighten" in refused(machine, "limits.load=310 N", accept_risk=reason)


def test_a_real_rig_that_is_looser_than_the_packaged_one_wants_a_reason(machine: Path) -> None:
    edited(machine, "slip_power: 350 W ", "slip_power: 360 W ")
    assert "360 W is looser than 350 W" in refused(machine)
    rig = load_rig(machine, accept_risk="a stronger drive")
    assert [one.key for one in risks_of(rig)] == ["limits.slip_power"]
    assert load_rig(machine, ["limits.slip_power=350 W"]).limits.slip_power_w == 350.0


def test_a_rig_whose_every_drive_must_be_the_simulators_counts_as_simulated(machine: Path) -> None:
    assert not counts_as_simulated(load_rig(machine))
    one_real = machine.read_text(encoding="utf-8").replace("0x00000123", f"0x{VENDOR_ID:08X}", 4)
    assert not counts_as_simulated(load_rig_text(one_real))
    none_real = machine.read_text(encoding="utf-8").replace("0x00000123", f"0x{VENDOR_ID:08X}")
    assert counts_as_simulated(load_rig_text(none_real))


def test_a_drive_whose_identity_is_not_compared_is_a_real_one(machine: Path) -> None:
    text = machine.read_text(encoding="utf-8").replace("0x00000123", "0")
    assert not counts_as_simulated(load_rig_text(text))


@pytest.mark.parametrize("override", ["axes.belt.rated_torque=17", "geometry.touch=11 mm", "like=sim", "wear.rate=0.1"])
def test_on_a_real_rig_only_the_file_describes_the_machine_even_with_a_reason(override: str, machine: Path) -> None:
    load_rig("sim", [override])
    for reason in ("", "because"):
        said = refused(machine, override, accept_risk=reason)
        assert f"--set {override}" in said and "only the file of a real rig" in said and "held against" in said


def test_on_a_real_rig_set_may_set_free_keys(machine: Path) -> None:
    assert load_rig(machine, ["loops.heat.outer_gain=2", "interlocks.open=2 min"]).loops.heat.outer_gain == 2.0


def test_a_value_that_every_machine_has_of_its_own_is_bounded_by_its_hardest_only(machine: Path) -> None:
    edited(machine, "    bandwidth: 1.0 Hz ", "    bandwidth: 1.5 Hz ")
    assert risks_of(load_rig(machine)) == ()
    assert "--set may only tighten" in refused(machine, "loops.load.bandwidth=1.6 Hz")
    assert load_rig(machine, ["loops.load.bandwidth=1.4 Hz"]).loops.load.bandwidth_hz == 1.4


def test_no_override_makes_a_real_rig_a_simulated_one(machine: Path) -> None:
    identities = [f"axes.{name}.vendor_id={VENDOR_ID}" for name in ("wheel", "belt", "press", "sideslip", "camber")]
    assert "only the file of a real rig" in refused(machine, *identities)


def test_a_belief_of_the_heat_far_off_the_packaged_one_wants_a_reason_on_a_real_rig(machine: Path) -> None:
    text = machine.read_text(encoding="utf-8").replace("    jacket_power: 200 W ", "    jacket_power: 1 W ", 1)
    machine.write_text(text, encoding="utf-8")
    said = refused(machine)
    assert "observer.thermal.jacket_power: 1 W is not within 30 % of 200 W" in said and "--accept-risk REASON" in said
    rig = load_rig(machine, accept_risk="another heater")
    assert [one.key for one in risks_of(rig)] == ["observer.thermal.jacket_power"]
