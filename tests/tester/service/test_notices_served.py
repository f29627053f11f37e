"""A service started by a screen sends notices by the user's settings; secrets are in their file only."""

from __future__ import annotations

import asyncio
import os
import signal
from pathlib import Path

import pytest

from tester.base.lock import holder_of
from tester.service.client import Client, NoServiceError
from tester.service.commands import RunRecipe
from tester.tui.own_service import LOG, start_service
from tests.tester.kinds.wheel_on_belt.bench import SHORT
from tests.tester.notices.relay import MailRelay
from tests.tester.notices.scene import ANNA

pytestmark = [
    pytest.mark.skipif(os.name != "posix", reason="signals are POSIX's"),
    pytest.mark.usefixtures("noon"),
]
SECRETS = {"mail_password": "pw-7f3c1e", "ntfy_token": "tk-90ab12", "apprise": "json://u:ap-55d0@127.0.0.1:1/"}
PIECES = ("pw-7f3c1e", "tk-90ab12", "ap-55d0", "env-31d9")
"""Strings that must appear nowhere."""


async def connected() -> Client:
    for _ in range(2000):
        try:
            return await Client.connect(None, control=True)
        except NoServiceError:
            await asyncio.sleep(0.02)
    raise AssertionError("the service does not come up")


def test_a_run_of_a_service_that_a_screen_started(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runtime, settings, runs = tmp_path / "runtime", tmp_path / "settings", tmp_path / "runs"
    runtime.mkdir(mode=0o700)
    settings.mkdir()
    monkeypatch.setenv("TESTER_RUNTIME_DIR", str(runtime))
    monkeypatch.setenv("TESTER_CONFIG_DIR", str(settings))
    monkeypatch.setenv("TESTER_NTFY_TOKEN", "env-31d9")
    events = tmp_path / "events"
    secrets = settings / "notices-secrets.yaml"
    secrets.write_text("".join(f'{key}: "{value}"\n' for key, value in SECRETS.items()))
    secrets.chmod(0o600)
    with MailRelay("rig", SECRETS["mail_password"]) as relay:
        (settings / "notices.yaml").write_text(
            f"mail: {{relay: 127.0.0.1, port: {relay.port}, security: none, user: rig, from: rig@lab.example, "
            f"to: [{ANNA}]}}\nntfy: {{server: 'http://127.0.0.1:1', topic: rig}}\n"
            f"command: {{run: \"sh -c 'echo $TESTER_EVENT >> {events}'\"}}\n"
        )
        start_service("sim", runs)

        async def story() -> None:
            async with await connected() as client:
                await client.command(RunRecipe("short", text=SHORT, speed=None, yes=True, notes="a note"))
                await client.stop()
                await asyncio.to_thread(relay.wait_for, 1, 100.0)

        try:
            asyncio.run(story())
        finally:
            holder = holder_of(runtime / "service.lock")
            assert holder is not None
            os.kill(holder.pid, signal.SIGTERM)
        message = relay.taken[0].message
    assert "finished" in message["Subject"] and "simulated" in message["Subject"]
    assert "stopped" in message.get_content()
    assert events.read_text().split()[0] == "finished"
    assert (runs / ".notices" / "outbox").stat().st_mode & 0o777 == 0o600
    looked = [path for folder in (runs, runtime) for path in folder.rglob("*") if path.is_file()]
    assert {"run.db", "outbox", LOG} <= {path.name for path in looked}
    for path in looked:
        content = path.read_bytes()
        assert not [piece for piece in PIECES if piece.encode() in content], path
    assert not [piece for piece in PIECES if piece in message.as_string()]
