"""Pages in browsers on the operator's screen: codes, pairings, and the code that an action needs."""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from tester.page.desk_call import DeskView
from tester.tui.app import TesterApp
from tester.tui.dialogs.pages_dialog import NO_PAGE, PagesDialog, clean_rows
from tester.tui.host import TuiOptions
from tests.tester.page.stage import Browser, PageStage
from tests.tester.tui.stage import screen_text

pytestmark = pytest.mark.skipif(os.name != "posix", reason="the fake service listens at a Unix socket")
WAIT_S = 60.0


async def until(true: Callable[[], bool]) -> None:
    async with asyncio.timeout(WAIT_S):
        while not true():
            await asyncio.sleep(0.02)


def dialog_text(app: TesterApp) -> str:
    return screen_text(app)


def test_a_person_makes_a_code_sees_the_page_and_ends_it(tmp_path: Path) -> None:
    async def story() -> None:
        async with PageStage(tmp_path) as stage:
            app = TesterApp(TuiOptions(address=stage.fake.address))
            async with app.run_test(size=(100, 30)) as pilot:
                await pilot.press("b")
                await until(lambda: isinstance(app.screen, PagesDialog) and "code" in dialog_text(app))
                await pilot.press("c")
                await until(lambda: "pairs one page: control" in dialog_text(app))
                code = (await stage.desk()).code
                assert code is not None and code.digits in dialog_text(app)
                page: Browser = await stage.browser()
                await page.send(type="pair", code=code.digits, name="Anna's phone")
                await page.until("paired")
                await until(lambda: "Anna's phone" in dialog_text(app))
                await pilot.press("delete")
                assert "revoked" in (await page.until("bye"))["reason"]
                await until(lambda: "Anna's phone" not in dialog_text(app))

    asyncio.run(story())


def test_the_code_that_an_action_needs_appears_on_any_screen(tmp_path: Path) -> None:
    async def story() -> None:
        async with PageStage(tmp_path) as stage:
            app = TesterApp(TuiOptions(address=stage.fake.address))
            async with app.run_test(size=(120, 40)) as pilot:
                await pilot.press("f5")
                page = await stage.paired("control")
                assert (await page.command({"command": "ack"}))["reason"].startswith("code:")
                (code,) = (await stage.desk()).asked
                await until(lambda: code.digits in dialog_text(app))

    asyncio.run(story())


def test_a_screen_for_everybody_shows_no_codes(tmp_path: Path) -> None:
    async def story() -> None:
        async with PageStage(tmp_path) as stage:
            app = TesterApp(TuiOptions(address=stage.fake.address, view_only=True))
            async with app.run_test(size=(100, 30)) as pilot:
                await pilot.press("b")
                await pilot.pause()
                assert not isinstance(app.screen, PagesDialog)
                code = (await stage.desk()).code
                assert code is not None and code.digits not in dialog_text(app)

    asyncio.run(story())


def test_without_a_page_the_dialog_shows_how_to_open_one() -> None:
    assert clean_rows(None) == NO_PAGE


def test_texts_of_a_page_steer_no_terminal() -> None:
    view = DeskView("http://127.0.0.1:8010/\x1b[2J", ("look",), None, (), ())
    assert "\x1b" not in clean_rows(view)
