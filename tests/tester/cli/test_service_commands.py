"""`tester status`, `hold`, `release`, `ack`, `stop`, `run --detach` against a service played by a test."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Event, Thread

import pytest

from tester.cli.main import invoke
from tester.cli.run_command import NOT_DETACHED, run
from tester.service.address import HAS_UNIX, Address
from tester.service.client import Client
from tester.service.commands import RunRecipe, Stop
from tests.tester.service.fake import FakeService
from tests.tester.service.views import state

pytestmark = [pytest.mark.skipif(not HAS_UNIX, reason="Unix sockets"), pytest.mark.usefixtures("folder")]


def test_status_reports_that_nothing_runs(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["status"]) == 4
    out, err = capsys.readouterr()
    assert (out, err) == ("", "no service is running: start one with `tester serve`\n")


def test_status_also_reports_it_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["status", "--json"]) == 4
    assert json.loads(capsys.readouterr().out)["service"] is False


@pytest.mark.parametrize("command", ["hold", "release", "ack", "stop"])
def test_a_command_without_a_service_is_unreachable(command: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke([command]) == 4
    assert "tester serve" in capsys.readouterr().err


def test_status_shows_mode_run_step_and_values_without_control_characters(
    fake: FakeService, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["status"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("RUN\n") and "step     21/60" in out and "Load 199.6 N" in out
    assert "\x1b" not in out and "\x00" not in out


def test_status_as_json_is_the_whole_state(fake: FakeService, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["status", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["progress"]["over"] == 17


def test_stop_is_given_fast_where_that_is_asked(fake: FakeService) -> None:
    assert invoke(["stop", "--fast"]) == 0
    assert fake.orders[-1].action == Stop(fast=True)
    assert fake.presence.controller == ""


def test_a_refusal_is_reported_with_exit_code_1(fake: FakeService, capsys: pytest.CaptureFixture[str]) -> None:
    fake.refusals["hold"] = "nothing runs"
    assert invoke(["hold"]) == 1
    assert "refused: nothing runs" in capsys.readouterr().err


def test_run_detached_prints_the_folder_and_names_the_recipes_file_in_full(
    fake: FakeService, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "mine.yaml").write_text("recipe: mine\n")
    monkeypatch.chdir(tmp_path)
    fake.results["run"] = {"run": "r", "folder": "runs/r"}
    assert invoke(["run", "mine.yaml", "--detach", "--seed", "7", "--yes"]) == 0
    assert capsys.readouterr().out == "runs/r\n"
    expected = RunRecipe(str((tmp_path / "mine.yaml").resolve()), seed=7, speed=None, yes=True)
    assert fake.orders[-1].action == expected


def test_run_detached_leaves_the_folder_to_the_service(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "quickstart", "--detach", "--out", "here"]) == 2
    assert "not with --detach" in capsys.readouterr().err


CARRIED = {"recipe", "rig_name", "overrides", "yes", "seed", "speed", "operator", "detach", "take"}
"""Parameters of `tester run` that reach the service."""
LEFT = [["--bus-log", "logs"], ["--fault", "t=1 s: belt jammed"], ["--jobs", "2"], ["--jobs", "1"], ["--json"]]


@pytest.mark.parametrize("option", LEFT, ids=" ".join)
def test_run_detached_refuses_options_that_the_service_lacks(
    option: list[str], fake: FakeService, capsys: pytest.CaptureFixture[str]
) -> None:
    assert invoke(["run", "quickstart", "--detach", *option]) == 2
    assert f"the service would not do it: {option[0]}" in capsys.readouterr().err
    assert not fake.orders


def test_every_parameter_of_run_reaches_the_service_or_is_refused() -> None:
    assert {parameter.name for parameter in run.params} == CARRIED | set(NOT_DETACHED)


@contextmanager
def controlled(address: Address) -> Iterator[None]:
    """Put another client in control, in its own thread."""
    up, end = Event(), Event()

    async def live() -> None:
        async with await Client.connect(address, name="another screen", control=True):
            up.set()
            while not end.is_set():
                await asyncio.sleep(0.01)

    thread = Thread(target=lambda: asyncio.run(live()))
    thread.start()
    assert up.wait(20)
    try:
        yield
    finally:
        end.set()
        thread.join(20)


COMMANDS = (["hold"], ["release"], ["ack"], ["run", "quickstart", "--detach"])


@pytest.mark.parametrize("command", COMMANDS)
def test_a_refusal_for_want_of_control_explains_how_to_take_it(
    fake: FakeService, command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    fake.results["run"] = {"run": "r", "folder": "runs/r"}
    with controlled(fake.address):
        assert invoke(command) == 1
        assert capsys.readouterr().err == "refused: another screen has control: `--take` takes control\n"
        assert invoke([*command, "--take"]) == 0


@pytest.mark.parametrize("command", COMMANDS)
def test_a_screen_before_an_idle_rig_blocks_no_command(fake: FakeService, command: list[str]) -> None:
    fake.results["run"] = {"run": "r", "folder": "runs/r"}
    fake.show(state("OFFLINE"))
    with controlled(fake.address):
        assert invoke(command) == 0


def test_a_run_in_the_foreground_takes_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["run", "quickstart", "--take"]) == 2
    assert "goes with --detach" in capsys.readouterr().err
