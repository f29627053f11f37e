"""Each channel against a real server, over loopback."""

from __future__ import annotations

import json
import shlex
import ssl
import subprocess
import sys
from collections.abc import Generator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from shutil import which
from threading import Thread

import pytest

from tester.notices.channels.apprise_channel import AppriseChannel
from tester.notices.channels.command_channel import CommandChannel
from tester.notices.channels.letter import Letter, NotDeliveredError, letter_of
from tester.notices.channels.mail_channel import MailChannel
from tester.notices.channels.ntfy_channel import NtfyChannel
from tester.notices.mailing import Waiting
from tester.notices.notice_settings import CommandSection, NtfySection
from tester.notices.secrets_file import NoticeSecrets
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA, NOON_S, NOTICE, mail_settings

PASSWORD = "correct horse battery"
LETTER = letter_of(Waiting("s1-1.0", "mail:x", NOTICE, 0, 0, NOON_S))


def mail(relay: MailRelay, password: str = "", **fields: object) -> MailChannel:
    section = mail_settings(relay.port, **fields).mail
    assert section is not None
    return MailChannel(section, NoticeSecrets(mail_password=password))


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A certificate of 127.0.0.1 with its key, in one file."""
    openssl = which("openssl")
    if openssl is None:
        pytest.skip("openssl is missing: it makes the relay's certificate")
    folder = tmp_path_factory.mktemp("tls")
    subprocess.run(
        [openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2",
         "-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", "key.pem", "-out", "cert.pem"],
        cwd=folder, check=True, capture_output=True,
    )  # fmt: skip
    whole = folder / "whole.pem"
    whole.write_text((folder / "key.pem").read_text() + (folder / "cert.pem").read_text())
    return whole


def tls_of(certificate: Path) -> ssl.SSLContext:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate)
    return context


def test_a_mail_has_everything_a_person_needs() -> None:
    with MailRelay() as relay:
        mail(relay).send(LETTER, ANNA)
    message = relay.taken[0].message
    assert message["Subject"] == "[rig 2] trip: overload: 900 N above 800 N"
    assert message["To"] == ANNA and message["Date"] == "Tue, 03 Mar 2026 12:00:00 +0000"
    text = message.get_content().replace("\r\n", "\n")
    for line in ("What: overload: 900 N above 800 N", "The machine: it is at rest", "To do: look, then acknowledge",
                 "By when: no deadline", "Run: run-1"):  # fmt: skip
        assert f"{line}\n" in text
    assert "Since: 2026-03-03" in text


@pytest.mark.parametrize("starttls", [True, False])
def test_a_password_goes_only_through_tls(certificate: Path, starttls: bool) -> None:
    with MailRelay("rig", PASSWORD, tls_of(certificate), starttls=starttls) as relay:
        security = "starttls" if starttls else "tls"
        mail(relay, PASSWORD, user="rig", security=security, ca=str(certificate)).send(LETTER, ANNA)
    assert [one.security for one in relay.taken] == [security]


def test_a_relay_whose_certificate_is_not_trusted_gets_nothing(certificate: Path) -> None:
    untrusted = pytest.raises(NotDeliveredError, match="certificate")
    with MailRelay("rig", PASSWORD, tls_of(certificate), starttls=True) as relay, untrusted as caught:
        mail(relay, PASSWORD, user="rig", security="starttls").send(LETTER, ANNA)
    assert relay.taken == [] and not caught.value.final


def test_a_relay_that_offers_no_starttls_gets_nothing() -> None:
    with MailRelay() as relay, pytest.raises(NotDeliveredError, match="STARTTLS"):
        mail(relay, security="starttls").send(LETTER, ANNA)
    assert relay.taken == []


def test_a_wrong_password_is_an_error_that_can_be_mended() -> None:
    with MailRelay("rig", PASSWORD) as relay, pytest.raises(NotDeliveredError, match="535") as caught:
        mail(relay, "wrong", user="rig").send(LETTER, ANNA)
    assert not caught.value.final


@pytest.mark.parametrize(("code", "final"), [(451, False), (550, True)])
def test_a_recipient_that_is_refused(code: int, final: bool) -> None:
    with MailRelay(refuses={ANNA: code}) as relay, pytest.raises(NotDeliveredError, match=str(code)) as caught:
        mail(relay).send(LETTER, ANNA)
    assert caught.value.final is final


def test_a_missing_relay_is_reported_in_words() -> None:
    with MailRelay() as relay:
        gone = mail(relay)
    with pytest.raises(NotDeliveredError, match="no program listens there"):
        gone.send(LETTER, ANNA)


# -- ntfy -----------------------------------------------------------------------------------------------------


class WebServer(ThreadingHTTPServer):
    """Keeps posts, and answers with ``code``."""

    code = 200
    posted: list[tuple[str, dict[str, str], bytes]]

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Posted)
        self.posted = []

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}"


class Posted(BaseHTTPRequestHandler):
    server: WebServer

    def do_POST(self) -> None:
        body = self.rfile.read(int(self.headers["Content-Length"]))
        self.server.posted.append((self.path, dict(self.headers.items()), body))
        self.send_response(self.server.code)
        if self.server.code == 302:
            self.send_header("Location", f"{self.server.url}/elsewhere")
        self.send_header("Content-Length", "0")
        self.end_headers()

    do_GET = do_POST  # noqa: N815

    def log_message(self, *_: object) -> None:
        pass


@contextmanager
def web_server() -> Generator[WebServer]:
    with WebServer() as server:
        Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
        yield server
        server.shutdown()


def ntfy(server: str, token: str = "") -> NtfyChannel:
    return NtfyChannel(NtfySection(server=server, topic="rig-2"), NoticeSecrets(ntfy_token=token))


def test_ntfy_gets_json_at_its_root_and_the_token_in_a_header() -> None:
    with web_server() as server:
        ntfy(server.url, "tk_1").send(LETTER, "rig-2")
    path, headers, body = server.posted[0]
    sent = json.loads(body)
    assert path == "/" and headers["Authorization"] == "Bearer tk_1"
    assert (sent["topic"], sent["title"], sent["priority"]) == ("rig-2", LETTER.subject, 5)
    assert sent["message"] == LETTER.text


def test_ntfy_gets_the_same_sequence_number_in_every_attempt() -> None:
    with web_server() as server:
        for _ in range(2):
            ntfy(server.url).send(LETTER, "rig-2")
    assert len({json.loads(body)["sequence_id"] for _, _, body in server.posted}) == 1


@pytest.mark.parametrize(("code", "final"), [(500, False), (401, False), (429, False), (400, True)])
def test_an_answer_of_ntfy_that_is_no_success(code: int, final: bool) -> None:
    with web_server() as server:
        server.code = code
        with pytest.raises(NotDeliveredError, match=str(code)) as caught:
            ntfy(server.url).send(LETTER, "rig-2")
    assert caught.value.final is final


def test_ntfy_follows_no_redirection_with_its_token() -> None:
    with web_server() as server:
        server.code = 302
        with pytest.raises(NotDeliveredError, match="302"):
            ntfy(server.url, "tk_1").send(LETTER, "rig-2")
    assert len(server.posted) == 1


def test_a_token_crosses_no_network_without_tls() -> None:
    with pytest.raises(NotDeliveredError, match="readably"):
        ntfy("http://192.0.2.1", "tk_1").send(LETTER, "rig-2")


# -- a command, Apprise ---------------------------------------------------------------------------------------


def command(program: str) -> CommandChannel:
    return CommandChannel(CommandSection(run=shlex.join([sys.executable, "-c", program])))


def test_the_command_gets_the_notice_as_json_and_in_its_environment(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TESTER_MAIL_PASSWORD", PASSWORD)
    out = tmp_path / "out.json"
    command(
        "import json, os, sys; "
        f"json.dump([json.load(sys.stdin), dict(os.environ)], open({str(out)!r}, 'w'))"
    ).send(LETTER, "command")
    sent, environment = json.loads(out.read_text())
    assert sent["event"] == "trip" and sent["text"] == NOTICE.what and sent["message"] == LETTER.text
    assert environment["TESTER_EVENT"] == "trip" and environment["TESTER_FOLDER"] == "/runs/run-1"
    assert "TESTER_MAIL_PASSWORD" not in environment


def test_a_command_that_fails_or_is_missing_is_an_error_with_the_reason() -> None:
    with pytest.raises(NotDeliveredError, match="exit code 3 no such door"):
        command("import sys; sys.stderr.write('no such door'); sys.exit(3)").send(LETTER, "command")
    with pytest.raises(NotDeliveredError, match="no-such-program-anywhere"):
        CommandChannel(CommandSection(run="no-such-program-anywhere")).send(LETTER, "command")


def test_a_command_that_hangs_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.notices.channels.command_channel.COMMAND_WITHIN_S", 0.1)
    with pytest.raises(NotDeliveredError, match=r"ended after 0\.1 s"):
        command("import threading; threading.Event().wait()").send(LETTER, "command")


def test_apprise_sends_to_an_address_of_its_own() -> None:
    pytest.importorskip("apprise", reason="the extra notify is not installed")
    with web_server() as server:
        address = f"json://127.0.0.1:{server.server_port}/hook"
        AppriseChannel(NoticeSecrets(apprise=address)).send(LETTER, "apprise")
        sent = json.loads(server.posted[0][2])
        assert sent["title"] == LETTER.subject and "overload" in sent["message"]
        server.code = 500
        with pytest.raises(NotDeliveredError, match="did not take it"):
            AppriseChannel(NoticeSecrets(apprise=address)).send(LETTER, "apprise")


def test_an_address_that_apprise_does_not_know_is_named_by_its_number_only() -> None:
    pytest.importorskip("apprise", reason="the extra notify is not installed")
    with pytest.raises(NotDeliveredError, match="address 1") as caught:
        AppriseChannel(NoticeSecrets(apprise="nonsense://s3cret-token")).send(LETTER, "apprise")
    assert "s3cret" not in str(caught.value)


def test_without_apprise_the_error_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "apprise", None)
    with pytest.raises(NotDeliveredError, match=r"\[notify\]"):
        AppriseChannel(NoticeSecrets(apprise="json://x")).send(LETTER, "apprise")


def test_a_letter_is_the_same_in_every_attempt() -> None:
    waiting = Waiting("s1-1.0", "mail:x", NOTICE, 0, 2, NOON_S)
    first: Letter = letter_of(waiting)
    waiting.tries, waiting.why = 7, "no answer"
    assert letter_of(waiting) == first
