"""One browser for the tests of a file, and the page in front of a played service."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tests.tester.page.browser.stage import Front, browser, front

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext

SIZES = {400: 800, 1280: 900, 3840: 2160}
"""Widths and heights at which the page must be good, CSS pixels."""


@pytest.fixture(scope="module")
def chrome() -> Iterator[Browser]:
    """The browser; skips where there is none."""
    with browser() as launched:
        yield launched


@pytest.fixture
def on(tmp_path: Path, chrome: Browser) -> Iterator[Front]:
    """The page in front of a played service. Afterwards: nothing was loaded from elsewhere or refused by the policy."""
    del chrome  # skips before anything is begun
    with front(tmp_path) as served:
        yield served
        assert served.elsewhere == []
        assert served.violations() == []


@pytest.fixture
def desktop(chrome: Browser) -> Iterator[BrowserContext]:
    """A window of 1280 x 900."""
    context = chrome.new_context(viewport={"width": 1280, "height": 900})
    context.set_default_timeout(10_000)
    yield context
    context.close()


@pytest.fixture
def phone(chrome: Browser) -> Iterator[BrowserContext]:
    """A telephone."""
    context = chrome.new_context(viewport={"width": 400, "height": 800}, has_touch=True)
    context.set_default_timeout(10_000)
    yield context
    context.close()
