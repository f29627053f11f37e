"""A run whose process ends in the middle of its second repeat, as the store sees it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.writer import RunWriter
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT
from tests.tester.run.test_session import Screen

TEXT = (
    SHORT.replace("repeats: 1", "repeats: 3")
    .replace("window: 14 rev", "window: 8 rev\n  temperature_band: 4 degC")
    .replace("temperature: 25 degC", "temperature: 24 degC")
    .replace("load: 200 N", "load: 50 N")
)
SETS = (*QUIET, "sim.friction_heat_fraction=0")


class StoppedError(Exception):
    """The process ends here."""


def cut_short(home: Path, text: str = TEXT, sets: Sequence[str] = SETS) -> Path:
    """Run ``short.yaml`` of this text in a folder until it dies; return the run's folder, the only one in ``runs``."""
    (home / "short.yaml").write_text(text, encoding="utf-8")
    begin = RunWriter.begin_repeat

    def dying(self: RunWriter, condition: int, repeat: int, *rest: float, **more: int) -> int:
        key = begin(self, condition, repeat, *rest, **more)  # type: ignore[arg-type]
        if repeat == 2:
            self.flush()
            raise StoppedError
        return key

    with pytest.MonkeyPatch.context() as patch:
        patch.delenv("TESTER_MATERIALS", raising=False)
        patch.setattr(RunWriter, "begin_repeat", dying)
        options = SessionOptions(recipe=str(home / "short.yaml"), out=home / "runs", overrides=tuple(sets), seed=3)
        with pytest.raises(StoppedError):
            Session(options, Screen()).run()
    (folder,) = (home / "runs").iterdir()
    return folder
