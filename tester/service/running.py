"""A run in the service: the session that `tester run` carries out too, with clients where that has a terminal."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from types import FrameType
from typing import cast

from tester import clock
from tester.engine.context import Progress as RunProgress
from tester.engine.prompts import Prompts
from tester.service.desk import Desk
from tester.service.orders import Holdable
from tester.service.state import RunView, TickView
from tester.session import Session, SessionOptions


class ServiceSession(Session):
    """A session that tells the service of signals."""

    def __init__(self, options: SessionOptions, screen: RunScreen, on_signal: Callable[[], None]) -> None:
        """``on_signal``: called when the process is asked to end."""
        super().__init__(options, screen)
        self._tell_signal = on_signal
        screen.session = self

    def _on_signal(self, number: int, _frame: FrameType | None) -> None:
        self._tell_signal()
        if isinstance(self.run_, Holdable):
            self.run_.stays_latched = False  # nobody will be there to acknowledge
        super()._on_signal(number, _frame)


class RunScreen:
    """Shows a session to the desk. ``begun`` is called once, when the run is under way."""

    can_ask = True

    def __init__(self, desk: Desk, view: RunView, *, answer_yes: bool, begun: Callable[[RunView], None]) -> None:
        """``view``: what is known of the run before it begins."""
        self.desk = desk
        self.view = view
        self.answer_yes = answer_yes
        self.session: Session | None = None
        self.name = ""
        self.missing: list[str] = []
        self.messages: list[str] = []
        self._begun = begun
        self._started = False

    def begin(self, name: str) -> None:
        """Take the recipe's name."""
        self.name = name

    def show(self, now_s: float, run: RunProgress, share: float) -> None:
        """Let the desk look, and clients speak."""
        session, desk = self.session, self.desk
        assert session is not None
        under_way = session.run_
        if under_way is not None and (desk.watch is None or desk.watch.run is not under_way):
            self._attach(session)
        statistics = session.statistics
        desk.tick = TickView(0.0, statistics.late_max_s, statistics.overruns)
        desk.poll(now_s)

    def _attach(self, session: Session) -> None:
        assert session.run_ is not None
        if not self._started:
            self._started = True
            folder = session.folder
            self.view = replace(
                self.view, name=folder.name if folder else "", folder=str(folder) if folder else "", recipe=self.name,
                started_utc=clock.utc_now(),
            )  # fmt: skip
            self._begun(self.view)
        if isinstance(session.run_, Holdable):
            session.run_.stays_latched = True
        self.desk.attach(session.run_, self.view)

    def attend(self, prompts: Prompts) -> None:
        """Nothing: clients answer by command."""

    def end(self) -> None:
        """The last state is shown before the tables are written."""
        self.desk.show()

    def message(self, text: str) -> None:
        """Tell every client."""
        self.messages.append(text)
        self.desk.tell("message", text)

    def emit(self, record: dict[str, object]) -> None:
        """Take the figures of the end."""
        missing = record.get("missing")
        if record.get("event") == "end" and isinstance(missing, list):
            self.missing = [str(one) for one in cast("list[object]", missing)]

    def result(self, line: str) -> None:
        """Nothing: clients know the folder."""
