"""Files and downloads over HTTP."""

from __future__ import annotations

from pathlib import Path

from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from tester.page.answers import MOST_TICKETS, TICKET_S, Download, File, Tickets, answer_file, static_files


def folder(at: Path) -> Path:
    (at / "js").mkdir()
    (at / "index.html").write_text("<!doctype html>")
    (at / "js" / "live.js").write_text("export {}")
    (at / "notes.rst").write_text("not for browsers")
    (at / "js" / "LICENSE").write_text("MIT")
    return at


def get(path: str, files: dict[str, File], tickets: Tickets | None = None, **headers: str) -> Response:
    named = Headers([(name.replace("_", "-"), value) for name, value in headers.items()])
    return answer_file(Request(path, named), files, tickets or Tickets())


def test_files_are_served_by_their_path_below_the_folder(tmp_path: Path) -> None:
    files = static_files(folder(tmp_path))
    assert set(files) == {"/", "/static/index.html", "/static/js/live.js", "/static/js/LICENSE"}
    assert get("/", files).body == b"<!doctype html>"
    assert get("/static/js/live.js?v=1", files).headers["Content-Type"] == "text/javascript; charset=utf-8"


def test_nothing_outside_the_list_is_served(tmp_path: Path) -> None:
    files = static_files(folder(tmp_path))
    (tmp_path / "later.js").write_text("later")
    for path in ("/static/later.js", "/static/../answers.py", "/static/%2e%2e/x", "//static/index.html", "/notes.rst"):
        assert get(path, files).status_code == 404


def test_a_file_that_the_browser_has_is_not_sent_again(tmp_path: Path) -> None:
    files = static_files(folder(tmp_path))
    first = get("/", files)
    assert first.headers["Cache-Control"] == "no-cache"
    again = get("/", files, If_None_Match=first.headers["ETag"])
    assert (again.status_code, again.body) == (304, b"")


def test_a_ticket_is_good_once() -> None:
    tickets = Tickets()
    path = tickets.issue(Download("run.csv", "text/csv", b"a,b\r\n"))
    first = get(path, {}, tickets)
    assert (first.body, first.headers["Content-Disposition"]) == (b"a,b\r\n", 'attachment; filename="run.csv"')
    assert first.headers["Cache-Control"] == "no-store"
    assert get(path, {}, tickets).status_code == 404


def test_a_ticket_ends_after_its_time() -> None:
    now = [0.0]
    tickets = Tickets(lambda: now[0])
    path = tickets.issue(Download("run.csv", "text/csv", b""))
    now[0] = TICKET_S
    assert get(path, {}, tickets).status_code == 404


def test_only_so_many_downloads_wait() -> None:
    tickets = Tickets()
    paths = [tickets.issue(Download(f"{n}.csv", "text/csv", b"")) for n in range(MOST_TICKETS + 1)]
    assert [get(path, {}, tickets).status_code for path in paths].count(404) == 1
    assert get(paths[0], {}, tickets).status_code == 404
