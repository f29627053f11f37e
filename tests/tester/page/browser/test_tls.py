"""`tester page --lan` in a real browser: it loads over TLS only where the browser trusts the authority.

The browser trusts its user's certificate store, which certutil makes in the test's folder.
"""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from tester.service.commands import Hold
from tester.service.stop_lane import StopLane
from tests.tester.page.browser.stage import Front, browser, chromium, front
from tests.tester.page.test_lan import ELSEWHERE, LAN, Authority, needs_second

pytest.importorskip("playwright", reason="the browser's driver is not installed: pip install '.[browser]'")
from playwright.sync_api import Error, expect

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext, Page

pytestmark = [
    needs_second,
    pytest.mark.skipif(shutil.which("certutil") is None, reason="no certutil: apt-get install libnss3-tools"),
]


def home_that_trusts(folder: Path, authority: Authority) -> Path:
    """Make a user's folder whose certificate store trusts an authority."""
    store, file = folder / ".pki" / "nssdb", folder / "authority.pem"
    store.mkdir(parents=True)
    authority.ca.cert_pem.write_to_path(str(file))
    for words in (["-N", "--empty-password"], ["-A", "-t", "C,,", "-n", "laboratory", "-i", str(file)]):
        subprocess.run(["certutil", "-d", f"sql:{store}", *words], check=True, capture_output=True)
    return folder


@contextmanager
def laboratory(folder: Path, trusted: Authority, used: Authority) -> Iterator[tuple[Front, BrowserContext]]:
    """Serve the page with a certificate; yield it, and a browser that trusts an authority."""
    chromium()  # skips before anything is begun
    home = home_that_trusts(folder / "home", trusted)
    with front(folder, lan=LAN, certificate=used.certificate, key=used.key) as on, browser(home) as launched:
        context = launched.new_context(viewport={"width": 400, "height": 800})
        context.set_default_timeout(10_000)
        yield on, context


def reached(on: Front, page: Page, address: str = "") -> str:
    """Open an address of the page, by default its own; return the browser's error, "" for none."""
    try:
        page.goto(address or f"{on.stage.origin}/")
    except Error as error:
        return error.message
    return ""


def test_a_browser_that_trusts_the_authority_pairs_holds_and_stops(tmp_path: Path) -> None:
    authority = Authority(tmp_path)
    with laboratory(tmp_path, authority, authority) as (on, context):
        page = on.paired(context, "control")
        assert page.url.startswith(f"https://{LAN}:") and page.evaluate("window.isSecureContext")
        expect(page.locator(".drawing")).to_contain_text("199.6")  # over the socket
        page.get_by_role("button", name="HOLD").click()
        expect(page.get_by_text("Held: lifted")).to_be_visible()
        assert on.stage.fake.orders[-1].action == Hold()
        lane = StopLane()
        lane.open(on.stage.fake.address)
        try:
            page.get_by_role("button", name="STOP").click()
            expect(page.locator(".stop-told")).to_have_text("STOP taken")
            assert lane.taken()
        finally:
            lane.close()
        page.reload()
        expect(page.get_by_role("button", name="STOP")).to_be_visible()  # the pairing is kept
        assert on.elsewhere == [] and on.violations() == []


def test_a_browser_that_does_not_trust_it_shows_nothing_of_the_page(tmp_path: Path) -> None:
    with laboratory(tmp_path, Authority(tmp_path, ELSEWHERE), Authority(tmp_path)) as (on, context):
        page = context.new_page()
        assert "ERR_CERT_AUTHORITY_INVALID" in reached(on, page)
        assert page.get_by_label("Code, six digits").count() == 0


def test_a_certificate_for_another_address_is_refused(tmp_path: Path) -> None:
    authority = Authority(tmp_path, ELSEWHERE)
    with laboratory(tmp_path, authority, authority) as (on, context):
        assert "ERR_CERT_COMMON_NAME_INVALID" in reached(on, context.new_page())


def test_nothing_is_shown_in_the_clear(tmp_path: Path) -> None:
    authority = Authority(tmp_path)
    with laboratory(tmp_path, authority, authority) as (on, context):
        assert "ERR_" in reached(on, context.new_page(), f"http://{LAN}:{on.stage.port}/")
