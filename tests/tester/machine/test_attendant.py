"""The attendant of a real rig does nothing on any request."""

from __future__ import annotations

from copy import deepcopy

import pytest

from tester.machine.run_parts import NoAttendant


def test_whatever_a_kind_asks_nothing_happens() -> None:
    hands = NoAttendant()
    assert hands.install(1, 2, "SBR", new_specimen=True) is None
    assert hands.begin_repeat(1, 1, 1) is None


def test_it_can_be_copied_and_has_no_hidden_names() -> None:
    assert isinstance(deepcopy(NoAttendant()), NoAttendant)
    with pytest.raises(AttributeError, match="_hidden"):
        NoAttendant()._hidden  # noqa: B018
