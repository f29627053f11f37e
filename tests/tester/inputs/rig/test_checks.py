"""Lines with settings other than their devices' profiles: a warning, with a remedy."""

from __future__ import annotations

from datetime import date
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.inputs.rig.checks import other_settings
from tester.kinds import hardware_text, load_rig
from tester.run.preconditions import warnings_before

E5CC = ("devices.jacket.profile=omron_e5cc", "devices.jacket.heat_off=relay")
SAID = (
    "lines.heat has 38400 baud, parity N; jacket by its profile omron_e5cc 38400 baud, parity E: set one as the other"
    " (`tester doctor` finds what answers)"
)


@pytest.mark.parametrize("name", ["sim", "grosch", "pin-on-disc"])
def test_the_packaged_rigs_are_set_as_their_devices_are(name: str) -> None:
    assert other_settings(load_rig(name)) == []


def test_a_device_of_another_parity_is_named_with_its_line() -> None:
    assert other_settings(load_rig(overrides=E5CC)) == [SAID]
    both = other_settings(load_rig(overrides=(*E5CC, "lines.heat.baud=9600")))
    assert [text.split(";")[1].split()[0] for text in both] == ["jacket", "ir_thermometer"]
    assert all("lines.heat has 9600 baud, parity N" in text for text in both)


def test_a_line_over_tcp_has_no_settings_of_its_own() -> None:
    assert other_settings(load_rig(overrides=(*E5CC, "lines.heat.framing=socket"))) == []


@pytest.mark.parametrize("command", [("check", "quickstart"), ("rig", "show")])
def test_the_commands_report_it(command: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    sets = [part for one in E5CC for part in ("--set", one)]
    assert invoke([*command, *sets]) == 0
    assert f"sim: warning: {SAID}\n" in capsys.readouterr().err
    assert invoke(list(command)) == 0
    assert "warning" not in capsys.readouterr().err


def test_a_start_of_a_real_rig_reports_it_and_is_not_refused(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(hardware_text(), encoding="utf-8")
    rig = load_rig(str(path), ("lines.heat.baud=9600",))
    told = warnings_before(rig, date(2026, 1, 1))
    assert [text.split(" has ")[0] for text in told] == ["warning: lines.heat"] * 2
    assert warnings_before(load_rig(overrides=E5CC), date(2026, 1, 1)) == []


def test_stop_bits_are_also_settings() -> None:
    assert any("heat has 38400 baud, parity N, 2 stop bits; jacket" in text
               for text in other_settings(load_rig(overrides=("lines.heat.stop_bits=2",))))  # fmt: skip
    assert load_rig(overrides=("lines.heat.rts=high",)).lines["heat"].rts == "high"
