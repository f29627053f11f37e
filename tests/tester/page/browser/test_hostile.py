"""Texts from people, devices and recipes stay texts: no view turns one into a node, a handler or a request."""

from __future__ import annotations

from dataclasses import replace
from itertools import product
from typing import TYPE_CHECKING, Any

import pytest

from tests.tester.page.browser import records
from tests.tester.page.browser.stage import Front
from tests.tester.service import views

pytest.importorskip("playwright", reason="the browser's driver is not installed: pip install '.[browser]'")
from playwright.sync_api import expect

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext, Page

STARTS = ("", "'", '"', "\"'>", "</td>", "</script>", "-->", "]]>", "${1}", "{{1}}", "\u202e", "\x00", "=1+1 ")
BODIES = (
    "<img src=x onerror=window.__ran=1>", "<svg onload=window.__ran=1>", "<script>window.__ran=1</script>",
    "<b>bold</b>", "<iframe src=//evil.example>", "<a href=javascript:window.__ran=1>x</a>",
    "<style>*{display:none}</style>", "<link rel=stylesheet href=//evil.example>", "<base href=//evil.example>",
    "<form action=//evil.example><input>",
    "<math><mtext><img src=//evil.example>", "<template><img src=x onerror=window.__ran=1></template>",
    "&lt;img src=x onerror=window.__ran=1&gt;", "javascript:window.__ran=1", "<x-hostile>", "url(//evil.example)",
)  # fmt: skip
TEXTS = [start + body for start, body in product(STARTS, BODIES)][:200]
ONE = " ".join(TEXTS)[:1900]
"""All in one text: of the 200 kinds many are in every field at once."""
COUNT = """() => document.querySelectorAll('img, iframe, x-hostile, math, template, base, form[action], style, b,'
  + 'main script, a[href^="javascript"], [onerror], [onload]').length"""
"""Nodes that only a text can create."""


def hostile_state(text: str) -> Any:
    """Return a state with the text in every field that people, recipes or devices fill."""
    state = views.with_prompt(views.with_alarm(views.state()), text)
    assert state.run is not None
    run = replace(state.run, name=records.RUN, recipe=text, compound=text, note=text, operator=text, reason=text)
    [alarm] = state.alarms
    alarm = replace(alarm, name=text, text=text, unit=text, consequence=text)
    values = tuple(replace(value, label=text, unit=text) for value in state.values)
    return replace(state, mode=text, mode_text=text, rig=text, risk=text, run=run, alarms=(alarm,), values=values,
                   interrupted=(text,), progress=replace(state.progress, title=text, phase=text),
                   clients=replace(state.clients, controller=text))  # fmt: skip


def every_view(on: Front, page: Page) -> None:
    """Open every view and everything that opens in it."""
    for view in ("live", "map", "results", "replay", "queue", "paired"):
        on.go(page, view)
        page.wait_for_timeout(150)
        if view == "map":
            page.locator("[data-n='4']").click()
            expect(page.get_by_role("heading", name="Condition 4")).to_be_visible()
        if view == "results":
            page.get_by_role("button", name=records.RUN, exact=True).click()
            page.get_by_role("checkbox").first.check()
            page.get_by_role("checkbox").nth(1).check()
            page.get_by_role("button", name="Lay 2 runs over each other").click()
            page.get_by_text("The same in numbers").click()
            expect(page.get_by_role("region", name="Difference and ratio")).to_be_visible()
        assert page.evaluate(COUNT) == 0, view
        assert page.evaluate("window.__ran") is None, view


def test_two_hundred_hostile_texts_in_every_field_create_no_node(on: Front, desktop: BrowserContext) -> None:
    assert len(TEXTS) == 200
    page = on.paired(desktop, "control")
    on.call(lambda: on.stage.fake.show(hostile_state(ONE)))
    on.call(
        lambda: on.stage.fake.plan(
            replace(views.plan(), steps=tuple(replace(s, title=ONE) for s in views.plan().steps))
        )
    )
    on.played.text = ONE
    for text in TEXTS:
        on.call(lambda text=text: on.stage.fake.event(text, text, "warning"))
    expect(page.locator(".events li").first).to_contain_text(TEXTS[-1].replace("\x00", "")[:12])
    every_view(on, page)


def test_a_hostile_reason_of_a_refusal_is_shown_as_it_is(on: Front, desktop: BrowserContext) -> None:
    page = on.paired(desktop, "control")
    text = "<img src=x onerror=window.__ran=1>"
    on.stage.fake.refusals["hold"] = text
    on.call(lambda: on.stage.fake.show(views.state()))
    page.get_by_role("button", name="HOLD").click()
    expect(page.locator(".told")).to_contain_text(text)
    assert page.evaluate(COUNT) == 0
