"""Safety keys: what nobody may write without a word for it, and where only tighter values count."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import pytest
import yaml

from drivers.canopen.dictionary import VENDOR_ID
from tester.base.config_reader import key_of
from tester.base.source import InvalidSource
from tester.inputs.rig.rig_files import risks_of
from tester.inputs.rig.risks import beyond, counts_as_simulated
from tester.kinds import load_rig, load_rig_text, packaged_text
from tester.kinds.wheel_on_belt.interlocks.table import PARAMETERS
from tester.kinds.wheel_on_belt.rig.wheel_ceilings import CEILINGS

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


NO_HARM = {
    "interlocks": {
        "late_warn": "a warning", "zero_warn": "a warning", "ack_wait": "how long a repair is waited for",
        "cold": "when a wheel may be told by its stiffness", "cooldown_at_most": "a wheel that cools for longer",
        "open_output": "a heater that does not heat", "open": "a heater that does not heat",
        "open_below": "a heater that does not heat", "open_rise": "a heater that does not heat",
    },
    "loops.load": {
        "bandwidth": "a loop that swings is tripped by the load it makes", "rolling_bandwidth": "as bandwidth",
        "error_filter": "as bandwidth", "stiffness": "as bandwidth", "integral": "as bandwidth",
        "acceleration": "as bandwidth",
        "open_share": "which touch is swept at low load",
    },
    "loops.heat": {
        "outer_gain": "the setpoint ends at hub_max", "outer_integral": "as outer_gain",
        "integral_band": "as outer_gain", "integral_limit": "as outer_gain", "hub_min": "as outer_gain",
        "period": "as outer_gain", "rolling_offset": "as outer_gain",
    },
    "limits": {}, "arming": {}, "scan": {},
    "can": {
        **dict.fromkeys(("interface", "channel", "bitrate", "node"), "which wire, not what is on it"),
        "nodes": "they measure, and no interlock looks at them",
    },
}  # fmt: skip
"""Keys that no harm hangs on, and why."""


@pytest.mark.parametrize("section", NO_HARM)
def test_every_key_has_a_ceiling_or_a_reason_for_none(section: str) -> None:
    """A new key of a row or of a section is in one of both, or fails here."""
    if section == "interlocks":
        keys = {one.key for one in PARAMETERS}
    else:
        kind = load_rig()
        for name in section.split("."):
            kind = getattr(kind, name)
        keys = {key_of(type(kind), field.name) for field in fields(kind)}
    bounded = {one.key.removeprefix(f"{section}.") for one in CEILINGS if one.key.startswith(f"{section}.")}
    assert bounded | set(NO_HARM[section]) == keys and not bounded & set(NO_HARM[section])


def test_the_packaged_rig_is_within_every_ceiling() -> None:
    rig = load_rig()
    assert beyond(rig) == () and risks_of(rig) == ()
    assert len({one.key for one in CEILINGS}) == len(CEILINGS)


@pytest.mark.parametrize("one", CEILINGS, ids=lambda one: one.key)
def test_a_ceiling_allows_its_hardest_value_and_nothing_looser(one: object) -> None:
    ceiling = next(c for c in CEILINGS if c is one)
    limit, step = ceiling.limit, 1e-6 if ceiling.direction.value == "lower" else -1e-6
    assert not ceiling.looser(limit, limit) and not ceiling.looser(limit - step, limit)
    assert ceiling.looser(limit + step, limit) and ceiling.looser(float("nan"), limit)
    assert ceiling.because


def test_a_refusal_names_value_hardest_value_reason_and_what_to_do() -> None:
    said = refused("sim", "limits.slip_power=500 W")
    assert "limits.slip_power: 500 W is looser than 400 W" in said
    assert "rated torque" in said and "--accept-risk REASON" in said


def test_a_value_of_the_file_is_told_with_its_line(tmp_path: Path) -> None:
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
