"""Every screen: normal, with an alarm, stale, without colour, in ASCII; compared with golden/.

`TESTER_GOLDEN=write pytest tests/tester/tui/test_screens.py` writes the pictures anew; look at the difference.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from tester.service.state_view import StateView
from tests.tester.service.views import HOSTILE, hostile, plan, stale, with_alarm, with_prompt
from tests.tester.service.views import state as a_state
from tests.tester.tui.stage import Stage, colours, play

GOLDEN = Path(__file__).parent / "golden"
SIZES = {"80x24": (80, 24), "120x40": (120, 40)}
KEYS = {"recipes": "f2", "run": "f3", "manual": "f4", "results": "f5", "bus": "f6"}
STATES = {"normal": a_state(), "alarm": with_prompt(with_alarm(a_state())), "stale": stale(a_state())}


@pytest.fixture(autouse=True)
def _utc(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tester.tui.formatting.local", lambda moment: moment)


async def at_screen(on: Stage, name: str, view: StateView) -> None:
    """Go to a screen, with a state, and wait until it is complete."""
    await on.until(lambda: on.checked(), "the recipes are checked")
    await on.pilot.press(KEYS[name])
    await on.show(view, plan())
    await on.pilot.pause()


@pytest.mark.parametrize("size", SIZES)
def test_screens_look_as_they_did(size: str, tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        for name in KEYS:
            for state, view in STATES.items():
                await at_screen(on, name, view)
                compare(f"{name}-{size}-{state}", on.text())

    play(act, tmp_path, SIZES[size])


def test_an_accepted_risk_is_shown_on_every_screen(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        view = replace(a_state(), risk="trial of a new cell: limits.load 480 N is looser than 450 N")
        for name in KEYS:
            await at_screen(on, name, view)
            assert "RISK ACCEPTED" in on.line(0), name
            if name == "run":
                compare("run-80x24-risk", on.text())

    play(act, tmp_path)


def compare(name: str, text: str) -> None:
    """Compare a picture with the approved one."""
    file = GOLDEN / f"{name}.txt"
    if os.environ.get("TESTER_GOLDEN") == "write":
        GOLDEN.mkdir(exist_ok=True)
        file.write_text(text + "\n", encoding="utf-8")
    assert text + "\n" == file.read_text(encoding="utf-8")


def test_without_colour_the_text_is_the_same_no_colour_is_sent_and_an_alarm_differs_from_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NO_COLOR", "1")

    async def act(on: Stage) -> None:
        for name in KEYS:
            await at_screen(on, name, STATES["alarm"])
            compare(f"{name}-80x24-alarm", on.text())
            assert not colours(on.app)
        await at_screen(on, "run", STATES["stale"])
        assert not colours(on.app)
        await at_screen(on, "run", STATES["alarm"])
        first = on.app.screen._compositor.render_strips()[1]
        assert all(segment.style is not None and segment.style.reverse for segment in first if segment.text.strip())

    play(act, tmp_path)


def test_with_ascii_nothing_else_leaves(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        for name in KEYS:
            await at_screen(on, name, STATES["alarm"])
            assert on.text().isascii()
            await on.pilot.press("f1")
            assert on.text().isascii()
            await on.pilot.press("escape")

    play(act, tmp_path, (120, 40), plain=True)


def test_themes_show_the_same_text_in_other_colours(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await at_screen(on, "run", STATES["normal"])
        seen = [colours(on.app)]
        for theme in ("light", "16"):
            on.app.action_use_theme(theme)
            await on.pilot.pause()
            compare("run-80x24-normal", on.text())
            assert colours(on.app) not in seen
            seen.append(colours(on.app))

    play(act, tmp_path)


def test_no_size_from_200x50_to_20x5_breaks_a_screen(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        keys = list(KEYS.values())
        for turn, share in enumerate((10, 6, 2, 0)):
            await on.show(STATES["alarm"] if turn % 2 else STATES["normal"], plan())
            await on.pilot.resize_terminal(20 + 18 * share, 5 + 9 * share // 2)  # each time on another screen
            for key in keys[turn % 5 :] + keys[: turn % 5]:
                await on.pilot.press(key)
                assert "STOP" in on.line(-1), on.text()
                assert ("the run continues" in on.text()) == (share < 3), on.text()

    play(act, tmp_path, (200, 50))


def test_hostile_text_is_shown_and_never_obeyed(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        view = hostile(with_alarm(a_state()))
        alarm = replace(view.alarms[0], name=HOSTILE, text=HOSTILE, consequence=HOSTILE, unit=HOSTILE)
        devices = tuple(replace(one, name=HOSTILE, state=HOSTILE, detail=HOSTILE) for one in view.devices)
        values = tuple(replace(one, label=HOSTILE, unit=HOSTILE) for one in view.values)
        checks = tuple(replace(one, name=HOSTILE, text=HOSTILE) for one in view.preflight)
        view = replace(view, mode_text=HOSTILE, rig=HOSTILE, alarms=(alarm,), devices=devices, values=values,
                       preflight=checks, interrupted=(HOSTILE,))  # fmt: skip
        on.fake.event("note", HOSTILE, "warning")
        steps = replace(plan(), steps=tuple(replace(step, title=HOSTILE) for step in plan().steps))
        for name in KEYS:
            await at_screen(on, name, view)
            await on.show(view, steps)
            seen = [on.text()]
            for keys in {"run": ["l", "escape", "enter", "escape"], "recipes": ["enter", "escape"]}.get(name, []):
                await on.pilot.press(keys)
                seen.append(on.text())
            assert not any(sign in text for text in seen for sign in "\x1b\x00\u202e"), name
            assert "[/x] [bold]" in "".join(seen), name
        on.app.say(HOSTILE, problem=True)
        await on.until(lambda: on.text().count("[/x] [bold]") > seen[-1].count("[/x] [bold]"), "the message is shown")
        assert not any(sign in on.text() for sign in "\x1b\x00\u202e")

    play(act, tmp_path, (120, 40))


def test_a_recipe_with_hostile_text_and_name_is_shown_as_it_is(tmp_path: Path) -> None:
    folder = tmp_path / "recipes"
    folder.mkdir()
    (folder / "[bold]x[.yaml").write_text(f"recipe: '{HOSTILE}'\nwrong: yes\n", encoding="utf-8")

    async def act(on: Stage) -> None:
        await on.until(lambda: on.checked(), "the recipes are checked")
        await on.pilot.press("home")
        assert "[bold]x[" in on.text() and "3:5 load: expected a unit [/x]" in on.text()
        assert not any(sign in on.text() for sign in "\x1b\x00\u202e")

    play(act, tmp_path)
