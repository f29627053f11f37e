"""The page in a real browser before the real page process and the real service, on the simulated rig."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.tester.page.browser.stage import WATCH
from tests.tester.page.browser.whole import Whole, whole

pytest.importorskip("playwright", reason="the browser's driver is not installed: pip install '.[browser]'")
from playwright.sync_api import expect

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

    from tester.page.roles import Role


SLOW_MS = 60_000
"""Time limit of an answer from stored runs beside other tests: only a failure takes that long."""
elsewhere: list[str] = []


@pytest.fixture(scope="module")
def served(chrome: Browser, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Whole]:
    """Both processes for this file's tests."""
    del chrome
    with whole(tmp_path_factory.mktemp("w")) as both:
        yield both


def paired(both: Whole, context: BrowserContext, role: Role) -> Page:
    """Open the page as a person does."""
    page = context.new_page()
    page.add_init_script(WATCH)
    page.on("request", lambda request: elsewhere.append(request.url) if both.origin not in request.url else None)
    page.goto(both.origin)
    page.get_by_label("Code, six digits").fill(both.code(role))
    page.get_by_label("Name of this device").fill("Anna's phone")
    page.get_by_role("button", name="Pair", exact=True).click()
    expect(page.locator("nav")).to_be_visible()
    return page




def test_stop_stops_the_run_and_its_record_is_in_every_view(served: Whole, desktop: BrowserContext) -> None:
    page = paired(served, desktop, "stop")
    served.run(speed=20.0)
    expect(page.locator(".mode")).to_have_text("running", timeout=SLOW_MS)
    expect(page.locator(".step.now")).to_be_visible()
    page.get_by_role("button", name="STOP").click()
    expect(page.locator(".stop-told")).to_have_text("STOP taken")
    served.until(lambda: served.mode() == ("OFFLINE", "stopped"))
    expect(page.locator(".mode")).to_have_text("ready", timeout=SLOW_MS)

    page.locator("nav a[href='#results']").click()
    row = page.locator("table.runs tbody tr")
    expect(row).to_have_count(1, timeout=SLOW_MS)
    expect(row).to_contain_text("stopped, simulated")
    row.get_by_role("button").click()
    conditions = page.get_by_role("region", name=re.compile("^Conditions"))
    expect(conditions.locator("tbody tr")).to_have_count(2, timeout=SLOW_MS)
    with page.expect_download(timeout=SLOW_MS) as downloading:
        page.get_by_role("button", name="Download CSV").click()
    assert b"compound" in Path(downloading.value.path()).read_bytes().partition(b"\n")[0]
    page.locator("nav a[href='#map']").click()
    expect(page.locator("[role=gridcell][data-n]")).to_have_count(2, timeout=SLOW_MS)
    page.locator("nav a[href='#replay']").click()
    expect(page.locator(".replay canvas")).to_have_count(4, timeout=SLOW_MS)
    page.get_by_role("slider").press("End")
    expect(page.locator(".replay .events")).to_contain_text("stop", timeout=SLOW_MS)
    assert page.evaluate("window.__violations") == [] and elsewhere == []


def test_the_keys_stop_as_well(served: Whole, desktop: BrowserContext) -> None:
    page = paired(served, desktop, "control")
    served.run(speed=20.0)
    page.locator("nav a[href='#results']").click()
    page.get_by_label("Any text").focus()
    page.keyboard.press("Control+Shift+X")
    expect(page.locator(".stop-told")).to_have_text("STOP taken")
    served.until(lambda: served.mode() == ("OFFLINE", "stopped"))


def test_a_role_that_looks_can_neither_stop_nor_hold(served: Whole, desktop: BrowserContext) -> None:
    page = paired(served, desktop, "look")
    expect(page.locator("s.struck")).to_be_visible()
    page.keyboard.press("Control+Shift+X")
    expect(page.locator(".stop-told")).to_have_text("this device only looks: use the machine's stop")
    assert page.get_by_role("button", name="HOLD").count() == 0


def test_when_the_service_dies_the_page_reports_it_within_two_seconds_and_shows_no_live_value(
    served: Whole, desktop: BrowserContext
) -> None:
    page = paired(served, desktop, "stop")
    expect(page.get_by_role("button", name="STOP")).to_be_visible()
    served.processes[0].kill()
    expect(page.locator("s.struck")).to_be_visible(timeout=2500)
    expect(page.locator(".stop-told")).to_have_text("no connection: use the machine's stop")
    assert page.get_by_role("button", name="STOP").count() == 0
    assert page.locator(".drawing .number").all_text_contents() == ["–"] * page.locator(".drawing .number").count()
