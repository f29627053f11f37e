"""A real browser in front of the real page process; a test plays its service and its stored runs.

The page process and the service work in a thread of their own; the browser is driven from the test's. Chromium alone
is used: an installed one, found by name; the driver brings none.
"""

from __future__ import annotations

import asyncio
import os
import shutil
import threading
from collections.abc import Callable, Coroutine, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import pytest
from pydantic_core import to_json

import tester.page.page_process as process
from tester.page.desk_call import NewCode
from tester.page.front import PageQuestion
from tester.page.pairing import Pairing
from tester.page.questions import Questions
from tester.page.reception import AskError
from tester.page.roles import Role
from tests.tester.page.browser import records
from tests.tester.page.stage import PageStage

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

T = TypeVar("T")
FLAGS = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
)  # fmt: skip
NAMES = ("chromium", "chromium-browser", "google-chrome")
WATCH = """
window.__violations = [];
document.addEventListener('securitypolicyviolation', (event) =>
  window.__violations.push(event.violatedDirective + ' ' + event.blockedURI + ' ' + event.sample));
"""


def chromium() -> str:
    """Return the browser's path; skips the test where there is no browser or no driver."""
    pytest.importorskip("playwright", reason="the browser's driver is not installed: pip install '.[browser]'")
    path = next((found for name in NAMES if (found := shutil.which(name))), None)
    if path is None:
        pytest.skip(f"no browser on this machine: none of {', '.join(NAMES)}")
    return path


@contextmanager
def browser(home: Path | None = None) -> Iterator[Browser]:
    """Launch the browser. ``home``: the user's folder, None for the present user's."""
    path = chromium()
    from playwright.sync_api import sync_playwright

    environment: dict[str, str | float | bool] = {**os.environ}
    if home is not None:
        environment["HOME"] = str(home)
    with sync_playwright() as driver:
        launched = driver.chromium.launch(executable_path=path, args=list(FLAGS), env=environment)
        yield launched
        launched.close()


class Played:
    """Stored runs played by a test: answers by the question's name. ``asked`` keeps the questions."""

    def __init__(self) -> None:
        """Begin with seven runs of 165 conditions."""
        self.text = ""
        self.names = [records.RUN, *(f"2026-11-{day}T08-00-00-table-2" for day in range(10, 16))]
        self.states: dict[int, str] = {
            4: "doubtful",
            9: "refused",
            20: "excluded",
            150: "running",
            **dict.fromkeys(range(151, 166), "planned"),
        }
        self.samples = records.Samples(20_000, records.run()["t1_s"])
        self.asked: list[tuple[str, dict[str, Any]]] = []

    def answer(self, query: str, given: dict[str, Any]) -> Any:
        """Return the answer; raises AskError."""
        self.asked.append((query, given))
        match query:
            case "runs":
                return {
                    "runs": [records.listed(name, self.text) for name in self.names if given.get("text", "") in name]
                }
            case "run":
                return records.run(given["run"], states=self.states, text=self.text)
            case "condition":
                found = records.run()["conditions"][given["n"] - 1]
                return records.condition(given["n"], found["mu"], self.text)
            case "samples":
                return self.samples.window(given["columns"], given["from_s"], given["to_s"], given["points"])
            case "overlay":
                return records.overlay(given["runs"], given["against"], self.text)
            case "moment":
                at = float(given["t_s"])
                return {
                    "values": [
                        {"key": key, "label": self.text or label, "unit": unit, "value": value, "setpoint": setpoint}
                        for key, label, unit, value, setpoint in (
                            ("friction", "Friction mu", "", 0.7, None), ("load", "Load", "N", 0.01 * at, 200.0),
                        )
                    ],
                    "step": self.text or "1#, 50 mm/s, 100 N, 40 degC", "events": [],
                }  # fmt: skip
            case "ticket":
                return {"path": "/download/none"}
            case "exclude" | "note":
                return None
            case _:
                raise AskError(f"no question {query!r}")


class Front:
    """The page in a browser, and the service behind it. ``call`` runs something on the service's side."""

    def __init__(self, stage: PageStage, played: Played, loop: asyncio.AbstractEventLoop) -> None:
        """Take the parts; ``played`` answers about stored runs."""
        self.stage, self.played, self._loop = stage, played, loop
        self.elsewhere: list[str] = []
        self.errors: list[str] = []
        self._pages: list[Page] = []

    def wait(self, work: Coroutine[Any, Any, T]) -> T:
        """Run a coroutine on the service's side and return its result."""
        return asyncio.run_coroutine_threadsafe(work, self._loop).result(30.0)

    def call(self, work: Callable[[], T]) -> T:
        """Run a function on the service's side and return its result."""

        async def there() -> T:
            return work()

        return self.wait(there())

    def open(self, context: BrowserContext, view: str = "") -> Page:
        """Open the page, not paired; requests elsewhere and errors of scripts are kept."""
        page = context.new_page()
        page.add_init_script(WATCH)
        page.on("request", lambda request: self.elsewhere.append(request.url) if not self._own(request.url) else None)
        page.on("pageerror", lambda error: self.errors.append(str(error)))
        page.goto(f"{self.stage.origin}/{view}")
        self._pages.append(page)
        return page

    def _own(self, url: str) -> bool:
        own = self.stage.origin.removeprefix("http")
        return url.startswith((f"http{own}/", f"ws{own}/", "data:"))

    def pair(self, page: Page, role: Role, name: str = "Anna's phone") -> None:
        """Pair a page as a person does."""
        code = self.wait(self.stage.desk(NewCode(role))).code
        assert code is not None
        page.get_by_label("Code, six digits").fill(code.digits)
        page.get_by_label("Name of this device").fill(name)
        page.get_by_role("button", name="Pair", exact=True).click()
        page.locator("nav").wait_for(state="visible")

    def paired(self, context: BrowserContext, role: Role, view: str = "live") -> Page:
        """Open the page, paired, at a view."""
        page = self.open(context)
        self.pair(page, role)
        self.go(page, view)
        return page

    def go(self, page: Page, view: str) -> None:
        """Open a view by its link."""
        page.locator(f"nav a[href='#{view}']").click()

    def violations(self) -> list[str]:
        """Return what the content security policy refused, and errors of scripts."""
        return [
            text for page in self._pages if not page.is_closed() for text in page.evaluate("window.__violations")
        ] + self.errors


@contextmanager
def front(folder: Path, *, stored: bool = True, **options: Any) -> Iterator[Front]:
    """Serve the page. ``stored``: runs played by a test; by default those of the folder. ``options``:
    of the page process.
    """
    played = Played()
    patch = pytest.MonkeyPatch()

    async def told(_self: Questions, _pairing: Pairing, question: PageQuestion) -> bytes:
        return to_json(played.answer(question.query, question.rest))

    if stored:
        patch.setattr(process.Questions, "answer", told)
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever, daemon=True)
    thread.start()
    stage = PageStage(folder, **options)

    async def begin() -> None:
        await stage.__aenter__()

    async def end() -> None:
        await stage.__aexit__(None, None, None)

    try:
        asyncio.run_coroutine_threadsafe(begin(), loop).result(30.0)
        yield Front(stage, played, loop)
    finally:
        asyncio.run_coroutine_threadsafe(end(), loop).result(30.0)
        loop.call_soon_threadsafe(loop.stop)
        thread.join(10.0)
        loop.close()
        patch.undo()
