"""`tester tui`: the fixed lines, the screens between them, and the keys that work on every screen."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Iterable
from typing import ClassVar, Final

from textual.app import ComposeResult, SuspendNotSupported, SystemCommand
from textual.binding import Binding, BindingType
from textual.events import Resize
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import ContentSwitcher

from tester.base import clock
from tester.base.processes import tester_command
from tester.base.source import InvalidSource
from tester.run.kind_lookup import load_rig
from tester.service.commands import Acknowledge, Hold, ListRuns, Release, TakeControl
from tester.service.state_view import RunView, StateView
from tester.tui.dialogs.confirm import AbortDialog, EndServiceDialog, GoOnDialog, ResumeDialog, resumable
from tester.tui.dialogs.dialog import Dialog, TextDialog
from tester.tui.dialogs.pages_dialog import PagesDialog, watch_pages
from tester.tui.gone import TITLE, SmallPanel, death_text
from tester.tui.host import HostApp, Keys, TuiOptions, View
from tester.tui.pages.bus import BusPage
from tester.tui.pages.manual_page import ManualPage
from tester.tui.pages.queue_page import QueuePage
from tester.tui.pages.recipes import RecipesView
from tester.tui.pages.results_page import ResultsView
from tester.tui.pages.ring_page import RingPage
from tester.tui.pages.run_page import RunPage as RunScreen
from tester.tui.screen_scene import UNDER_WAY
from tester.tui.theme import THEMES
from tester.tui.widgets.head import RING, TABS, KeyLine, StateLine, TabLine, Tabs
from tester.tui.widgets.said import SaidLines

FREE: Final = ("OFFLINE", "IDLE", "INTERRUPTED")
"""Modes of a service that is not using the rig: it locks the buses only for a run or manual mode."""


def begins_here(options: TuiOptions, state: StateView) -> bool:
    """Return whether this screen's rig is the service's."""
    try:
        return options.address is None and load_rig(options.rig).name == state.rig
    except (InvalidSource, OSError):
        return False


def commission_rig(options: TuiOptions) -> None:
    """Run commissioning, which takes over the terminal, and return when it ends."""
    command = tester_command("commission", options.rig, "--tui", "--out", str(options.runs))
    command += ["--ascii"] if options.plain else []
    command += ["--theme", options.theme] if options.theme else []
    subprocess.run(command, check=False)


EVERYWHERE = """\

On every screen
F12, Ctrl+X  STOP: controlled software stop, at once, no question. Not an emergency stop: that is hardware.
F9, Ctrl+F   FAST STOP: quick stop of both drives, the same way; latched until acknowledged.
F2 … F8      the screens.   Ctrl+P  all commands.   F1  this help.   Esc  closes a dialog.
space  HOLD    r  resume    x  abort…    a  acknowledge
q, Ctrl+C    detach: the run continues; `tester tui` comes back.
"""


class TesterApp(HostApp):
    """The operator's screen."""

    TITLE = "friction-tester"
    FIRST: ClassVar[str] = "recipes"
    """The screen shown first."""
    EVERYWHERE: ClassVar[str] = EVERYWHERE
    SCREENS_HERE: ClassVar[Tabs] = TABS
    BINDINGS: ClassVar[list[BindingType]] = [
        *(Binding(key, f"go_to('{name}')", title, show=False) for key, title, name in TABS),
        Binding("f1", "help", "Help", show=False),
        Binding("space", "hold", "Hold", show=False),
        Binding("r", "resume", "Resume", show=False),
        Binding("x", "abort", "Abort", show=False),
        Binding("a", "acknowledge", "Acknowledge", show=False),
        Binding("q", "detach", "Detach", show=False),
    ]

    def __init__(self, options: TuiOptions, now: Callable[[], float] = clock.monotonic) -> None:
        """Build the screens; options as for HostApp."""
        super().__init__(options, now)
        self._entered: View | None = None
        self._settled = False
        """Whether the first screen has been chosen, by a run under way or by a person."""

    # -- layout -----------------------------------------------------------------------------------------------

    def compose(self) -> ComposeResult:
        """Lay out the fixed lines and the screens."""
        yield StateLine(id="state")
        yield TabLine(id="tabs")
        with ContentSwitcher(initial=self.FIRST, id="views"):
            yield from self.views()
        yield SmallPanel(id="tiny")
        yield SaidLines()
        yield from self.below()
        yield KeyLine(id="keys")

    def below(self) -> Iterable[Widget]:
        """Return the widgets above the last line."""
        return ()

    def views(self) -> Iterable[View]:
        """Return the screens."""
        yield RecipesView(id="recipes")
        yield RunScreen(plain=self.options.plain, id="run")
        yield ManualPage(id="manual")
        yield ResultsView(id="results")
        yield BusPage(id="bus")
        yield RingPage(id=RING)
        yield QueuePage(id="queue")

    def on_mount(self) -> None:
        """Connect to the service."""
        self.choose_colours()
        self.query_one(TabLine).tabs = self.SCREENS_HERE
        self.go_to(self.FIRST)
        self.connect()
        if self.HAS_RIG and not self.options.view_only:  # a screen for everybody shows no codes
            self.run_worker(watch_pages(self), name="pages", group="pages", exit_on_error=False)

    def on_resize(self, event: Resize) -> None:
        """Lay out for the new size, because Textual itself adopts it only later."""
        self.size_classes(event, "-tiny")

    @property
    def view(self) -> View:
        """Return the screen on display."""
        base = self.screen_stack[0]
        switcher = base.query_one(ContentSwitcher)
        return base.query_one(f"#{switcher.current}", View)

    def scene_changed(self) -> None:
        """Redraw the fixed lines and the screen on display."""
        base = self.screen_stack[0] if self.screen_stack else None
        if base is None or not base.query("#keys"):
            return  # before the first layout, or during shutdown
        if not self._settled and self.scene.state is not None:
            self._settled = True
            if self.scene.state.run is not None and self.scene.state.run.outcome == UNDER_WAY:
                self.go_to("run")  # a run under way is shown first
                return
        self._draw(base)
        if self.screen is base:
            self._attend(base)

    def _attend(self, base: Screen[object]) -> None:
        """Enter the visible screen once, even if a dialog has hidden it until now, and keep the focus in it."""
        view = self.view
        if self._entered is not view:
            self._entered = view
            view.enter()
        elif base.focused is None and not base.has_class("-tiny"):
            view.take_focus()

    def _draw(self, base: Screen[object]) -> None:
        for panel in (base.query_one(StateLine), base.query_one(TabLine), base.query_one(KeyLine)):
            panel.show(self.scene)
        base.query_one(SmallPanel).show(self.scene)
        self.view.show(self.scene)

    def service_died(self) -> None:
        """Report in a dialog that the service has died, what the devices do by themselves, and what to do."""
        self.push_screen(TextDialog(TITLE, death_text(self.scene)))

    # -- keys -------------------------------------------------------------------------------------------------

    def go_to(self, name: str) -> None:
        """Show another screen."""
        base = self.screen_stack[0]
        if not base.query(f"#{name}"):
            self.say("that screen needs a service: `tester tui`")
            return
        if name == RING and not self.scene.machine.ring:
            self.say("this machine has no ring to watch")
            return
        before = self.view
        base.query_one(ContentSwitcher).current = name
        if before is not self.view:
            before.leave()
            self._entered = None
        base.query_one(TabLine).current = name
        base.query_one(KeyLine).keys = self.keys_of(self.view)
        self.scene_changed()

    def keys_of(self, view: View) -> Keys:
        """Return the keys that the last line lists on a screen."""
        return view.KEYS

    def show_results(self, run: RunView) -> None:
        """Show a run's results."""
        self.go_to("results")
        self.screen_stack[0].query_one(ResultsView).open_run(run.folder)

    def action_go_to(self, name: str) -> None:
        """Show another screen."""
        if self.screen is self.screen_stack[0]:
            self._settled = True
            self.go_to(name)

    def action_help(self) -> None:
        """Show the help of this screen."""
        if not isinstance(self.screen, Dialog):
            self.push_screen(TextDialog("Help", f"{self.view.HELP}{self.EVERYWHERE}"))

    def action_hold(self) -> None:
        """HOLD, without a confirmation."""
        self.order(Hold(), "HOLD")

    def action_acknowledge(self) -> None:
        """Acknowledge the alarm of line 2, or an interrupted run if there is no alarm."""
        alarm = self.scene.top_alarm()
        self.order(Acknowledge(alarm.number if alarm is not None else 0))

    def action_abort(self) -> None:
        """Ask for confirmation to abort the run, if there is a run."""
        run = self.scene.state.run if self.scene.state is not None else None
        if run is not None and run.outcome == UNDER_WAY:
            self.push_screen(AbortDialog())
        else:
            self.say("nothing runs that could be aborted")

    def action_resume(self) -> None:
        """End HOLD, or offer the runs that can resume; each is preceded by the pre-flight list."""
        state = self.scene.state
        if state is None:
            return
        if state.mode == "HOLD":
            self.push_screen(GoOnDialog(state, Release(), "HOLD ends, the run continues"))
        elif state.mode == "LATCHED":
            self.say("nothing begins before the trip is acknowledged: a acknowledges")
        elif state.mode not in FREE:
            self.say("the rig is in use: nothing to resume")
        else:
            self.run_worker(self._offer_runs(state), group="orders", exit_on_error=False)

    async def _offer_runs(self, state: StateView) -> None:
        """Show the runs that `tester resume` accepts, newest first."""
        answer = await self.ask(ListRuns())
        runs = resumable(answer)
        if runs:
            self.push_screen(ResumeDialog(state, runs))
        elif answer is not None:
            self.say("nothing to resume: every stored run went through its plan")

    def action_take_control(self) -> None:
        """Take control from the client that has it."""
        self.order(TakeControl(force=True), "this screen controls")

    def action_pages(self) -> None:
        """Show who is paired with the page, and codes to pair another browser."""
        if self.options.view_only:
            self.say("view only: codes are shown on the machine's own screen")
        elif not isinstance(self.screen, Dialog):
            self.push_screen(PagesDialog())

    def action_commission(self) -> None:
        """Open the commissioning screen, as `tester commission RIG --tui` does, while no run is under way."""
        state, options = self.scene.state, self.options
        if options.view_only or state is None or not self.scene.linked:
            self.say("not from here: `tester commission RIG --tui` in a shell")
        elif state.mode not in FREE:
            self.say("the rig is in use: commissioning begins while no run and no manual mode is on")
        elif not begins_here(options, state):
            self.say("the service has another rig than this screen knows: `tester commission RIG --tui` in a shell")
        else:
            try:
                with self.suspend():
                    commission_rig(options)
            except SuspendNotSupported:
                self.say("no other screen can be shown here: `tester commission RIG --tui` in a shell", problem=True)

    def action_end_service(self) -> None:
        """Offer to end the service here, while nothing runs."""
        state, options = self.scene.state, self.options
        if options.view_only or options.address is not None or state is None or not self.scene.linked:
            self.say("not from here: end the service where it was started")
        elif state.mode not in FREE:
            self.say("the rig is in use: the service can be ended while no run and no manual mode is on")
        else:
            self.push_screen(EndServiceDialog())

    def action_use_theme(self, name: str) -> None:
        """Change the colours."""
        self.theme = THEMES[name].name

    def get_system_commands(self, screen: Screen[object]) -> Iterable[SystemCommand]:
        """Return the commands of the palette (Ctrl+P)."""
        yield SystemCommand("STOP", "Software stop, at once (F12, Ctrl+X)", self.action_stop)
        yield SystemCommand("FAST STOP", "Quick stop of both drives, at once (F9, Ctrl+F)", self.action_fast_stop)
        yield SystemCommand("HOLD", "Lift and wait, keep the temperature (space)", self.action_hold)
        yield SystemCommand("Resume", "End HOLD, or resume an unfinished run (r)", self.action_resume)
        yield SystemCommand("Abort…", "Controlled stop of the run (x)", self.action_abort)
        yield SystemCommand("Acknowledge", "The alarm of line 2 (a)", self.action_acknowledge)
        for key, title, name in self.SCREENS_HERE:
            yield SystemCommand(f"Screen: {title}", key.upper(), lambda name=name: self.go_to(name))
        yield SystemCommand("Commission…", "Guide a new rig to its first coefficient", self.action_commission)
        yield SystemCommand("Pages in browsers…", "Codes to pair one, who is paired", self.action_pages)
        yield SystemCommand("End the service…", "That a screen started, while nothing runs", self.action_end_service)
        yield SystemCommand("Take control", "From the client that has it", self.action_take_control)
        for name in THEMES:
            yield SystemCommand(f"Theme: {name}", "Colours", lambda name=name: self.action_use_theme(name))
        yield SystemCommand("Help", "Keys of this screen (F1)", self.action_help)
        yield SystemCommand("Detach", "Leave the screen; the run continues (q)", self.action_detach)
