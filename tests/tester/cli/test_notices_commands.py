"""`tester notices check`, `test`, `list`."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest

from tester.cli.main import invoke
from tester.notices.channels.letter import NotDeliveredError
from tester.notices.notice_settings import NoticeSettings
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA, HEAD, OutboxScene, PlayedChannel, mail_settings, notice

MAIL = "mail: {{relay: 127.0.0.1, port: {port}, security: none, from: rig@lab.example, to: [" + ANNA + "]{more}}}\n"
Capture = pytest.CaptureFixture[str]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TESTER_CONFIG_DIR", str(tmp_path))
    return tmp_path


def write(folder: Path, port: int = 1, more: str = "", further: str = "") -> None:
    (folder / "notices.yaml").write_text(MAIL.format(port=port, more=more) + further)


def test_check_prints_the_recipients_of_each_notice(folder: Path, capsys: Capture) -> None:
    write(folder, more=f", second: [{HEAD}], causes: [trip, prompt]")
    assert invoke(["notices", "check"]) == 0
    lines = {line.split()[0]: line for line in capsys.readouterr().out.splitlines()}
    assert lines["trip"].endswith(f": {ANNA}") and lines["disk"].endswith(": nowhere")
    assert f"at 07:00: {ANNA}" in lines["morning"] and lines["second"].endswith(f": {HEAD}")


def test_check_as_json(folder: Path, capsys: Capture) -> None:
    write(folder)
    assert invoke(["notices", "check", "--json"]) == 0
    read = json.loads(capsys.readouterr().out)
    assert read["channels"] == ["mail"] and read["causes"]["trip"] == [ANNA] and read["missing"] == []


def test_check_lists_every_mistake_with_its_place(folder: Path, capsys: Capture) -> None:
    write(folder, port=0, further="nfty: {}\n")
    assert invoke(["notices", "check"]) == 3
    err = capsys.readouterr().err
    assert "notices.yaml:1:" in err and "port: " in err and 'unknown key "nfty", did you mean ntfy?' in err


@pytest.mark.skipif(os.name != "posix", reason="modes are POSIX's")
def test_check_refuses_secrets_that_others_may_read(folder: Path, capsys: Capture) -> None:
    write(folder)
    secrets = folder / "notices-secrets.yaml"
    secrets.write_text("mail_password: abcdefgh\n")
    secrets.chmod(0o644)
    assert invoke(["notices", "check"]) == 3
    err = capsys.readouterr().err
    assert "mode 0644" in err and "chmod 600" in err and "abcdefgh" not in err


def test_check_names_a_secret_that_is_missing(folder: Path, capsys: Capture) -> None:
    write(folder, more=", user: rig", further="apprise: {}\n")
    assert invoke(["notices", "check"]) == 1
    err = capsys.readouterr().err
    assert "mail_password is missing" in err and "TESTER_APPRISE" in err


def test_check_shows_no_secret(folder: Path, capsys: Capture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TESTER_MAIL_PASSWORD", "pw-7f3c1e")
    write(folder, more=", user: rig")
    assert invoke(["notices", "check"]) == 0
    assert "pw-7f3c1e" not in "".join(capsys.readouterr())


def test_test_sends_to_every_address_also_the_second_ones(folder: Path, capsys: Capture) -> None:
    with MailRelay() as relay:
        write(folder, relay.port, f", second: [{HEAD}]")
        assert invoke(["notices", "test"]) == 0
    assert [mail.to for mail in relay.taken] == [[ANNA], [HEAD]]
    assert "a test" in relay.taken[0].message["Subject"]
    assert capsys.readouterr().out.count("sent ") == 2


def test_test_fails_where_one_address_fails_and_still_sends_to_the_others(folder: Path, capsys: Capture) -> None:
    with MailRelay(refuses={ANNA: 550}) as relay:
        write(folder, relay.port, f", second: [{HEAD}]")
        assert invoke(["notices", "test"]) == 1
    assert [mail.to for mail in relay.taken] == [[HEAD]]
    assert f"FAILED  mail  {ANNA}: the relay answers 550" in capsys.readouterr().out


def test_test_without_a_channel_fails(folder: Path, capsys: Capture) -> None:
    assert invoke(["notices", "test"]) == 1
    assert "no channel" in capsys.readouterr().err


def scene_of(folder: Path, settings: NoticeSettings, channel: PlayedChannel) -> OutboxScene:
    (folder / "runs" / ".notices").mkdir(parents=True)
    return OutboxScene(folder / "runs" / ".notices", settings, channel=channel)


def test_list_shows_age_address_attempts_and_reason(folder: Path, capsys: Capture) -> None:
    write(folder)
    channel = PlayedChannel(lambda: NotDeliveredError("no program listens there"))
    scene_of(folder, mail_settings(1), channel).take(notice(1))
    assert invoke(["notices", "list", "--out", str(folder / "runs")]) == 0
    (line,) = capsys.readouterr().out.splitlines()
    for part in ("waits  ", " h ", f"mail {ANNA}", "[rig 2] trip: text 1", "1 attempt: no program listens there"):
        assert part in line


def test_list_shows_abandoned_notices(folder: Path, capsys: Capture) -> None:
    write(folder)
    scene = scene_of(folder, mail_settings(1), PlayedChannel(lambda: NotDeliveredError("550 no", final=True)))
    scene.take(notice(1))
    scene.pass_time(3600.0)
    assert invoke(["notices", "list", "--out", str(folder / "runs"), "--json"]) == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["state"], row["why"], row["to"]) == ("given up", "550 no", ANNA)


def test_list_of_nothing(folder: Path, capsys: Capture) -> None:
    assert invoke(["notices", "list", "--out", str(folder)]) == 0
    assert capsys.readouterr() == ("", "no notice waits\n")
