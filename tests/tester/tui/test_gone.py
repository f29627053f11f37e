"""A service that is gone: died or ended, its devices' reaction, the remedy."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from tester.tui.screen_scene import ScreenScene
from tests.tester.service.views import state as a_state
from tests.tester.tui.stage import Stage, play

ALONE = "Each drive makes a quick stop by itself (wheel: 200 ms)."


async def lose(on: Stage, *, ended: bool) -> None:
    """Kill the service, or end it in order."""
    await on.show(replace(a_state(), alone=ALONE))
    if ended:
        on.fake.gateway.take(b"b")
    on.fake.gateway.farewell()
    await on.fake.gateway.guests.sent()
    await on.fake.__aexit__(None, None, None)
    await on.until(lambda: bool(on.app.scene.gone), "the loss is known")
    await on.pilot.pause()


def test_a_dead_service_is_reported_with_the_reaction_of_the_devices_and_a_remedy(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await lose(on, ended=False)
        text = " ".join(on.text().replace("│", " ").split())
        assert "the service has died" in on.line(1)
        assert "makes a quick stop by itself (wheel: 200 ms)" in text
        assert "emergency stop" in text and "interrupted" in text

    play(act, tmp_path, (110, 40))


def test_stop_after_a_death_reports_it_and_names_no_errno(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await lose(on, ended=False)
        await on.pilot.press("f12")
        await on.until(lambda: "STOP cannot be taken" in on.text(), "it is said")
        assert "Errno" not in on.text() and "machine's own stop" in " ".join(on.text().split())

    play(act, tmp_path, (110, 40))


@pytest.mark.parametrize("ended", [False, True])
def test_leaving_claims_no_continuing_run(ended: bool, tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await lose(on, ended=ended)
        on.app.action_detach()
        said = on.app.return_value or ""
        assert ("has ended" if ended else "has died") in said and "go on" not in said

    play(act, tmp_path)


def test_an_ended_service_is_no_death(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await lose(on, ended=True)
        assert "the service has ended" in on.line(1) and "died" not in on.text()
        assert len(on.app.screen_stack) == 1

    play(act, tmp_path)


def test_a_lost_link_of_unknown_cause_claims_neither() -> None:
    from tester.tui.gone import farewell, gone_line

    scene = ScreenScene(state=a_state(), lost="connection lost")
    assert gone_line(scene) == "" and "may still be under way" in farewell(scene)
