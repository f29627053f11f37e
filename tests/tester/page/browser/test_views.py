"""Every view in a real browser, before a played service."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest
from pydantic_core import to_json

from tester.queue.items import End, ItemState
from tester.queue.view import ItemView, QueueView
from tester.service.commands import (
    ExcludeRepeat,
    Hold,
    QueueDrop,
    QueueMove,
    QueueSkip,
    QueueStand,
    QueueStart,
    RunRecipe,
)
from tester.service.results_view import ConditionValue, GivenResults, GrowingView, GrownValue, OpenValue
from tester.service.state_view import PlanStep, PlanView
from tests.tester.page.browser import records
from tests.tester.page.browser.stage import Front
from tests.tester.service import views

pytest.importorskip("playwright", reason="the browser's driver is not installed: pip install '.[browser]'")
from playwright.sync_api import expect

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext


def run_state(**changes: object) -> views.StateView:
    """Return a state whose run is the stored one."""
    state = views.state()
    assert state.run is not None
    return replace(state, run=replace(state.run, name=records.RUN), **changes)  # type: ignore[arg-type]


def test_browser_and_driver_fit_together(chrome: Browser) -> None:
    page = chrome.new_page()
    assert page.evaluate("6 * 7") == 42, "browser and driver do not fit"
    page.close()


# -- pairing and the bar ---------------------------------------------------------------------------------------------


def test_a_device_is_paired_by_its_code_and_stays_so_after_a_reload(on: Front, desktop: BrowserContext) -> None:
    page = on.open(desktop)
    expect(page.get_by_role("heading", name="Pair this device")).to_be_visible()
    assert page.get_by_role("button", name="STOP").count() == 0
    on.pair(page, "stop")
    page.reload()
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    assert "secret" not in page.url and page.evaluate("document.cookie") == ""
    assert page.evaluate("localStorage.length") == 0


def test_a_wrong_code_is_refused_in_words(on: Front, desktop: BrowserContext) -> None:
    page = on.open(desktop)
    page.get_by_label("Code, six digits").fill("000000")
    page.get_by_label("Name of this device").fill("x")
    page.get_by_role("button", name="Pair", exact=True).click()
    expect(page.get_by_role("alert").filter(has_text="code")).to_be_visible()
    expect(page.locator("nav")).to_be_hidden()


def test_stop_is_alone_at_the_right_and_64_pixels_high(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "stop")
    box = page.get_by_role("button", name="STOP").bounding_box()
    assert box is not None and box["height"] >= 64 and box["x"] + box["width"] > 1280 - 40
    near = page.evaluate(
        """(box) => [...document.querySelectorAll('button, a, input, select')].filter((node) => {
          const r = node.getBoundingClientRect();
          const near = r.bottom > box.y - 20 && r.top < box.y + box.height && r.right > box.x - 60;
          return node.textContent !== 'STOP' && r.width && near;
        }).map((node) => node.textContent)""",
        box,
    )
    assert near == []
    expect(page.get_by_text("not an emergency stop")).to_be_visible()


def test_without_the_service_stop_is_struck_out_and_no_value_is_shown_as_live(
    on: Front, desktop: BrowserContext
) -> None:
    page = on.paired(desktop, "control")
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    expect(page.locator(".drawing")).to_contain_text("199.6")
    on.wait(on.stage.fake.__aexit__(None, None, None))
    expect(page.get_by_role("button", name="STOP")).to_have_count(0, timeout=2500)
    expect(page.locator("s.struck")).to_have_text("STOP")
    expect(page.get_by_text("no connection: use the machine's stop")).to_be_visible()
    expect(page.locator(".drawing")).not_to_contain_text("199.6")


def test_a_device_that_only_looks_has_no_stop(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look")
    expect(page.get_by_text("this device only looks: use the machine's stop")).to_be_visible()
    assert page.get_by_role("button", name="STOP").count() == 0


# -- live ------------------------------------------------------------------------------------------------------------


def test_live_shows_values_where_they_belong_and_the_steps(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look")
    on.call(lambda: on.stage.fake.plan(views.plan()))
    on.call(lambda: on.stage.fake.show(run_state()))
    drawing = page.locator(".drawing svg")
    expect(drawing).to_contain_text("Load199.6 Nset 200.0")
    expect(drawing).to_have_attribute("aria-label", re.compile("press pushes a rubber wheel"))
    expect(page.locator(".step.now")).to_contain_text("heat to 40 degC")
    expect(page.locator(".step.done").first).to_contain_text("took 64 s")


def test_the_coefficient_has_its_uncertainty_as_it_grows(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look")
    on.call(lambda: on.stage.fake.show(run_state()))
    words = "1#, 300 mm/s, 200 N, 40 degC"
    first = GrowingView(150, words, 3, (), OpenValue(1, 0.6987, 12))
    on.call(lambda: on.stage.fake.give(GivenResults(records.RUN, (), first, over=False)))
    expect(page.locator(".mu")).to_have_text("µ 0.699")
    expect(page.get_by_text(f"{words}: repeat 1 so far: 0.699 over 12 rev; no U yet")).to_be_visible()
    grown = (GrownValue(1, 0.7, None, "0.700! ± –"), GrownValue(2, 0.704, 0.029, "0.704! ± 0.029"))
    second = GrowingView(150, words, 3, grown, OpenValue(3, 0.71, 4))
    on.call(lambda: on.stage.fake.give(GivenResults(records.RUN, (), second, over=False)))
    expect(page.locator(".mu")).to_have_text("µ 0.704! ± 0.029")
    expect(page.get_by_text("after 2 of 3 repeats. U: 95 %; repeat 3 so far: 0.710 over 4 rev")).to_be_visible()
    on.call(lambda: on.stage.fake.event("repeat", "repeat 2"))
    expect(page.locator(".growth")).to_contain_text("repeat 3")


def test_steps_show_the_results_of_their_conditions(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look")
    done = PlanStep(3, "condition", "1#, 300 mm/s", "done", 60.0, 60.0, 60.0, 7)
    now = PlanStep(4, "condition", "200 N", "now", 60.0, None, 60.0, 2)
    growing = GrowingView(2, "200 N", 3, (GrownValue(1, 0.61, 0.05, "0.610! ± 0.050"),), None)
    values = (ConditionValue(2, 0.61, 0.05, "0.610! ± 0.050", "", over=False),
              ConditionValue(7, 0.7, 0.03, "0.700? ± 0.030", "swings", over=True))  # fmt: skip
    on.call(lambda: on.stage.fake.plan(PlanView("a", 4, 3, (done, now), 120.0)))
    on.call(lambda: on.stage.fake.show(run_state()))
    on.call(lambda: on.stage.fake.give(GivenResults(records.RUN, values, growing, over=False)))
    expect(page.locator(".step.done")).to_contain_text("0.700? ± 0.030 ? swings")
    expect(page.locator(".step.now")).to_contain_text("0.610! ± 0.050")


def test_trends_are_in_rig_time_with_their_own_set_points(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look")
    for t_s in (7261.0, 7261.25, 7261.5):
        row = (t_s + 40.0, t_s, 0.7, 199.6, 200.0, 299.8, 300.0, 40.4, 40.0)
        on.call(lambda t_s=t_s, row=row: on.stage.fake.show(run_state(t_s=t_s), row))
        page.wait_for_timeout(50)  # a page that is behind gets the newest snapshot only
    for name in ("1 min", "whole run"):
        page.get_by_role("button", name=name).click()
        expect(page.get_by_role("button", name=name)).to_have_attribute("aria-pressed", "true")
    numbers = page.locator(".trends tbody tr").filter(has_text="Load")
    expect(numbers.locator("td").nth(3)).to_have_text("200.0")
    page.get_by_text("Marks on the axis").click()
    expect(page.locator(".marks")).to_contain_text("hold: hold by A. Person")  # the run's record has arrived
    page.get_by_role("button", name="whole run").click()
    page.wait_for_timeout(300)
    asked = [given for query, given in on.played.asked if query == "samples"]
    assert asked and asked[-1]["run"] == records.RUN and asked[-1]["from_s"] == 0.0
    assert {"load_n", "load_setpoint_n"} <= set(asked[-1]["columns"])


def test_an_alarm_comes_first_and_is_announced_once(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control")
    on.call(lambda: on.stage.fake.show(views.with_prompt(views.with_alarm(run_state()))))
    alert = page.locator(".alarms [role=alert]")
    expect(alert).to_have_text("Alarm: normal force above the rig's limit")
    page.evaluate("""() => {
      window.said = 0;
      const everything = { childList: true, characterData: true, subtree: true };
      const alert = document.querySelector('.alarms [role=alert]');
      new MutationObserver(() => { window.said += 1; }).observe(alert, everything);
    }""")
    on.call(lambda: on.stage.fake.show(views.with_prompt(views.with_alarm(run_state(t_s=8000.0)))))
    expect(page.locator(".about-run")).to_contain_text("stopped by a trip")
    assert page.evaluate("window.said") == 0
    cards = page.locator(".alarms .card h3")
    expect(cards.first).to_contain_text("overload")
    expect(cards.nth(1)).to_contain_text("A person is needed")
    expect(page.locator(".alarms")).to_contain_text("Answer it at the machine's terminal")


def test_hold_is_sent_under_the_page_s_name(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control")
    on.call(lambda: on.stage.fake.show(run_state()))
    page.get_by_role("button", name="HOLD").click()
    expect(page.locator(".told")).to_contain_text("Held")
    assert any(isinstance(order.action, Hold) for order in on.stage.fake.orders)


def test_an_action_that_needs_a_code_asks_for_it_and_works_only_with_the_right_one(
    on: Front, desktop: BrowserContext
) -> None:
    page = on.paired(desktop, "control", "queue")
    page.get_by_role("button", name="Run now").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_contain_text("machine's screen")
    wanted = on.wait(on.stage.desk())
    [code] = [waiting.digits for waiting in wanted.asked]
    dialog.get_by_label("Code, six digits").fill(code)
    dialog.get_by_role("button", name="Send").click()
    expect(page.locator(".told")).to_contain_text("The run begins")
    assert [order for order in on.stage.fake.orders if isinstance(order.action, RunRecipe)]


# -- campaign map ----------------------------------------------------------------------------------------------------


def test_the_map_has_a_cell_for_each_condition_with_sign_and_words(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look", "map")
    expect(page.get_by_role("grid")).to_have_count(3)  # one for each compound
    expect(page.locator("[role=gridcell][data-n]")).to_have_count(165)
    told = ((4, "?", "in doubt, 3 of 3 repeats, swings at 11 Hz"), (9, "✕", "refused"), (20, "⊘", "excluded"),
            (150, "◐", "running"), (160, "○", "planned"))  # fmt: skip
    for n, mark, word in told:
        cell = page.locator(f"[data-n='{n}']")
        expect(cell).to_contain_text(mark)
        expect(cell).to_have_attribute("aria-label", re.compile(word))
    expect(page.locator("[data-n='1']")).to_have_attribute(
        "aria-label", "1#, 50 mm/s, 100 N, 40 degC: 0.870 ± 0.014, measured, 3 of 3 repeats"
    )


def test_the_map_s_axes_can_be_chosen(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look", "map")
    page.get_by_label("Down", exact=True).select_option("compound")
    page.get_by_label("Across", exact=True).select_option("load")
    expect(page.get_by_role("grid")).to_have_count(len(records.SLIPS))
    expect(page.get_by_role("grid").first).to_have_attribute("aria-label", re.compile("Compound down, Load, N across"))


def test_arrow_keys_go_from_cell_to_cell_and_enter_opens_one(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look", "map")
    page.locator("[data-n='1']").focus()
    for key in ("ArrowRight", "ArrowDown", "ArrowRight", "ArrowLeft", "Enter"):
        page.keyboard.press(key)
    expect(page.get_by_role("heading", name="Condition 13")).to_be_focused()
    expect(page.locator(".condition tbody").first.locator("tr")).to_have_count(3)
    expect(page.locator(".condition canvas").first).to_be_visible()
    page.locator("[data-n='13']").focus()
    page.keyboard.press("End")
    expect(page.locator("[data-n='22']")).to_be_focused()


def test_a_repeat_is_excluded_with_its_reason(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control", "map")
    page.locator("[data-n='2']").click()
    page.get_by_role("button", name="Exclude repeat 2").click()
    page.get_by_role("dialog").get_by_label("Reason").fill("dust on the belt")
    page.get_by_role("dialog").get_by_role("button", name="Exclude").click()
    expect(page.locator(".told")).to_contain_text("on record")
    run = views.state().run
    assert run is not None
    [given] = [order.action for order in on.stage.fake.orders if isinstance(order.action, ExcludeRepeat)]
    assert given == ExcludeRepeat(run.name, 2, "dust on the belt", 2)


# -- results, overlay ------------------------------------------------------------------------------------------------


def test_runs_are_found_and_at_most_six_are_laid_over_each_other(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look", "results")
    boxes = page.get_by_role("checkbox")
    expect(boxes).to_have_count(7)
    for at in range(6):
        boxes.nth(at).check()
    boxes.nth(6).click()
    expect(page.locator(".told")).to_contain_text("At most 6")
    assert not boxes.nth(6).is_checked()
    page.get_by_role("button", name="Lay 6 runs over each other").click()
    expect(page.locator(".overlay canvas")).to_have_count(3)
    expect(page.locator(".overlay .legend li")).to_have_count(6)
    page.get_by_text("The same in numbers").click()
    row = page.get_by_role("region", name="Difference and ratio").locator("tbody tr").first
    expect(row.locator("td").nth(2)).to_have_text("0.020")
    page.get_by_label("Only conditions with").fill("2#, 200 N")
    page.get_by_label("Only conditions with").press("Tab")
    expect(page.locator(".overlay")).to_contain_text("66 coefficients")
    page.get_by_label("Any text").fill("2026-11-10")
    page.get_by_role("button", name="Find").click()
    expect(boxes).to_have_count(1)


def test_a_run_opens_with_its_table_notes_and_downloads(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control", "results")
    page.get_by_role("button", name=records.RUN, exact=True).click()
    table = page.get_by_role("region", name=re.compile("^Conditions"))
    expect(table.locator("tbody tr")).to_have_count(165)
    expect(table.locator("tbody tr").nth(3)).to_contain_text("? in doubt")
    page.get_by_label("Note", exact=True).fill("measured after cleaning")
    page.get_by_label("Tags, with commas").fill("belt 7, cleaned")
    page.get_by_role("button", name="Put on record").click()
    expect(page.locator(".told")).to_contain_text("On record")
    assert (
        "note",
        {"run": records.RUN, "text": "measured after cleaning", "tags": ["belt 7", "cleaned"]},
    ) in on.played.asked
    page.get_by_role("button", name="Download CSV").click()
    expect(page.locator(".told")).to_contain_text("The download begins")


# -- queue -----------------------------------------------------------------------------------------------------------


def queued(number: int, name: str, state: ItemState, **more: Any) -> ItemView:
    """Return an item of half an hour."""
    utc = "2026-11-27T18:00:00Z"
    return ItemView(number, name, state, "Anna", utc, "0" * 64, "", 2, 1800.0, 1700.0, 1900.0, (), (End.DONE,), **more)


QUEUE = QueueView(7, False, "stands: a person has to agree to item 3", "2026-11-27T18:00:00Z", (
    queued(1, "quickstart", ItemState.ENDED, end=End.SHORT, reason="1 of 2 conditions has no value", run=records.RUN),
    queued(2, "wear", ItemState.RUNNING, left_s=600.0),
    queued(3, "table2", ItemState.WAITING, reason="the rig file has changed: limits.load_n 450 instead of 400"),
    queued(4, "grosch", ItemState.WAITING),
))  # fmt: skip


def test_the_queue_gives_a_reason_for_every_wait(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look", "queue")
    on.call(lambda: on.stage.fake.gateway.take(b"q" + to_json(QUEUE)))
    expect(page.locator(".queue-state")).to_have_text("stands: a person has to agree to item 3")
    items = page.locator("ol.queue").first.locator("li.item")
    expect(items).to_have_count(3)
    expect(items.nth(0)).to_contain_text("10 min left")
    expect(items.nth(1)).to_contain_text("limits.load_n 450 instead of 400")
    expect(items.nth(2)).to_contain_text("waits for the items before it")
    expect(page.locator("ol.over")).to_contain_text("1 of 2 conditions has no value")
    assert page.locator("main").get_by_role("button", name=re.compile("Start|Skip|Drop|Move")).count() == 0


def test_items_are_moved_skipped_and_dropped_at_the_revision_that_is_shown(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control", "queue")
    on.call(lambda: on.stage.fake.gateway.take(b"q" + to_json(QUEUE)))
    for name in ("Move up grosch", "Move down table2", "Skip grosch", "Drop table2"):
        page.get_by_role("button", name=name).click()
        expect(page.locator(".told")).not_to_be_empty()
    page.get_by_role("button", name="Stand after this item").click()
    expect(page.locator(".told")).to_contain_text("The queue stands")
    sent = [order.action for order in on.stage.fake.orders]
    assert sent == [QueueMove(4, 7, 3), QueueMove(3, 7, 0), QueueSkip(4, 7), QueueDrop(3, 7), QueueStand()]


def test_the_queue_starts_only_with_a_code(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control", "queue")
    on.call(lambda: on.stage.fake.gateway.take(b"q" + to_json(QUEUE)))
    page.get_by_role("button", name="Agree to table2 and start").click()
    dialog = page.get_by_role("dialog")
    expect(dialog).to_be_visible()
    assert on.stage.fake.orders == []
    [code] = [waiting.digits for waiting in on.wait(on.stage.desk()).asked]
    dialog.get_by_label("Code, six digits").fill(code)
    dialog.get_by_role("button", name="Send").click()
    expect(page.locator(".told")).to_contain_text("the queue goes")
    assert [order.action for order in on.stage.fake.orders] == [QueueStart((3,))]


# -- replay ----------------------------------------------------------------------------------------------------------


def test_replay_shows_a_moment_of_the_record_and_has_no_stop_of_its_own(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "stop", "replay")
    slider = page.get_by_role("slider")
    expect(slider).to_be_visible()
    slider.focus()
    page.keyboard.press("End")
    expect(page.locator(".clock")).to_have_text("5:30:00 of 5:30:00")
    expect(page.locator(".replay .drawing svg")).to_contain_text("198.00 N")
    page.keyboard.press("Home")
    expect(page.locator(".replay .drawing svg")).to_contain_text("0.00 N")
    assert page.locator("main").get_by_role("button", name="STOP").count() == 0
    expect(page.locator(".replay")).to_contain_text("A record, not the machine")
    page.get_by_role("button", name="Play").click()
    expect(slider).not_to_have_value("0", timeout=5000)
    page.get_by_role("button", name="Pause").click()


def test_a_phone_has_hold_far_from_stop_and_nothing_beside_the_window(on: Front, phone: BrowserContext) -> None:
    page = on.paired(phone, "control")
    on.call(lambda: on.stage.fake.show(run_state()))
    hold, stop = (page.get_by_role("button", name=name).bounding_box() for name in ("HOLD", "STOP"))
    assert hold is not None and stop is not None
    assert hold["y"] - (stop["y"] + stop["height"]) > 80 / 25.4 * 96  # 8 cm
    for view in ("live", "map", "results", "replay", "queue", "paired"):
        on.go(page, view)
        page.wait_for_timeout(200)
        assert page.evaluate("document.documentElement.scrollWidth") <= 400, view
