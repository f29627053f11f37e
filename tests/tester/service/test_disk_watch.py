from __future__ import annotations

from pathlib import Path
from threading import Event

import pytest

from tests.tester.service.stage import Script, Stage, play


def test_a_disk_that_hangs_holds_up_no_state_and_is_an_alarm(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    answer = Event()

    def hang(_folder: Path) -> int:
        answer.wait()
        return 1

    monkeypatch.setattr("tester.service.disk_watch.FreeRoom.__init__.__defaults__", (hang,))
    monkeypatch.setattr("tester.service.disk_watch.FIRST_S", 0.0)
    monkeypatch.setattr("tester.service.disk_watch.EVERY_S", 0.0)
    monkeypatch.setattr("tester.service.state_publisher.SNAPSHOT_S", 0.0)

    def script(stage: Stage) -> Script:
        yield from stage.until(lambda view: any(alarm.name == "disk silent" for alarm in view.alarms))
        assert stage.views[-1].disk.free is None
        answer.set()
        yield from stage.until(lambda view: view.disk.free == 1)

    play(tmp_path, script)
