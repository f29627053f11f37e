"""A service on a stage: a script replaces its clients, called at every poll; no socket, no process.

    def script(stage):
        yield stage.order(RunRecipe(...))
        yield from stage.until(lambda view: view.mode == "RUN")
        yield stage.order(Stop())

The stage ends when the script does.
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from pathlib import Path
from typing import ClassVar

import pytest
from pydantic import JsonValue

from recipes import UnknownRecipe
from tester.base.source import InvalidSource
from tester.notices.notice import NextNeeded, Notice, NoticeOver
from tester.queue.assess import Assessment, AssessTask, assess
from tester.queue.view import QueueView
from tester.run.endings import CannotStartError
from tester.run.preconditions import Prepared, prepared
from tester.service.address import UnixAddress
from tester.service.commands import RigAction
from tester.service.gateway_link import GatewayLink, LinkConfig
from tester.service.planning import Task
from tester.service.protocol import Event, Frames
from tester.service.service import Service, ServiceOptions
from tester.service.service_link import Order, Presence
from tester.service.state_view import PlanView, StateView

Script = Generator[Order | Presence | list[Order | Presence] | None]
MOST_POLLS = 20_000
"""Time limit of a script."""


class Stage(GatewayLink):
    """Receives the script's commands, and keeps messages for clients."""

    def __init__(self, folder: Path, script: Callable[[Stage], Script]) -> None:
        super().__init__(LinkConfig(UnixAddress(folder / "service.sock"), folder / "service.json", folder, "sim"))
        self.events: list[Event] = []
        self.views: list[StateView] = []
        self.plans: list[PlanView | None] = []
        self.queues: list[QueueView] = []
        self.told_frames: list[Frames] = []
        self.accepted: dict[str, JsonValue] = {}
        self.refused: dict[str, str] = {}
        self.notes: list[tuple[str, str]] = []
        self.told: list[Notice | NoticeOver | NextNeeded] = []
        self.polls = 0
        self.silent = False
        """The controlling screen is silent."""
        self.service: Service | None = None
        self._script = script(self)
        self._orders = 0

    # -- for scripts ------------------------------------------------------------------------------------------

    def order(self, action: RigAction, client: int = 1) -> Order:
        self._orders += 1
        return Order(client, f"client {client}", self._orders, action)

    def until(self, reached: Callable[[StateView], bool]) -> Script:
        """Wait for a state that meets a condition."""
        while not (self.views and reached(self.views[-1])):
            yield None

    def texts(self, kind: str) -> list[str]:
        return [event.text for event in self.events if event.kind == kind]

    # -- the gateway's part ---------------------------------------------------------------------------------------

    @property
    def watched(self) -> bool:
        return True

    @property
    def silent_s(self) -> float:
        return 1.1 if self.silent else 0.0

    def event(self, kind: str, text: str, severity: str = "info", t_s: float = 0.0, run: str = "") -> None:
        self.sequence += 1
        self.events.append(Event(self.sequence, t_s, "", kind, severity, text, run))

    def state(self, view: StateView, row: tuple[float | None, ...]) -> None:
        self.views.append(view)

    def plan(self, plan: PlanView | None) -> None:
        self.plans.append(plan)

    def queue(self, queue: QueueView) -> None:
        self.queues.append(queue)

    def frames(self, frames: Frames) -> None:
        self.told_frames.append(frames)

    def accept(self, order: Order, result: JsonValue = None) -> None:
        self.accepted[order.action.command] = result

    def refuse(self, order: Order, reason: str) -> None:
        self.refused[order.action.command] = reason

    def notify(self, note: Notice | NoticeOver | NextNeeded) -> None:
        self.told.append(note)
        if isinstance(note, Notice):
            self.notes.append((note.cause.value, note.what))

    def receive(self) -> list[Order | Presence]:
        assert self.service is not None
        self.polls += 1
        assert self.polls < MOST_POLLS, "the script does not come to its end"
        try:
            message = next(self._script)
        except StopIteration:
            self.service.end()
            return []
        if isinstance(message, Presence):
            self.presence = message
        return message if isinstance(message, list) else [] if message is None else [message]

    def wait(self, seconds: float) -> None:
        pass


def planned_here(task: Task, meanwhile: Callable[[], str]) -> Prepared:
    """Plan in this process: starting a process for every test would take longer than the test."""
    why = meanwhile() or meanwhile()
    if why:
        raise CannotStartError(why)
    try:
        return prepared(task.recipe, task.rig, task.overrides, task.accept_risk)
    except (InvalidSource, UnknownRecipe) as error:
        raise CannotStartError(str(error)) from error


class AssessedHere:
    """Checks items in this process, at the next poll: a process for every check takes longer than the test."""

    looked: ClassVar[list[AssessTask]] = []

    def __init__(self) -> None:
        self._task: AssessTask | None = None

    @property
    def busy(self) -> bool:
        return self._task is not None

    def begin(self, task: AssessTask) -> None:
        self._task = task
        self.looked.append(task)

    def poll(self) -> Assessment | None:
        assert self._task is not None
        task, self._task = self._task, None
        return assess(task)

    def end(self) -> None:
        self._task = None


def play(folder: Path, script: Callable[[Stage], Script], *overrides: str, rig: str = "sim") -> Stage:
    """Run a service until the script has ended; return the messages."""
    stage = Stage(folder, script)
    stage.service = Service(ServiceOptions(rig, overrides, folder / "runs"), stage)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("tester.service.running.planned", planned_here)
        patch.setattr(stage.service.queue, "_assessor", AssessedHere())
        stage.service.serve()
    return stage
