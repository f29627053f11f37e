"""Bus: frozen frames, a filter, the support bundle; and a cursor visible without colour."""

from __future__ import annotations

from pathlib import Path
from zipfile import ZipFile

import pytest
from rich.style import Style

from tester.service.protocol import Frame, Frames
from tests.tester.service.views import state as a_state
from tests.tester.tui.stage import Stage, play


def frames(first: int) -> Frames:
    """Return three frames, one of them on a serial line."""
    return Frames(
        (
            Frame(1.0 * first, "can", True, 0x80, ""),
            Frame(1.0 * first + 1.0, "can", False, 0x181, "37 06"),
            Frame(1.0 * first + 2.0, "cell", False, 1, "03 04 [/x]"),
        ),
        0,
    )


async def send(on: Stage, first: int) -> None:
    """Send frames to a screen that shows them."""
    on.app.scene.take(frames(first), None)
    on.app.scene_changed()
    await on.pilot.pause()


def test_frozen_frames_stand_still_while_others_come(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f6")
        await send(on, 10)
        await on.pilot.press("f")
        await send(on, 20)
        assert "FROZEN, 6 seen" in on.text() and "10.0000 can" in on.text() and "20.0000 can" not in on.text()
        await on.pilot.press("f")
        assert "live, 6 seen" in on.text() and "20.0000 can" in on.text()

    play(act, tmp_path, (120, 40))


def test_a_filter_leaves_the_frames_with_its_text_and_escape_shows_all(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f6")
        await send(on, 10)
        await on.pilot.press("slash", *"181", "enter")
        assert "11.0000 can" in on.text() and "10.0000 can" not in on.text() and "with 181" in on.text()
        await on.pilot.press("escape")
        assert "10.0000 can" in on.text() and "03 04 [/x]" in on.text()

    play(act, tmp_path, (120, 40))


def test_the_bundle_holds_state_events_and_frames(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)

    async def act(on: Stage) -> None:
        await on.show(a_state())
        await on.pilot.press("f6")
        await send(on, 10)
        await on.pilot.press("b")
        await on.until(lambda: "support bundle: support-" in on.text(), "the bundle is named")

    play(act, tmp_path)
    with ZipFile(next(tmp_path.glob("support-*.zip"))) as bundle:
        assert {"state.json", "events.jsonl", "frames.jsonl", "version.txt"} <= set(bundle.namelist())
        assert b"37 06" in bundle.read("frames.jsonl")


def styles(on: Stage, text: str) -> list[Style]:
    """Return the styles of a text on the screen."""
    strips = on.app.screen._compositor.render_strips()
    return [segment.style or Style() for strip in strips for segment in strip if segment.text.strip().startswith(text)]


@pytest.mark.parametrize(
    ("keys", "chosen", "other"),
    [
        (["f2"], "✔   quickstart", "✔   table2"),
        (["f2", "enter"], "Start (Enter)", "Back"),
        (["f4", "down"], "Belt speed   0.05", "Wheel speed  0.05"),
        (["f3", "ctrl+p", "down", "up"], "Abort…", "Acknowledge"),
    ],
)
def test_without_colour_the_chosen_line_differs(
    keys: list[str], chosen: str, other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")

    async def act(on: Stage) -> None:
        await on.until(lambda: on.checked(), "the recipes are checked")
        await on.pilot.press(*keys)
        await on.until(lambda: bool(styles(on, chosen) and styles(on, other)), "both lines are there")
        await on.until(lambda: any(style.underline for style in styles(on, chosen)), "the chosen line is underlined")
        assert not any(style.underline for style in styles(on, other))

    play(act, tmp_path)
