"""Where tables of laws are kept."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tester.base.user_folders import CACHE, cache_folder
from tester.inputs.materials.setting import law_setting


@pytest.mark.parametrize(
    ("platform", "environment", "expected"),
    [
        ("linux", {"XDG_CACHE_HOME": "/caches"}, "/caches/friction-tester"),
        ("linux", {}, "/home/somebody/.cache/friction-tester"),
        ("darwin", {"XDG_CACHE_HOME": "/caches"}, "/home/somebody/Library/Caches/friction-tester"),
        ("win32", {"LOCALAPPDATA": "/local"}, "/local/friction-tester"),
        ("win32", {}, "/home/somebody/AppData/Local/friction-tester"),
        ("linux", {CACHE: "/own", "XDG_CACHE_HOME": "/caches"}, "/own"),
    ],
)
def test_tables_are_kept_among_the_users_caches(
    monkeypatch: pytest.MonkeyPatch, platform: str, environment: dict[str, str], expected: str
) -> None:
    for name in (CACHE, "XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(sys, "platform", platform)
    monkeypatch.setattr(Path, "home", lambda: Path("/home/somebody"))
    own = Path("/own") if CACHE in environment else Path(expected)
    assert cache_folder() == own
    assert law_setting("S0").tables == own / "laws"
