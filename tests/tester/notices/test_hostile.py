"""Hostile names, notes and reasons never become a header, an address or an SMTP command."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from email.message import EmailMessage
from pathlib import Path

from pydantic_core import to_json

from tester.base.words import FORBIDDEN
from tester.notices.channels.letter import letter_of
from tester.notices.channels.mail_channel import message_of
from tester.notices.mailing import Waiting
from tester.notices.notice import NOTE, Notice, NoticeCause
from tester.notices.outbox_file import read_entries
from tests.tester.notices.hostile import hostile_texts
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA, NOON_S, NOTICE, OutboxScene, mail_settings

HEADERS = ["From", "To", "Subject", "Date", "Message-ID", "Auto-Submitted", "Content-Type",
           "Content-Transfer-Encoding", "MIME-Version"]  # fmt: skip


def everywhere(text: str, number: int) -> Notice:
    """Return a notice with a text in every field that a person, a recipe or a device fills."""
    return replace(NOTICE, number=f"s1-{number}", key=text, what=text, since_utc=text, itself=text, todo=text, by=text,
                   rig=text, run=text, folder=text)  # fmt: skip


def check(message: EmailMessage, raw: bytes) -> None:
    assert sorted(message.keys()) == sorted(HEADERS)
    assert message["To"] == ANNA and len(message["To"].addresses) == 1
    assert [address.addr_spec for address in message["From"].addresses] == ["rig@lab.example"]
    assert not FORBIDDEN.search(str(message["Subject"])) and not FORBIDDEN.search(
        message.get_content().replace("\r\n", "\n")
    )
    assert all(len(line) <= 998 for line in raw.split(b"\r\n"))
    assert not re.search(rb"(?<!\r)\n|\r(?!\n)", raw)
    lines = message.get_content().splitlines()
    assert all(re.match(r"(What|Since|The machine|To do|By when|Rig|Run): ", line) for line in lines), lines


def test_200_hostile_texts_in_every_field_make_no_header_and_no_second_address_on_the_relay(tmp_path: Path) -> None:
    with MailRelay() as relay:
        scene = OutboxScene(tmp_path, mail_settings(relay.port))
        for number, text in enumerate(hostile_texts()):
            scene.take(everywhere(replace_lone(text), number))
            scene.now_s += 700.0
        assert len(relay.taken) == 200
    for taken in relay.taken:
        assert taken.to == [ANNA] and taken.sender == "rig@lab.example"
        check(taken.message, taken.raw)


def replace_lone(text: str) -> str:
    """Return a text without lone surrogates, which no JSON carries; ``test_..._surrogates`` has them."""
    return text.encode("utf-8", "replace").decode()


def test_lone_surrogates_and_every_control_character_make_no_header_either() -> None:
    for text in (*hostile_texts(), *(f"a{chr(code)}Bcc: m@e" for code in (*range(0x20), *range(0x7F, 0xA1), 0x2028))):
        letter = letter_of(Waiting("s1-1.0", "mail:x", everywhere(text, 1), 1, 3, NOON_S))
        message = message_of(letter, "rig@lab.example", ANNA)
        assert sorted(message.keys()) == sorted(HEADERS)
        header = message.as_bytes().partition(b"\r\n\r\n")[0]
        assert b"\r\nBcc" not in header and header.count(b"\r\nTo:") == 1


def test_hostile_message_names_make_no_header() -> None:
    for text in hostile_texts():
        letter = letter_of(Waiting(f"{text}.0", text, NOTICE, 0, 0, NOON_S))
        assert re.fullmatch(r"[A-Za-z0-9.-]+", letter.name)


def test_a_hostile_text_is_one_line_of_the_outbox_and_comes_back_unchanged(tmp_path: Path) -> None:
    scene = OutboxScene(tmp_path, mail_settings(1), channel=None)
    texts = [replace_lone(text) for text in hostile_texts()]
    for number, text in enumerate(texts):
        scene.dispatch.take(NOTE.validate_json(to_json(everywhere(text, number))), NOON_S)
    notes = [entry["n"] for entry in read_entries(tmp_path / "outbox") if "n" in entry]
    assert [note["what"] for note in notes] == texts  # type: ignore[index,call-overload]


def test_a_subject_begins_with_the_cause_whatever_the_text() -> None:
    for cause in NoticeCause:
        letter = letter_of(Waiting("s1-1.0", "mail:x", replace(NOTICE, cause=cause, what="\r\nx"), 0, 0, NOON_S))
        assert letter.subject == f"[rig 2] {cause.value}: ? x" or letter.subject.startswith(f"[rig 2] {cause.value}:")


def test_json_for_ntfy_holds_a_hostile_text_as_one_string() -> None:
    for text in hostile_texts():
        letter = letter_of(Waiting("s1-1.0", "ntfy:x", everywhere(text, 1), 0, 0, NOON_S))
        assert json.loads(to_json({"title": letter.subject}))["title"] == letter.subject
