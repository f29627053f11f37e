"""Orders of the keys, and what must be shown first."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path

import pytest

from tester.run.kind_lookup import load_rig
from tester.service.commands import (
    Acknowledge,
    Answer,
    Arm,
    Hold,
    Jog,
    Release,
    ResumeRun,
    RunRecipe,
    Stop,
    Tare,
    WatchFrames,
)
from tester.service.state_view import ManualView
from tester.tui.pages.recipes import RecipesView
from tests.tester.service.views import state as a_state
from tests.tester.service.views import with_alarm, with_prompt
from tests.tester.tui.stage import House, Stage, play


def test_space_holds_from_another_screen_without_a_question(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("space")
        assert await on.ordered(Hold) == Hold() and len(on.app.screen_stack) == 1

    house.play(act)


def test_going_on_after_hold_needs_the_list_and_enter(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(a_state("HOLD"))
        await on.pilot.press("f3", "r")
        assert "guard closed" in on.text() and not on.fake.orders
        await on.pilot.press("enter")
        await on.ordered(Release)

    house.play(act)


def test_abort_needs_its_word(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f3", "x", "n", "o", "enter")
        assert not on.fake.orders
        await on.pilot.press("backspace", "backspace", *"abort", "enter")
        await on.ordered(Stop)

    house.play(act)


def test_where_nothing_runs_there_is_nothing_to_abort(house: House) -> None:
    async def act(on: Stage) -> None:
        view = a_state("OFFLINE")
        assert view.run is not None
        await on.show(replace(view, run=replace(view.run, outcome="stopped")))
        await on.pilot.press("f3", "x")
        await on.until(lambda: "nothing runs that could be aborted" in on.text(), "it says so")
        assert len(on.app.screen_stack) == 1

    house.play(act)


def test_after_a_stop_unfinished_runs_are_listed_and_the_chosen_one_resumes(house: House) -> None:
    async def act(on: Stage) -> None:
        ended = {"conditions": 2, "repeats": 3, "repeats_planned": 6}
        on.queries.stored = [
            {"run": "2024-first", "status": "stopped", "can_resume": True, "started_utc": "2024-01-01", **ended},
            {"run": "2024-over", "status": "done", "can_resume": False, "started_utc": "2024-01-02", **ended},
            {"run": "2024-last", "status": "tripped", "can_resume": True, "started_utc": "2024-01-03", **ended},
        ]
        await on.show(a_state("OFFLINE"))
        await on.pilot.press("f3", "r")
        await on.until(lambda: "2024-first  stopped, 3 of 6 repeats committed" in on.text(), "the list is shown")
        assert "2024-over" not in on.text() and on.text().index("2024-last") < on.text().index("2024-first")
        await on.pilot.press("down", "enter")
        await on.until(lambda: "2024-first resumes" in on.text(), "the pre-flight list is shown")
        await on.pilot.press("enter")
        assert (await on.ordered(ResumeRun)).run == "2024-first"  # type: ignore[union-attr]
        on.queries.stored = []

    house.play(act)


def test_a_latched_rig_resumes_nothing_before_it_is_acknowledged(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(a_state("LATCHED"))
        await on.pilot.press("f3", "r")
        await on.until(lambda: "nothing begins before the trip is acknowledged" in on.text(), "it says so")

    house.play(act)


def test_acknowledging_names_the_alarm_of_line_two(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_alarm(a_state()))
        assert "P1 overload 461.0 N (limit 450.0)" in on.line(1) and "[a acknowledge]" in on.line(1)
        await on.pilot.press("a")
        assert await on.ordered(Acknowledge) == Acknowledge(1)

    house.play(act)


def test_a_question_is_answered_by_its_button(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_prompt(a_state()))
        await on.pilot.press("f3", "enter")
        on.now[0] += 1.0
        await on.pilot.press("right", "enter")
        assert await on.ordered(Answer) == Answer(1)

    house.play(act)


def test_a_quantity_that_a_question_asks_for_is_typed(house: House) -> None:
    async def act(on: Stage) -> None:
        asked = with_prompt(a_state())
        assert asked.prompt is not None
        await on.show(replace(asked, prompt=replace(asked.prompt, unit="mm")))
        await on.pilot.press("f3", "enter")
        on.now[0] += 1.0
        await on.pilot.press("shift+tab", *"89.62", "tab", "right", "enter")
        assert await on.ordered(Answer) == Answer(1, "89.62")

    house.play(act)


@pytest.mark.parametrize("keys", [["enter"], ["y", "space", "space", "r", "enter"], [*"yes", "enter"], ["escape"]])
def test_stray_keys_answer_no_question(keys: list[str], house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_prompt(a_state()))
        await on.pilot.press("f3", "enter")
        on.now[0] += 1.0
        await on.pilot.press(*keys)
        await on.pilot.pause()
        assert not [order for order in on.fake.orders if isinstance(order.action, Answer)]

    house.play(act)


def test_keys_typed_before_the_question_is_seen_do_not_count(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_prompt(a_state()))
        await on.pilot.press("f3", "enter", "right", "enter")
        await on.pilot.pause()
        assert not on.fake.orders and len(on.app.screen_stack) == 2

    house.play(act)


def test_hold_works_while_a_question_is_open(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.show(with_prompt(a_state()))
        await on.pilot.press("f3", "enter", "space")
        assert await on.ordered(Hold) == Hold() and len(on.app.screen_stack) == 2

    house.play(act)


def test_enter_twice_on_quickstart_starts_it_after_the_list_was_shown(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.until(lambda: on.checked(), "the recipes are checked")
        await on.pilot.press("enter")
        assert "disk space: 50 GB free" in on.text() and not on.fake.orders
        await on.pilot.press("enter")
        order = await on.ordered(RunRecipe)
        assert isinstance(order, RunRecipe) and order.recipe == "quickstart" and order.speed == 1.0 and not order.yes
        await on.until(lambda: "Process" in on.text(), "the run screen is shown")

    house.play(act)


def test_the_plan_is_shown_though_other_recipes_are_still_being_checked(house: House) -> None:
    async def act(on: Stage) -> None:
        on.queries.checking.clear()
        on.queries.planning.clear()
        await on.pilot.press("g")
        await on.until(lambda: on.queries.waiting > 0, "a recipe is being checked")
        await on.pilot.press("enter")
        await on.until(lambda: on.queries.planned > 0, "the plan is asked for")
        before = on.queries.answered
        on.queries.checking.set()
        await on.until(lambda: on.queries.answered > before + 1, "a check is answered, and the next one asked for")
        on.queries.planning.set()
        await on.until(lambda: "2 conditions, 1 wheel, 0:45:00 of rig time" in on.text(), "the plan's totals are shown")

    house.play(act)


def test_a_recipe_with_a_problem_leads_to_its_line_and_does_not_start(tmp_path: Path) -> None:
    (tmp_path / "recipes").mkdir()
    (tmp_path / "recipes" / "mine.yaml").write_text("recipe: mine\nb: 1\nload: wrong\n", encoding="utf-8")

    async def act(on: Stage) -> None:
        await on.until(lambda: on.checked(), "the recipes are checked")
        await on.pilot.press("home")
        assert "✘ 1 mine" in on.text()
        await on.pilot.press("enter")
        assert on.app.query_one("#recipe-text").cursor_location[0] == 2  # type: ignore[attr-defined]
        assert not on.fake.orders

    play(act, tmp_path)


def test_editing_a_shipped_recipe_makes_a_copy_and_checks_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    edited: list[str] = []

    def edit(command: list[str], **_: bool) -> None:
        edited.extend(command)
        Path(command[-1]).write_text("recipe: wrong\n", encoding="utf-8")

    monkeypatch.setenv("EDITOR", "some editor")
    monkeypatch.delenv("VISUAL", raising=False)
    monkeypatch.setattr("tester.tui.pages.recipes.subprocess.run", edit)
    monkeypatch.setattr("tester.tui.app.TesterApp.suspend", lambda app: nullcontext())  # no terminal here to give away

    async def act(on: Stage) -> None:
        await on.until(lambda: on.checked(), "the recipes are checked")
        await on.pilot.press("e")
        await on.until(lambda: "✘ 1 my-quickstart" in on.text(), "the copy is checked")
        assert edited == ["some", "editor", str(tmp_path / "recipes" / "my-quickstart.yaml")]

    play(act, tmp_path)


def test_a_key_press_by_hand_is_one_step_and_only_while_armed(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f4", "right")
        assert not [o for o in on.fake.orders if isinstance(o.action, Jog)]
        await on.pilot.press("m")
        await on.ordered(Arm)
        await on.show(replace(a_state("MANUAL"), manual=ManualView(60.0, "")))
        await on.pilot.press("down", "right")
        assert await on.ordered(Jog) == Jog("belt", 1)
        await on.pilot.press("t")
        await on.ordered(Tare)

    house.play(act)


def test_leaving_the_manual_screen_disarms(house: House) -> None:
    async def act(on: Stage) -> None:
        clients = replace(a_state().clients, controller_id=1)
        number = on.app.link.client.number if on.app.link is not None and on.app.link.client is not None else 0
        armed = replace(a_state("MANUAL"), manual=ManualView(60.0, ""), clients=replace(clients, controller_id=number))
        await on.pilot.press("f4")
        await on.show(armed)
        await on.pilot.press("f3")
        assert await on.ordered(Arm) == Arm(on=False)

    house.play(act)


def test_frames_are_asked_for_only_while_they_are_looked_at(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f6")
        await on.until(lambda: on.fake.presence.frames, "frames are asked for")
        await on.pilot.press("f3")
        await on.until(lambda: not on.fake.presence.frames, "frames are not asked for any more")
        assert not [o for o in on.fake.orders if isinstance(o.action, WatchFrames)]

    house.play(act)


def test_coming_to_the_results_lists_the_runs_once(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f5")
        await on.until(lambda: on.queries.listed > 0, "the runs are listed")
        on.app.scene_changed()
        await on.pilot.pause()
        assert on.queries.listed == 1

    play(act, tmp_path)


def test_a_screen_below_a_dialog_is_entered_when_that_closes(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f3", "f1")
        on.app.go_to("results")
        await on.pilot.pause()
        assert not on.queries.listed
        await on.pilot.press("escape")
        on.app.scene_changed()
        await on.until(lambda: on.queries.listed == 1, "the runs are listed")

    play(act, tmp_path)


def test_while_the_terminal_is_too_small_nothing_is_asked_for_again(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f5")
        await on.until(lambda: on.queries.listed > 0, "the runs are listed")
        await on.pilot.resize_terminal(30, 8)
        for _ in range(3):
            on.app.scene_changed()
            await on.pilot.pause()
        await on.pilot.resize_terminal(80, 24)
        await on.pilot.pause()
        on.app.scene_changed()
        await on.until(lambda: on.app.focused is on.app.query_one("#runs"), "the keys go to the runs again")
        assert on.queries.listed == 1

    play(act, tmp_path)


def test_editing_one_recipe_leaves_none_of_the_others_unchecked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("EDITOR", "some editor")
    monkeypatch.setattr("tester.tui.pages.recipes.subprocess.run", lambda command, **_: None)
    monkeypatch.setattr("tester.tui.app.TesterApp.suspend", lambda app: nullcontext())

    async def act(on: Stage) -> None:
        await on.until(on.checked, "the recipes are checked")
        view = on.app.query_one(RecipesView)
        view.checked.clear()
        await on.pilot.press("e")
        await on.until(on.checked, "the recipes are checked again")

    play(act, tmp_path)


def test_an_old_state_is_no_state(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f3")
        on.now[0] += 12.0
        on.app.scene_changed()
        await on.pilot.pause()
        assert "NO LINK 12 s" in on.line(0) and "199.6?" in on.text()

    play(act, tmp_path)


def test_a_screen_that_finds_a_run_under_way_shows_it(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        assert on.found == "run"

    play(act, tmp_path)


def test_a_refused_acknowledgement_is_reported_with_the_way_out(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        on.fake.event("acknowledgement", "refused, still there: drive fault")
        await on.until(lambda: "drive fault; F12 ends the run" in on.text(), "the way out is shown")
        assert not on.fake.orders

    play(act, tmp_path)


def test_a_lost_service_is_reported_and_found_again(tmp_path: Path) -> None:
    async def act(on: Stage) -> None:
        client = on.app.link.client if on.app.link is not None else None
        assert client is not None
        await client.close()
        await on.until(lambda: "NO LINK" in on.line(0), "the loss is shown")
        await on.until(lambda: "NO LINK" not in on.line(0), "the service is found again")
        assert on.app.link is not None and on.app.link.client not in (None, client)

    play(act, tmp_path)


def test_a_refusal_is_shown_with_its_reason(house: House) -> None:
    async def act(on: Stage) -> None:
        on.fake.refusals["hold"] = "nothing runs [/x]"
        await on.pilot.press("space")
        await on.until(lambda: "refused: nothing runs [/x]" in on.text(), "the reason is shown")
        assert [order.action for order in on.fake.orders] == [Hold()]

    house.play(act)


def test_commissioning_is_offered_only_while_the_rig_is_free(house: House) -> None:
    async def act(on: Stage) -> None:
        await on.pilot.press("f4", "c")
        await on.until(lambda: "commissioning begins while no run" in on.text(), "why not is said")
        on.app.shown_messages.clear()
        await on.show(a_state("OFFLINE"))
        await on.pilot.press("c")
        await on.until(lambda: "the service has another rig" in on.text(), "the way in a shell is said")

    house.play(act)


def test_commissioning_begins_on_a_screen_of_its_own_with_this_screens_rig_and_runs(
    house: House, monkeypatch: pytest.MonkeyPatch
) -> None:
    begun: list[list[str]] = []
    monkeypatch.setattr("tester.tui.app.subprocess.run", lambda command, check: begun.append(command))

    async def act(on: Stage) -> None:
        monkeypatch.setattr(on.app, "suspend", nullcontext)
        monkeypatch.setattr(on.app, "options", replace(on.app.options, address=None))
        await on.show(replace(a_state("OFFLINE"), rig=load_rig("sim").name))
        await on.pilot.press("f4", "c")
        await on.until(lambda: bool(begun), "the other screen begins")

    house.play(act)
    ((*_, command, rig, screen, out, runs, theme, dark),) = begun
    assert (command, rig, screen, out, theme, dark) == ("commission", "sim", "--tui", "--out", "--theme", "dark")
    assert runs.endswith("runs")
