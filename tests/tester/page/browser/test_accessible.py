"""Accessibility of every view: axe, keyboard alone, sizes of targets, three widths, light and dark."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

import pytest

from tests.tester.page.browser.conftest import SIZES
from tests.tester.page.browser.stage import Front
from tests.tester.service import views

pytest.importorskip("playwright", reason="the browser's driver is not installed: pip install '.[browser]'")
pytest.importorskip("axe_playwright_python", reason="axe-core is not installed: pip install '.[browser]'")
from axe_playwright_python.base import AXE_SCRIPT
from playwright.sync_api import expect

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

VIEWS = ("live", "map", "results", "replay", "queue", "paired")
SERIOUS = ("serious", "critical")
Scheme = Literal["light", "dark"]


def prepared(on: Front, page: Page, view: str) -> None:
    """Open a view and a dialog or detail in it."""
    on.go(page, view)
    page.wait_for_timeout(300)
    if view == "map":
        page.locator("[data-n='4']").click()
        expect(page.get_by_role("heading", name="Condition 4")).to_be_visible()
    if view == "results":
        page.get_by_role("checkbox").first.check()
        page.get_by_role("button", name="Lay runs over each other").click()
        expect(page.locator(".overlay canvas")).to_have_count(1)


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", SIZES)
def test_axe_finds_no_serious_fault(on: Front, chrome: Browser, width: int, scheme: Scheme) -> None:
    context = chrome.new_context(viewport={"width": width, "height": SIZES[width]}, color_scheme=scheme)
    page = on.open(context)
    found: list[tuple[str, str, Any]] = []

    def look(view: str) -> None:
        page.evaluate(AXE_SCRIPT)
        result = page.evaluate("axe.run(document, { resultTypes: ['violations'] })")
        found.extend((view, fault["id"], [node["target"] for node in fault["nodes"]][:3])
                     for fault in result["violations"] if fault["impact"] in SERIOUS)  # fmt: skip

    look("pairing")
    on.pair(page, "control")
    on.call(lambda: on.stage.fake.plan(views.plan()))
    on.call(lambda: on.stage.fake.show(views.with_prompt(views.with_alarm(views.state()))))
    for view in VIEWS:
        prepared(on, page, view)
        look(view)
    assert found == []
    context.close()


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("width", SIZES)
def test_every_view_fits_its_window_and_its_targets_are_44_pixels(
    on: Front, chrome: Browser, width: int, scheme: Scheme
) -> None:
    context = chrome.new_context(
        viewport={"width": width, "height": SIZES[width]}, color_scheme=scheme, reduced_motion="reduce"
    )
    page = on.paired(context, "control")
    on.call(lambda: on.stage.fake.show(views.state()))
    for view in VIEWS:
        prepared(on, page, view)
        assert page.evaluate("document.documentElement.scrollWidth") <= width, view
        small = page.evaluate(
            """() => [...document.querySelectorAll(
              'button, nav a, select, input:not([type=checkbox]), label.tick, [role=gridcell]')]
              .filter((node) => node.offsetParent && node.getBoundingClientRect().height < 43.5)
              .map((node) => node.outerHTML.slice(0, 80))"""
        )
        assert small == [], view
        assert page.evaluate("parseFloat(getComputedStyle(document.body).fontSize)") >= 16
    context.close()


def test_stop_is_the_first_thing_that_tab_reaches(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "stop", "results")
    page.reload()
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    page.keyboard.press("Tab")
    expect(page.get_by_role("button", name="STOP")).to_be_focused()


def test_every_view_and_its_main_action_is_reached_by_keyboard_alone(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control")
    page.reload()
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    reached: set[str] = set()
    for view in VIEWS:
        page.locator("nav a").nth(VIEWS.index(view)).focus()
        page.keyboard.press("Enter")
        page.wait_for_timeout(250)
        expect(page.locator("nav a[aria-current]")).to_have_count(1)
        for _ in range(40):
            page.keyboard.press("Tab")
            reached.add(
                page.evaluate(
                    "(document.activeElement?.textContent || document.activeElement?.name || '').slice(0, 40)"
                )
            )
    assert {"1 min", "Zoom in", "Find", "Play", "Add to the queue", "End the pairing of this device"} <= reached
    page.locator("nav a").nth(1).focus()
    page.keyboard.press("Enter")
    cell = page.get_by_role("gridcell").first
    cell.focus()
    page.keyboard.press("Space")
    expect(page.get_by_role("heading", name="Condition 1")).to_be_focused()


def test_a_chart_has_a_table_beside_it_that_is_not_read_aloud_by_itself(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "look")
    on.call(lambda: on.stage.fake.show(views.state()))
    table = page.get_by_role("region", name="Numbers of the trends")
    expect(table.locator("tbody tr")).to_have_count(4)
    expect(table).to_have_attribute("aria-live", "off")
