"""Runs that record their display: the time left, the printed list's sum, the counts."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Final, NamedTuple

from tester.machine.context import Progress
from tester.machine.time_left import RunPosition
from tester.run.endings import StopLevel
from tester.run.folder import Work, earlier_of, parts_time
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.service.state_view import ProgressView
from tester.service.values import PlanTrack
from tester.store.run_reader import RunReader
from tester.tui.pages.run_page import StepsPanel
from tester.tui.playback import load
from tester.tui.screen_scene import ScreenScene
from tester.tui.widgets.head import StateLine
from tester.tui.widgets.panel_base import Parts
from tests.campaigns.compiled.worker import Silent
from tests.tester.service.views import state

EVERY_S: Final = 5.0
"""Interval between looks at a run, rig seconds."""
ROWS: Final = 12
"""Rows of the list of steps to add up."""
_LATER = re.compile(r"~(\d+):(\d\d):(\d\d)")
_HEAD = re.compile(r"(?:(\d+)/(\d+) done.*)?left (\d+):(\d\d):(\d\d)")


class Look(NamedTuple):
    """A look at a moment: rig seconds of the run, and the screen's output, s and conditions."""

    t_s: float
    left_s: float
    listed_s: float
    over: int
    conditions: int


class Looked(NamedTuple):
    """An observed run: its rig seconds, the end of each of its conditions, and the looks."""

    name: str
    took_s: float
    ended_s: tuple[float, ...]
    looks: tuple[Look, ...]
    outcome: str


def printed(scene: ScreenScene) -> tuple[float, float, int, int] | None:
    """Return the screens' output: time left of the head and of the list, s; conditions finished and in all."""
    head = _HEAD.search(_text(StateLine().picture(scene, 300, 1)))
    if head is None:
        return None
    listed = _LATER.findall(_text(StepsPanel().picture(scene, 100, ROWS)))
    return _seconds(head.groups()[2:]), sum(map(_seconds, listed)), int(head[1] or 0), int(head[2] or 0)


def _text(parts: Parts) -> str:
    return "".join(one if isinstance(one, str) else one[0] for one in parts)


def _seconds(clock: Sequence[str]) -> float:
    hours, minutes, seconds = map(int, clock)
    return 3600.0 * hours + 60.0 * minutes + seconds


class Observer(Silent):
    """A screen that records a run's output, and optionally stops the run after a share of it."""

    def __init__(self, stop_at: float = 1.0) -> None:
        super().__init__()
        self.looks: list[Look] = []
        self.session: Observed | None = None
        self._stop_at = stop_at
        self._before_s, self._last_s, self._part, self._due_s = 0.0, 0.0, 1, 0.0

    def show(self, now_s: float, run: Progress, at: RunPosition) -> None:
        """Record it."""
        if at.part != self._part:
            self._before_s, self._part, self._due_s = self._before_s + self._last_s, at.part, 0.0
        self._last_s = now_s
        session = self.session
        assert session is not None
        if now_s < self._due_s or at.left_s is None or not isinstance(session.track, PlanTrack):
            return
        self._due_s = now_s + EVERY_S
        view = ProgressView(step=at.step, steps=at.steps, over=at.over, conditions=at.conditions, left_s=at.left_s,
                            step_left_s=at.step_left_s)  # fmt: skip
        scene = ScreenScene(now=lambda: 0.0)
        scene.state, scene.plan = replace(state(), progress=view), session.track.view()
        seen = printed(scene)
        if seen is not None:
            self.looks.append(Look(self._before_s + now_s, *seen))
        if at.share >= self._stop_at:
            self._stop_at = 2.0
            session.stop(StopLevel.INTERRUPTED)


class Observed(Session):
    """A session observed through the messages to a client of the service."""

    def tracked(self, work: Work) -> PlanTrack:
        """Return the count of its steps with the words of a screen."""
        return PlanTrack(work.plan.name, parts_time(work), earlier_of(work.point))


def carry_out(recipe: str, rig: str, overrides: tuple[str, ...], seed: int, folder: Path) -> Looked:
    """Run a recipe on a simulated rig to its end."""
    screen = Observer()
    session = screen.session = Observed(_options(recipe, rig, overrides, seed, folder), screen)
    session.run()
    assert session.folder is not None, " ".join(screen.messages)
    return _looked("run", session.folder, screen, 0.0)


def interrupted(recipe: str, rig: str, overrides: tuple[str, ...], seed: int, folder: Path) -> tuple[Looked, Looked]:
    """Stop a run at a drawn share and resume it; return the looks of its second stretch, and of a replay."""
    share = Random(f"stop {seed}").uniform(0.3, 0.8)
    first = Observer(share)
    session = first.session = Observed(_options(recipe, rig, overrides, seed, folder), first)
    session.run()
    assert session.folder is not None, " ".join(first.messages)
    with RunReader(session.folder) as reader:
        origin_s = reader.run().rig_seconds
    second = Observer()
    session_2 = second.session = Observed(_options(recipe, rig, overrides, seed, folder), second)
    session_2.resume(session.folder)
    return _looked("resumed", session.folder, second, origin_s), replayed(session.folder)


def replayed(folder: Path) -> Looked:
    """Return the looks of a replay of a run."""
    playback, scene = load(folder), ScreenScene(now=lambda: 0.0)
    looks: list[Look] = []
    for part in range(1, 100):
        at_s = playback.length_s * part / 100.0
        playback.show(scene, at_s)
        seen = printed(scene)
        if seen is not None:
            looks.append(Look(at_s, *seen))
    return Looked("replay", playback.length_s, _ended(folder), tuple(looks), playback.status)


def in_a_folder(recipe: str, rig: str, overrides: tuple[str, ...], seed: int, *, cut: bool) -> list[Looked]:
    """Run a recipe in a folder of its own, whole and then replayed; with ``cut`` stopped, resumed and replayed."""
    with TemporaryDirectory(prefix="time-left-", ignore_cleanup_errors=True) as name:
        path = Path(name) / "recipe.yaml"
        path.write_text(recipe, encoding="utf-8")
        if cut:
            return [*interrupted(str(path), rig, overrides, seed, Path(name) / "runs")]
        return [carry_out(str(path), rig, overrides, seed, Path(name) / "runs")]


def _options(recipe: str, rig: str, overrides: tuple[str, ...], seed: int, folder: Path) -> SessionOptions:
    return SessionOptions(recipe, rig, overrides, out=folder, seed=seed, samples=False)


def _looked(name: str, folder: Path, screen: Observer, origin_s: float) -> Looked:
    with RunReader(folder) as reader:
        run = reader.run()
    looks = tuple(one._replace(t_s=one.t_s + origin_s) for one in screen.looks)
    return Looked(name, run.rig_seconds, _ended(folder), looks, run.status or "")


def _ended(folder: Path) -> tuple[float, ...]:
    with RunReader(folder) as reader:
        return tuple(sorted(one.ended_s for one in reader.conditions()))
