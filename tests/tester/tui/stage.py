"""A screen in front of a service played by the test, and its text."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import JsonValue
from textual.pilot import Pilot

from tester.service.commands import Action, CheckRecipe, ListRuns, Query, ShowPlan
from tester.service.queries import Queries
from tester.service.results_view import GivenResults
from tester.service.state_view import PlanView, StateView
from tester.tui.app import TesterApp
from tester.tui.host import TuiOptions
from tester.tui.pages.bus import BusPage
from tester.tui.pages.recipes import RecipesView
from tests.tester.service.fake import FakeService
from tests.tester.service.views import MACHINE
from tests.tester.service.views import plan as a_plan
from tests.tester.service.views import state as a_state

PLAN: JsonValue = {"conditions": 2, "rig_seconds": 2700.0, "sliding_m": 120.0, "loss_mm": 0.2, "wheels": 1, "steps": []}


@dataclass(slots=True)
class PlayedQueries(Queries):
    """Answers at once, without processes: a recipe's text decides whether it is good.

    While ``checking`` or ``planning`` is not set such questions wait, ``waiting`` checks. ``planned`` and ``listed``
    count requests, ``answered`` the answered checks.
    """

    checking: asyncio.Event = field(default_factory=asyncio.Event)
    planning: asyncio.Event = field(default_factory=asyncio.Event)
    waiting: int = 0
    answered: int = 0
    planned: int = 0
    listed: int = 0
    stored: list[JsonValue] = field(default_factory=list[JsonValue])
    """Existing runs."""

    async def answer(self, question: Query) -> JsonValue:
        """Return the service's answer."""
        if isinstance(question, ListRuns):
            self.listed += 1
            return {"runs": self.stored}
        if isinstance(question, ShowPlan):
            self.planned += 1
            await self.planning.wait()
            return PLAN
        self.waiting += 1
        await self.checking.wait()
        self.waiting -= 1
        self.answered += 1
        bad = isinstance(question, CheckRecipe) and "wrong" in question.text
        return {"problems": [{"line": 3, "column": 5, "message": "load: expected a unit [/x]"}] if bad else []}

WAIT_S = 60.0
"""Time limit of a test's waits, s: only a failure takes that long."""


@dataclass(slots=True)
class Stage:
    """The service, the screen and its pilot. ``now``: the screen's clock, s."""

    fake: FakeService
    app: TesterApp
    pilot: Pilot[str]
    now: list[float]
    queries: PlayedQueries
    found: str = ""
    """The screen that was shown first."""

    async def until(self, true: Callable[[], bool], what: str) -> None:
        """Let both work until a condition holds: threads read files beside them, on a shared computer."""
        clock = asyncio.get_running_loop().time
        late = clock() + WAIT_S
        while clock() < late:
            if true():
                return
            await self.pilot.pause()
            await asyncio.sleep(0)
        raise AssertionError(f"{what}: never\n{self.text()}")

    async def show(
        self, view: StateView, plan: PlanView | None = None, results: GivenResults | None = None
    ) -> None:
        """Have the service send a state, and wait until the screen has it."""
        if plan is not None:
            self.fake.plan(plan)
            await self.until(lambda: self.app.scene.plan == plan, "the plan arrives")
        if results is not None:
            self.fake.give(results)
            await self.until(lambda: self.app.scene.results == results, "the results arrive")
        self.fake.show(view)
        await self.until(lambda: self.app.scene.state == view, "the state arrives")
        await self.pilot.pause()

    async def ordered(self, kind: type) -> Action:
        """Wait until the service has got an order of this kind, and return it."""
        await self.until(lambda: any(isinstance(o.action, kind) for o in self.fake.orders), kind.__name__)
        return next(o.action for o in reversed(self.fake.orders) if isinstance(o.action, kind))

    def checked(self) -> bool:
        """Return whether every recipe has been checked."""
        view = self.app.screen_stack[0].query_one(RecipesView)
        return self.app.options.view_only or all(str(one.path) in view.checked for one in view.recipes)

    def text(self) -> str:
        """Return the screen's text, a line a row."""
        return screen_text(self.app)

    def line(self, number: int) -> str:
        """Return one row, from 0, also from the end."""
        return self.text().split("\n")[number]


def screen_text(app: TesterApp) -> str:
    """Return the screen's text with dialogs."""
    strips = app.screen._compositor.render_strips()  # the only way to the composed picture
    return "\n".join("".join(segment.text for segment in strip).rstrip() for strip in strips)


def colours(app: TesterApp) -> set[str]:
    """Return the colours sent to the terminal."""
    strips = app.screen._compositor.render_strips()
    styles = [segment.style for strip in strips for segment in strip if segment.style is not None]
    return {str(colour) for style in styles for colour in (style.color, style.bgcolor) if colour is not None}


def trend() -> list[tuple[float | None, ...]]:
    """Return two minutes of a trend that rises and waves, the same every time."""
    rows: list[tuple[float | None, ...]] = []
    for number in range(480):
        known: dict[str, float | None] = dict.fromkeys(MACHINE.trend, 0.0)
        known["wall_s"], known["t_s"] = 0.25 * number, 7141.5 + 0.25 * number
        known["surface_setpoint_c"], known["load_setpoint_n"], known["slip_setpoint_mm_s"] = 40.0, 200.0, 300.0
        known["friction"] = 0.70 + 0.01 * (number % 7)
        known["surface_c"] = 38.0 + 0.005 * number
        known["load_n"] = 199.0 + number % 3
        known["slip_mm_s"] = 299.0 + number % 5
        rows.append(tuple(known[column] for column in MACHINE.trend))
    return rows


@asynccontextmanager
async def stage(
    folder: Path, size: tuple[int, int] = (80, 24), *, plain: bool = False, view_only: bool = False, theme: str = "dark"
) -> AsyncIterator[Stage]:
    """Open a screen of some size before a service that has one recipe to offer."""
    now = [100.0]
    async with FakeService(folder) as fake:
        fake.gateway.queries = queries = PlayedQueries(folder)
        queries.checking.set()
        queries.planning.set()
        for row in trend():
            fake.show(a_state(), row)
        options = TuiOptions(
            address=fake.address, plain=plain, view_only=view_only, theme=theme, recipe_folder=folder,
            runs=folder / "runs",
        )  # fmt: skip
        app = TesterApp(options, lambda: now[0])
        async with app.run_test(size=size, notifications=True) as pilot:
            made = Stage(fake, app, pilot, now, queries)
            await made.until(lambda: app.scene.state is not None, "the service is found")
            await pilot.pause()
            made.found = app.view.id or ""
            await pilot.press("f2")
            fake.plan(a_plan())
            await made.show(a_state())
            yield made


def play(
    scene: Callable[[Stage], Awaitable[None]], folder: Path, size: tuple[int, int] = (80, 24), **kind: bool
) -> None:
    """Carry out a test on a stage of its own."""

    async def act() -> None:
        async with stage(folder, size, **kind) as on:
            await scene(on)

    asyncio.run(act())


class House:
    """A stage that stays open for several tests: starting the application costs more than most of them."""

    def __init__(self, folder: Path) -> None:
        """Open it in ``folder`` for as long as the block lasts."""
        self._runner, self._stack = asyncio.Runner(), AsyncExitStack()
        self._folder = folder
        self._stage: Stage | None = None

    def __enter__(self) -> House:
        """Open."""
        self._stage = self._runner.run(self._stack.enter_async_context(stage(self._folder)))
        return self

    def __exit__(self, *_: object) -> None:
        """Close."""
        self._runner.run(self._stack.aclose())
        self._runner.close()

    def play(self, scene: Callable[[Stage], Awaitable[None]]) -> None:
        """Carry out a test: no dialog is open, Recipes are shown, nothing has been ordered, and there is no alarm."""
        on = self._stage
        assert on is not None

        async def act() -> None:
            while len(on.app.screen_stack) > 1:
                on.app.pop_screen()
                await on.pilot.pause()
            on.app.shown_messages.clear()
            on.app.show_said()
            on.app.query_one(BusPage).action_unfilter()
            await on.pilot.press("f2")
            on.app.view.take_focus()
            await on.show(a_state())
            on.fake.orders.clear()
            on.fake.refusals.clear()
            await scene(on)

        self._runner.run(act())
