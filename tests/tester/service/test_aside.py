"""Work beside the owner's loop."""

from __future__ import annotations

from threading import Event, current_thread

import pytest

from tester.service.aside import aside


def test_clients_are_looked_after_until_the_work_is_done() -> None:
    enough, looks = Event(), list[str]()

    def look() -> None:
        looks.append(current_thread().name)
        if len(looks) == 3:
            enough.set()

    assert aside(lambda: enough.wait(60.0), look)
    assert len(looks) >= 3 and set(looks) == {current_thread().name}


def test_what_goes_wrong_in_the_work_is_raised_here() -> None:
    with pytest.raises(ZeroDivisionError):
        aside(lambda: 1 // 0, lambda: None)
