from __future__ import annotations

import pytest

from tester.base import who


def test_a_person_and_a_computer_are_named_plainly(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(who, "user", lambda: "ada")
    monkeypatch.setattr(who.platform, "node", lambda: "lab-pc.example.org")
    assert who.who_here("screen") == "ada at lab-pc (screen)"


def test_a_hostile_name_is_one_harmless_line_of_bounded_length(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(who, "user", lambda: "\x1b[31m a\nb" + "x" * 500)
    monkeypatch.setattr(who.platform, "node", lambda: "")
    found = who.who_here("command")
    assert found.startswith("?[31m a bx") and found.endswith(" at this computer (command)") and len(found) < 200
