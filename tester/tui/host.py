"""The application beneath its screens: the link to the service, the scene, and the sending of orders."""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, TypeVar, cast

from pydantic import JsonValue
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.dom import DOMNode

from tester.base import clock
from tester.base.processes import tester_command
from tester.base.trouble import in_words
from tester.base.who import who_here
from tester.service.address import Address
from tester.service.client import Client, Link, Lost, LostError, NoServiceError, RefusedError
from tester.service.commands import Action, Stop
from tester.service.protocol import Event
from tester.service.state_view import RunView
from tester.service.stop_call import NotTakenError
from tester.service.stop_line import StopLine
from tester.store.record_schema import StoreError
from tester.tui.gone import farewell, stop_failed
from tester.tui.own_service import start_service
from tester.tui.screen_scene import ScreenScene
from tester.tui.stop_line import stopping
from tester.tui.theme import LookApp
from tester.tui.widgets.panel_base import Panel
from tester.tui.widgets.said import Said, SaidLines, said_now

ROLE = "screen"
"""What this client is, behind the name of its user."""
TICK_S = 0.5
"""Period for updating the displayed age of the data, s."""
async def call(*arguments: str) -> tuple[bool, str]:
    """Run ``tester ARGUMENTS``; return whether it succeeded, and its error output."""
    process = await asyncio.create_subprocess_exec(
        *tester_command(*arguments),
        stdin=asyncio.subprocess.DEVNULL, stdout=asyncio.subprocess.DEVNULL, stderr=asyncio.subprocess.PIPE,
    )  # fmt: skip
    _, output = await process.communicate()
    return process.returncode == 0, output.decode(errors="replace").strip()


@dataclass(frozen=True, slots=True)
class TuiOptions:
    """Options of `tester tui`. ``speed``: rig seconds per second of simulated runs, None = as fast as possible."""

    rig: str = "sim"
    speed: float | None = 1.0
    runs: Path = Path("runs")
    address: Address | None = None
    start: bool = True
    """Whether to start a service if none runs."""
    plain: bool = False
    """Whether to use only ASCII."""
    view_only: bool = False
    theme: str = ""
    recipe_folder: Path = Path()


class HostApp(LookApp):
    """Holds the link and the scene, independently of any screen."""

    ENABLE_COMMAND_PALETTE = True
    HAS_RIG: ClassVar[bool] = True
    """Whether this screen belongs to a rig."""
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c,ctrl+q", "detach", "Detach", priority=True, show=False),
    ]

    def __init__(self, options: TuiOptions, now: Callable[[], float] = clock.monotonic) -> None:
        """``now`` returns seconds, by default of tester.base.clock.monotonic."""
        super().__init__(options.theme, plain=options.plain)
        self.options = options
        self.stop_line = StopLine(options.address, who_here(ROLE))
        if self.HAS_RIG and not options.view_only:
            self.driver_class = stopping(self.driver_class, self.stop_line)
        self.scene = ScreenScene(now=now, view_only=options.view_only)
        self.link: Link | None = None
        self._started = False
        self._stops: set[asyncio.Task[None]] = set()
        self.shown_messages: list[Said] = []
        """Messages that have not expired, oldest first."""

    # -- for the screens --------------------------------------------------------------------------------------

    def scene_changed(self) -> None:
        """Called after each change of the scene."""

    def service_died(self) -> None:
        """Called when the service has died: it is gone without a request to end."""

    def go_to(self, name: str) -> None:
        """Show another screen, by its id."""

    def show_results(self, run: RunView) -> None:
        """Show a run's results."""

    def say(self, text: str, *, problem: bool = False, lasting: bool = False) -> None:
        """Show a message to the person, as plain text, above the last line of each screen and dialog."""
        now_s = self.scene.now()
        self.shown_messages.append(said_now(text, problem=problem, lasting=lasting, now_s=now_s))
        self.set_timer(self.shown_messages[-1].until_s - now_s + 0.01, self.show_said)
        self.show_said()

    def show_said(self) -> None:
        """Show the messages that have not expired."""
        now_s = self.scene.now()
        self.shown_messages = [message for message in self.shown_messages if message.until_s > now_s]
        for screen in self.screen_stack:
            for lines in screen.query(SaidLines):
                lines.show_said(self.shown_messages)

    # -- link -------------------------------------------------------------------------------------------------

    def connect(self) -> None:
        """Keep a link to the service from now on."""
        self.link = Link(self.options.address, name=who_here(ROLE), control=not self.options.view_only)
        if self.HAS_RIG and not self.options.view_only:
            self.stop_line.open()
        self.run_worker(self._listen(self.link), name="link", group="link")
        self.set_interval(TICK_S, self.scene_changed)

    async def _listen(self, link: Link) -> None:
        async for message in link.messages():
            before = self.scene.gone
            self.scene.take(message, link.client)
            if self.scene.gone == "died" != before:
                self.service_died()
            if isinstance(message, Lost) and self.scene.state is None:
                self._begin_service()
            if isinstance(message, Event) and message.kind == "acknowledgement" and message.text.startswith("refused"):
                self.say(f"{message.text}; F12 ends the run", problem=True)
            self.scene_changed()

    def _begin_service(self) -> None:
        """Start a service if none runs, but only once: a service that has ended is not started again without the
        operator's knowledge.
        """
        if self._started or not self.options.start or self.options.address is not None or self.options.view_only:
            return
        self._started = True
        try:
            start_service(self.options.rig, self.options.runs)
        except OSError as error:
            self.say(f"the service cannot be started: {in_words(error)}", problem=True, lasting=True)

    # -- orders -----------------------------------------------------------------------------------------------

    def order(self, action: Action, done: str = "") -> None:
        """Send an order; show why it was refused, or ``done`` once it is accepted."""
        self.run_worker(self.ask(action, done), group="orders", exit_on_error=False)

    async def ask(self, action: Action, done: str = "") -> JsonValue:
        """Send an order and return its result; None if it was refused, which is shown."""
        if self.options.view_only or self.link is None:
            self.say("view only: nothing is commanded from here")
            return None
        try:
            result = await self.link.command(action)
        except RefusedError as error:
            hint = ": Ctrl+P, Take control" if "has control" in str(error) else ""
            self.say(f"refused: {error}{hint}", problem=True)
        except (LostError, TimeoutError) as error:
            self.say(f"no answer from the service: {error}", problem=True)
        else:
            if done:
                self.say(done)
            return result if result is not None else {}
        return None

    def action_stop(self) -> None:
        """STOP, without a confirmation, from every screen and every client."""
        self._order_stop(fast=False)

    def action_fast_stop(self) -> None:
        """STOP with a quick stop of both drives."""
        self._order_stop(fast=True)

    def _order_stop(self, *, fast: bool) -> None:
        if self.options.view_only or self.link is None:
            self.say("view only: `tester stop` in a shell stops the rig", problem=True)
            return
        task = asyncio.create_task(self._stop(self.link, self.stop_line.take(), fast))
        self._stops.add(task)
        task.add_done_callback(self._stops.discard)

    async def _stop(self, link: Link, sent: Future[None] | None, fast: bool) -> None:
        """Wait for the STOP that the key has already sent. If there is none, or it failed, send STOP over the link."""
        taken = "FAST STOP taken" if fast else "STOP taken"
        if sent is not None:
            try:
                await asyncio.wrap_future(sent)
            except NotTakenError:
                pass
            else:
                self.say(taken)
                return
        try:
            try:
                await link.command(Stop(fast))
            except LostError:  # the link is reconnecting: a new connection may be faster
                async with await Client.connect(link.address, name=link.name) as client:
                    await client.stop(fast=fast)
        except (LostError, NoServiceError, RefusedError, TimeoutError) as error:
            self.say(stop_failed(self.scene, str(error)), problem=True, lasting=True)
            return
        self.say(taken)

    def action_detach(self) -> None:
        """Leave the screen; the run continues."""
        self.exit(farewell(self.scene))


def host_of(node: DOMNode) -> HostApp:
    """Return the application of a widget."""
    return cast("HostApp", node.app)  # pyright: ignore[reportUnknownMemberType]  # Textual leaves its type open


Keys = tuple[tuple[str, str], ...]
Read = TypeVar("Read")
Listed = dict[str, JsonValue]


class View(Vertical):
    """A screen between the fixed lines. ``KEYS``: the keys in the last line; ``HELP``: the text for F1."""

    KEYS: ClassVar[Keys] = ()
    HELP: ClassVar[str | None] = ""

    @property
    def host(self) -> HostApp:
        """Return the application."""
        return host_of(self)

    def show(self, scene: ScreenScene) -> None:
        """Show the present scene."""
        for panel in self.query(Panel):
            panel.show(scene)

    def enter(self) -> None:
        """Called each time the screen appears."""
        self.take_focus()

    def take_focus(self) -> None:
        """Focus the widget that needs the keys first."""
        self.focus()

    def leave(self) -> None:
        """Called when another screen appears."""


def runs_in(answer: JsonValue) -> list[Listed] | None:
    """Return the runs in an answer to ListRuns, as `tester runs --json` prints them; None for a refusal."""
    runs = answer.get("runs") if isinstance(answer, dict) else None
    return [run for run in runs if isinstance(run, dict)] if isinstance(runs, list) else None


async def read_in_thread(host: HostApp, what: str, work: Callable[[], Read]) -> Read | None:
    """Return what ``work`` reads from stored runs, in a thread. If ``what`` is unreadable, show a message and return
    None.
    """
    try:
        return await asyncio.to_thread(work)
    except (StoreError, OSError, sqlite3.Error) as error:
        host.say(f"{what} cannot be read: {in_words(error)}", problem=True)
        return None
