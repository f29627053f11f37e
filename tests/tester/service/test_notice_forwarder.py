"""The real process that sends notices: started on demand, restarted if it dies; nothing is lost."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path
from threading import Event

import pytest

from tester.notices.notice import NOTE, NextNeeded, NoticeCause, NoticeOver, SenderSettings
from tester.notices.outbox_file import outbox_path, read_entries
from tester.service.notice_forwarder import NoticeForwarder, started
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA, notice

pytestmark = pytest.mark.usefixtures("noon")
posix = pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's")


@pytest.fixture
def relay() -> Iterator[MailRelay]:
    with MailRelay() as made:
        yield made


@pytest.fixture
def settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, relay: MailRelay) -> Path:
    path = tmp_path / "settings" / "notices.yaml"
    path.parent.mkdir()
    monkeypatch.setenv("TESTER_CONFIG_DIR", str(path.parent))
    path.write_text(
        f"mail: {{relay: 127.0.0.1, port: {relay.port}, security: none, from: rig@lab.example, to: [{ANNA}]}}\n"
    )
    return path


class Watched:
    """Starts senders and remembers them."""

    def __init__(self) -> None:
        self.processes: list[subprocess.Popen[bytes]] = []

    def __call__(self) -> subprocess.Popen[bytes]:
        self.processes.append(started())
        return self.processes[-1]


@pytest.fixture
def watched(monkeypatch: pytest.MonkeyPatch) -> Watched:
    monkeypatch.setattr("tester.service.notice_forwarder.AGAIN_S", (0.0,))
    return Watched()


@pytest.fixture
def forwarder(tmp_path: Path, watched: Watched) -> Iterator[NoticeForwarder]:
    made = NoticeForwarder(SenderSettings("s1", str(tmp_path / "runs"), "sim"), watched)
    yield made
    for process in watched.processes:
        process.kill()
        process.wait()


def subjects(relay: MailRelay) -> list[str]:
    return [mail.message["Subject"].split()[-1] for mail in relay.taken]


def test_notes_become_mails_and_the_sender_ends_with_its_input(
    settings: Path, relay: MailRelay, forwarder: NoticeForwarder, watched: Watched
) -> None:
    forwarder.open()
    for number in range(3):
        forwarder.take(NOTE.dump_json(notice(number)))
    forwarder.take(NOTE.dump_json(NextNeeded("run x")))
    forwarder.close()
    assert watched.processes[0].wait(30.0) == 0
    assert subjects(relay) == ["0", "1", "2"]


@posix
def test_a_sender_that_is_killed_is_started_again_and_neither_loses_nor_doubles(
    settings: Path, relay: MailRelay, forwarder: NoticeForwarder, watched: Watched
) -> None:
    forwarder.open()
    for number in range(6):
        forwarder.take(NOTE.dump_json(notice(number)))
        if number % 2:
            relay.wait_for(number + 1)
            watched.processes[-1].send_signal(signal.SIGKILL)
            watched.processes[-1].wait()
    forwarder.take(NOTE.dump_json(NoticeOver("s1-9", "prompt")))
    forwarder.close()
    assert watched.processes[-1].wait(30.0) == 0
    assert len(watched.processes) > 2
    idents = [mail.ident for mail in relay.taken]
    assert list(dict.fromkeys(subjects(relay))) == [str(number) for number in range(6)]
    assert len(set(idents)) == 6  # duplicates have one Message-ID


def test_pending_notices_are_sent_by_the_next_service(
    tmp_path: Path, settings: Path, relay: MailRelay, forwarder: NoticeForwarder, watched: Watched
) -> None:
    relay.down = True
    forwarder.open()
    forwarder.take(NOTE.dump_json(notice(1)))
    forwarder.close()
    assert watched.processes[0].wait(30.0) == 0
    assert relay.taken == []
    relay.down = False
    later = NoticeForwarder(SenderSettings("s2", forwarder.settings.runs, "sim"), watched)
    later.open()
    relay.wait_for(1)
    later.close()
    assert watched.processes[-1].wait(30.0) == 0
    assert subjects(relay) == ["1"]


def test_without_settings_and_command_no_process_is_started(forwarder: NoticeForwarder, watched: Watched) -> None:
    forwarder.open()
    forwarder.take(NOTE.dump_json(notice(1)))
    forwarder.close()
    assert watched.processes == []


def test_the_command_of_the_service_gets_its_notices_without_any_settings(tmp_path: Path, watched: Watched) -> None:
    out = tmp_path / "events"
    hook = f"sh -c 'echo \"$TESTER_EVENT\" >> {out}'"
    forwarder = NoticeForwarder(SenderSettings("s1", str(tmp_path / "runs"), "sim", hook), watched)
    forwarder.open()
    forwarder.take(NOTE.dump_json(notice(1)))
    forwarder.take(NOTE.dump_json(notice(2, NoticeCause.DISK)))
    forwarder.close()
    assert watched.processes[0].wait(30.0) == 0
    assert out.read_text().split() == ["trip", "disk"]


def test_wrong_settings_end_the_sender_with_the_place_and_nothing_is_taken(
    settings: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], forwarder: NoticeForwarder, watched: Watched
) -> None:
    settings.write_text("mail: {relay: 1}\n")
    forwarder.open()
    forwarder.take(NOTE.dump_json(notice(1)))
    forwarder.close()
    assert watched.processes[0].wait(30.0) == 1
    assert "notices.yaml:1:15: relay: " in capfd.readouterr().err
    assert read_entries(outbox_path(tmp_path / "runs")) == []


def test_settings_that_are_mended_while_the_sender_runs_count(
    settings: Path, relay: MailRelay, forwarder: NoticeForwarder, watched: Watched
) -> None:
    whole = settings.read_text()
    settings.write_text(whole.replace(str(relay.port), "1"))  # no program listens there
    forwarder.open()
    forwarder.take(NOTE.dump_json(notice(1)))
    settings.write_text(whole)
    for number in range(2, 40):  # each message makes the sender check its settings
        forwarder.take(NOTE.dump_json(notice(number)))
    relay.wait_for(1)
    forwarder.close()
    assert watched.processes[-1].wait(30.0) == 0
    assert subjects(relay)[0] == "1"


@posix
def test_a_relay_that_does_not_answer_delays_no_other_channel(
    settings: Path, tmp_path: Path, relay: MailRelay, forwarder: NoticeForwarder, watched: Watched
) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    settings.write_text(f"{settings.read_text()}command: {{run: \"sh -c 'echo $TESTER_EVENT > {pipe}'\"}}\n")
    relay.hangs = Event()
    forwarder.open()
    forwarder.take(NOTE.dump_json(notice(1)))
    assert pipe.read_text() == "trip\n"  # waits for the command
    assert relay.taken == []
    relay.hangs.set()
    relay.wait_for(1)
    forwarder.close()
    assert watched.processes[0].wait(30.0) == 0
