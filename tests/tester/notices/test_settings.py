"""`notices.yaml` and the file with secrets: accepted settings, and the place of each mistake."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tester.base.source import InvalidSource
from tester.base.user_folders import config_folder
from tester.notices.notice import NoticeCause
from tester.notices.notice_settings import lane_of, read_settings
from tester.notices.secrets_file import NoticeSecrets, read_secrets, without_secrets

WHOLE = """
morning: "06:30"
mail:
  relay: mail.lab.example
  user: rig2
  from: rig2@lab.example
  to: [anna@lab.example, ben@lab.example]
  second: [head@lab.example]
ntfy:
  server: https://ntfy.lab.example:8443
  topic: rig-2
  causes: [trip, prompt]
apprise: {}
command:
  run: /home/rig/bin/notify --now
"""
MAIL = "mail:\n  relay: mail.lab\n  from: rig@lab\n  to: [anna@lab]\n"
posix = pytest.mark.skipif(os.name != "posix", reason="modes are POSIX's")


def problems(tmp_path: Path, text: str) -> list[str]:
    path = tmp_path / "notices.yaml"
    path.write_text(text)
    with pytest.raises(InvalidSource) as caught:
        read_settings(path)
    return [f"{one.line}:{one.column}: {one.message}" for one in caught.value.problems]


def secrets_in(tmp_path: Path, text: str, mode: int = 0o600, **environment: str) -> NoticeSecrets:
    path = tmp_path / "notices-secrets.yaml"
    path.write_text(text)
    path.chmod(mode)
    return read_secrets(path, environment)


def test_the_whole_file(tmp_path: Path) -> None:
    path = tmp_path / "notices.yaml"
    path.write_text(WHOLE)
    settings = read_settings(path)
    assert settings.mail is not None and settings.mail.at_port == 587
    assert settings.morning_at.hour == 6
    assert list(settings.channels) == ["mail", "ntfy", "apprise", "command"]


def test_a_channel_gets_the_causes_that_it_names_and_every_morning(tmp_path: Path) -> None:
    path = tmp_path / "notices.yaml"
    path.write_text(WHOLE)
    settings = read_settings(path)
    disk = settings.lanes(NoticeCause.DISK)
    assert lane_of("ntfy", "rig-2") not in disk and lane_of("mail", "anna@lab.example") in disk
    assert lane_of("ntfy", "rig-2") in settings.lanes(NoticeCause.MORNING)


def test_the_second_addresses_are_extra(tmp_path: Path) -> None:
    path = tmp_path / "notices.yaml"
    path.write_text(WHOLE)
    settings = read_settings(path)
    extra = settings.lanes(NoticeCause.PROMPT, second=True).keys() - settings.lanes(NoticeCause.PROMPT).keys()
    assert extra == {lane_of("mail", "head@lab.example")}


def test_without_a_file_the_command_of_the_service_is_the_only_channel(tmp_path: Path) -> None:
    assert list(read_settings(tmp_path / "none.yaml", "notify-me").channels) == ["command"]
    assert list(read_settings(tmp_path / "none.yaml").channels) == []


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (MAIL + "  pasword: x\n", "5:3: unknown key"),
        (MAIL + "  password: hunter2\n", "5:3: a password or token goes into notices-secrets.yaml"),
        (MAIL.replace("mail.lab", "mail lab"), "2:10: relay: 'mail lab' is not accepted (expected a host's name"),
        (MAIL.replace("anna@lab", '"anna@lab, ben@lab"'), "4:8: to: 'anna@lab, ben@lab' is not accepted (expected one"),
        (MAIL.replace("[anna@lab]", "[]"), "4:7: to:"),
        (MAIL + "  port: 70000\n", "5:9: port:"),
        (MAIL + "  security: ssl\n", "5:13: security: \"ssl\" is not accepted (expected 'tls', 'starttls' or 'none')"),
        (MAIL + "  user: rig\n  security: none\n", "2:3: mail: a password would cross the network readably"),
        ("mail:\n  relay: mail.lab\n  to: [a@lab]\n", "1:1: from is missing (expected the rig's address)"),
        ("morning: 25:00\n", "1:10: morning: '25:00' is not accepted (expected a local time in quotes"),
        ("ntfy: {server: 'https://x:tk_9@lab', topic: t}\n", "1:16: server: an address with a password is not"),
        ("ntfy: {server: 'ftp://lab', topic: t}\n", "1:16: server: 'ftp://lab' is not accepted"),
        ("ntfy: {server: 'https://lab', topic: 'a/b'}\n", "1:38: topic: not accepted (expected a topic"),
        ("command: {run: \"a\\u202eb\"}\n", "1:16: the character U+202E is not accepted"),
    ],
)  # fmt: skip
def test_a_mistake_has_its_place_and_the_expected_form(tmp_path: Path, text: str, expected: str) -> None:
    found = problems(tmp_path, text)
    assert found[0].startswith(expected), found
    assert "hunter2" not in found[0] and "tk_9" not in found[0]


def test_every_mistake_is_listed_at_once(tmp_path: Path) -> None:
    assert len(problems(tmp_path, "morning: 7\nmail: {relay: 'a b', from: x, to: [y]}\n")) == 4


# -- secrets --------------------------------------------------------------------------------------------------


def test_secrets_come_from_the_file_and_first_of_all_from_the_environment(tmp_path: Path) -> None:
    read = secrets_in(tmp_path, "mail_password: 'a b'\nntfy_token: tk_1\n", TESTER_NTFY_TOKEN="tk_2")
    assert (read.mail_password, read.ntfy_token) == ("a b", "tk_2")


@posix
@pytest.mark.parametrize("mode", [0o640, 0o604, 0o644, 0o660, 0o700, 0o777])
def test_a_file_that_is_open_to_others_is_refused_with_the_remedy(tmp_path: Path, mode: int) -> None:
    with pytest.raises(InvalidSource, match="chmod 600"):
        secrets_in(tmp_path, "mail_password: a\n", mode)


@posix
@pytest.mark.parametrize("mode", [0o600, 0o400])
def test_a_file_of_its_owner_alone_is_read(tmp_path: Path, mode: int) -> None:
    assert secrets_in(tmp_path, "mail_password: a\n", mode).mail_password == "a"


@pytest.mark.parametrize(
    "text",
    ["mail_password: 12345678\n", "mail_pasword: s3cret-word\n", "mail_password: 's3cret-word\n", "s3cret-word\n",
     "mail_password: s3cret-word: x\n", "- s3cret-word\n", "mail_password: \"s3cret-word\\nx\"\n", "@s3cret-word\n"],
)  # fmt: skip
def test_no_message_about_the_file_repeats_a_value(tmp_path: Path, text: str) -> None:
    with pytest.raises(InvalidSource) as caught:
        secrets_in(tmp_path, text)
    assert "s3cret" not in str(caught.value) and "12345678" not in str(caught.value)
    assert caught.value.__cause__ is None


def test_secrets_are_not_shown_and_are_taken_out_of_a_servers_words() -> None:
    secrets = NoticeSecrets("pass-word", "tk_12345", "json://u:pw@h/ tgram://bot/tk")
    assert "pass-word" not in repr(secrets) and "tk_12345" not in repr(secrets) and "bot" not in repr(secrets)
    assert secrets.hidden("535 not with pass-word or tk_12345 or tgram://bot/tk") == (
        "535 not with (secret) or (secret) or (secret)"
    )


def test_a_command_gets_an_environment_without_them() -> None:
    assert without_secrets({"TESTER_MAIL_PASSWORD": "x", "PATH": "/bin"}) == {"PATH": "/bin"}


def test_the_folder_of_settings_can_be_chosen(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("TESTER_CONFIG_DIR", str(tmp_path))
    assert config_folder() == tmp_path
    monkeypatch.delenv("TESTER_CONFIG_DIR")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "x"))
    assert config_folder() == tmp_path / "x" / "friction-tester"
