"""Who may look at the screen in a browser."""

from __future__ import annotations

import asyncio

import pytest

from tester.tui.web import application, is_own


@pytest.mark.parametrize(
    ("host", "origin", "own"),
    [
        ("127.0.0.1:8000", None, True),
        ("localhost:8000", "http://localhost:8000", True),
        ("LOCALHOST:8000", "http://127.0.0.1:8000", True),
        ("rebound.example:8000", None, False),
        ("127.0.0.1:8000", "http://rebound.example:8000", False),
        ("127.0.0.1:8000", "null", False),
        ("127.0.0.1:8001", None, False),
        ("127.0.0.1", None, False),
        ("", None, False),
    ],
)
def test_a_request_is_ours_by_its_host_and_origin(host: str, origin: str | None, own: bool) -> None:
    assert is_own(host, origin, 8000) is own


def test_a_browser_leaves_out_the_usual_port() -> None:
    assert is_own("localhost", "http://localhost", 80)


@pytest.mark.parametrize("path", ["/", "/ws", "/static/js/textual.js", "/download/x"])
def test_textual_serve_answers_no_request_of_another_host(path: str) -> None:
    pytest.importorskip("textual_serve", reason="extra: web")
    from aiohttp.test_utils import TestClient, TestServer

    async def ask() -> tuple[int, int]:
        async with TestClient(TestServer(await application(8000, ""))) as client:
            foreign = await client.get(path, headers={"Host": "rebound.example:8000"})
            page = await client.get("/", headers={"Host": "127.0.0.1:8000"})
            return foreign.status, page.status

    assert asyncio.run(ask()) == (403, 200)
