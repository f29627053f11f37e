"""`tester replay`: the screens for a stored run, with a time slider. There is no rig and no service."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from pydantic import JsonValue
from textual.binding import Binding, BindingType
from textual.widget import Widget

from tester.base.words import duration
from tester.tui.app import TesterApp
from tester.tui.host import Keys, TuiOptions, View
from tester.tui.pages.results_page import ResultsView
from tester.tui.pages.ring_page import RingPage
from tester.tui.pages.run_page import RunPage
from tester.tui.playback import Playback
from tester.tui.screen_scene import ScreenScene
from tester.tui.stored import Stored
from tester.tui.widgets.head import RING, TABS, Tabs
from tester.tui.widgets.panel_base import FAINT, Panel, Parts

FRAME_S = 0.25
SPEEDS = (1.0, 10.0, 60.0, 600.0)
"""Rig seconds per second while it plays."""
HELP = """\

In a replay
space  play, pause      left, right  10 s back, on      shift+left, shift+right  1 min
page up, page down  10 min      home, end  begin, end      s  faster (1, 10, 60, 600 times)
"""


class TimeLine(Panel):
    """The time slider."""

    at_s = 0.0
    length_s = 0.0
    playing = False
    speed = 60.0

    def picture(self, scene: ScreenScene, width: int, height: int) -> Parts:
        """Return the slider."""
        words = f" {'▶' if self.playing else '‖'} {duration(self.at_s)} / {duration(self.length_s)}  x{self.speed:g} "
        keys = " Home End PgUp PgDn "
        room = width - len(words) - len(keys)
        if room < 5:
            return [words[:width]]
        done = round(self.at_s / max(self.length_s, 1e-9) * (room - 1))
        return [words, ("━" * done, "bold"), "●", ("─" * (room - 1 - done), FAINT), (keys, FAINT)]


class ReplayApp(TesterApp):
    """Shows a run at any moment of its time."""

    FIRST = "run"
    SCREENS_HERE: ClassVar[Tabs] = tuple(tab for tab in TABS if tab[2] in ("run", "results", RING))
    EVERYWHERE = HELP
    HAS_RIG: ClassVar[bool] = False
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("left", "seek(-10)", "Back", show=False),
        Binding("right", "seek(10)", "On", show=False),
        Binding("shift+left", "seek(-60)", "Back", show=False),
        Binding("shift+right", "seek(60)", "On", show=False),
        Binding("pageup", "seek(-600)", "Back", show=False),
        Binding("pagedown", "seek(600)", "On", show=False),
        Binding("home", "seek(-1e9)", "Begin", show=False),
        Binding("end", "seek(1e9)", "End", show=False),
        Binding("s", "faster", "Faster", show=False),
    ]

    def __init__(self, playback: Playback, stored: Stored, *, plain: bool = False, theme: str = "") -> None:
        """``playback``, ``stored``: the run's record and its table."""
        super().__init__(TuiOptions(plain=plain, start=False, theme=theme, runs=Path(stored.folder).parent))
        self.playback, self.stored = playback, stored
        self.scene.table = stored
        self.at_s = 0.0
        self.playing = False
        self.speed = 60.0

    def views(self) -> Iterable[View]:
        """Return the screens for which a record has data."""
        yield RunPage(plain=self.options.plain, id="run")
        yield ResultsView(id="results")
        yield RingPage(id=RING)

    def below(self) -> Iterable[Widget]:
        """Return the slider, which is above the last line."""
        yield TimeLine(id="time")

    def keys_of(self, view: View) -> Keys:
        """Return the keys of a replay."""
        if isinstance(view, RingPage):
            view_keys: Keys = (("n", "New ring"),)
        else:
            view_keys = (("p", "Plot"), ("e", "Export")) if isinstance(view, ResultsView) else (("l", "Log"),)
        return (("space", "Play"), ("←→", "10 s"), ("s", "Faster"), *view_keys, ("F1", "Help"), ("q", "Leave"))

    def connect(self) -> None:
        """Show the run's beginning."""
        results = self.query_one(ResultsView)
        results.fill([self._line_of_runs()])
        results.open(self.stored)
        self.action_seek(0.0)
        self.set_interval(FRAME_S, self._tick)

    def _line_of_runs(self) -> dict[str, JsonValue]:
        """Return the run as `tester runs --json` lists it."""
        run = self.playback.run
        return {
            "run": self.stored.name,
            "recipe": self.stored.recipe,
            "status": self.stored.status,
            "values": self.stored.values,
            "conditions": self.stored.conditions,
            "rig_seconds": run.rig_seconds,
            "started_utc": run.info.started_utc,
        }

    def _tick(self) -> None:
        if self.playing:
            self.action_seek(self.speed * FRAME_S)
            self.playing = self.at_s < self.playback.length_s

    def action_seek(self, by_s: float) -> None:
        """Move forward or back by rig seconds."""
        self.at_s = min(max(self.at_s + by_s, 0.0), self.playback.length_s)
        self.playback.show(self.scene, self.at_s)
        self._show_time()
        self.scene_changed()

    def _show_time(self) -> None:
        line = self.screen_stack[0].query_one(TimeLine)
        line.at_s, line.length_s = self.at_s, self.playback.length_s
        line.playing, line.speed = self.playing, self.speed
        line.show(self.scene)

    def action_hold(self) -> None:
        """Play, or pause the replay."""
        self.playing = not self.playing
        self._show_time()

    def action_faster(self) -> None:
        """Play at the next speed."""
        self.speed = SPEEDS[(SPEEDS.index(self.speed) + 1) % len(SPEEDS)]
        self._show_time()

    def action_stop(self) -> None:
        """Report that there is nothing to stop in a replay."""
        self.say("a replay has no rig: `tester stop` stops one", problem=True)

    def action_abort(self) -> None:
        self.action_stop()

    def action_resume(self) -> None:
        self.action_stop()

    def action_acknowledge(self) -> None:
        self.action_stop()

    def action_detach(self) -> None:
        """Leave the replay."""
        self.exit("")
