"""The rig's activity while STOP is pressed: sliding at 100 Hz, resting at 10 Hz, moved by hand, not yet present."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Sequence
from contextlib import AbstractContextManager, asynccontextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from tester.base import clock
from tester.service.client import Client, LostError, RefusedError
from tester.service.commands import Action, Arm, Jog, RunRecipe
from tester.service.service import SILENT_S
from tester.service.state_view import RunView, StateView
from tester.store.run_reader import RunReader
from tests.campaigns.acceptance.figure import Figure, at_least, at_most, equal, holds
from tests.campaigns.stop.hostile import BY_FORCE, KINDS
from tests.campaigns.stop.owner import PROBE
from tests.campaigns.stop.place import NICED_LOOPS, NotReachedError, Place, Try
from tests.campaigns.stop.scans import Scans, latest_kept, latest_of, limit_of

ASKED_S = 0.1
QUIET_S = 10.0
"""Time over which scans are watched without hostile clients."""
MOST_ROUNDS = 3
"""If the latest scan of the first round misses, all rounds are watched and judged as one, by the same inequality: a
virtual machine loses its processor for 4 to 10 ms at any moment, and 10 s show little of the resulting lateness."""
SETTLE_S = 3.0
"""Time for hostile clients to start, s."""
SLIDES = """\
recipe: sliding and resting
specimens: [{compound: "1#"}]
pre_grind: {wheel_speed: 0.8 m/s, belt_speed: 0.6 m/s, load: 100 N, duration: %d s}
rest: {at_least: 60 min, until: 25 degC, within: 2 degC}
measure: {wheel_speed: 0.8 m/s, repeats: 1, min_valid: 1, window: 14 rev}
grids:
  - {name: one, slip_velocity: 100 mm/s, load: 100 N, temperature: 25 degC}
"""
SIGN_S = 0.25
"""Time between two signs of life, s: as sent by the operator's screen."""
SHARE_S = SILENT_S - 2.0 * SIGN_S
"""Lateness of a loop with the gateway's niceness above which a sign of life may take a second."""
ARM_S = 120.0
MOST_TRIES = 4
"""Maximum number of tries, as a multiple of the requested ones, to get these while the rig is moved."""
WHY = ("mode", "control", "run", "alarm", "service")
"""Events that give the reason for the end of manual mode."""
TAKEN_S = 0.3
"""Time within which an order is refused for lack of control, s."""
ENDED = ("OFFLINE", "INTERRUPTED")
Attack = Callable[[Sequence[str]], AbstractContextManager[None]]


def big(conditions: int) -> str:
    """Return a recipe of so many conditions (a multiple of 2,000)."""
    slips = ", ".join(f"{100 + i} mm/s" for i in range(conditions // 2000))
    loads = ", ".join(f"{100 + i} N" for i in range(100))
    temperatures = ", ".join(f"{30 + i} degC" for i in range(20))
    return (
        'recipe: big\nspecimens: [{compound: "1#"}]\n'
        "measure: {wheel_speed: 0.8 m/s, repeats: 3, window: 30 rev}\n"
        f"grids:\n  - name: g\n    slip_velocity: [{slips}]\n    load: [{loads}]\n    temperature: [{temperatures}]\n"
    )


def figures_of(place: Place, name: str, tries: list[Try], began_s: float) -> list[Figure]:
    """Compare the tries of a scene with the limits of STOP."""
    worst_s = place.loop_late_s(began_s, clock.monotonic())
    delays = [one.control_s - one.sent_s for one in tries if one.control_s is not None]
    answers = [one.answered_s - one.sent_s for one in tries if one.answered_s is not None]
    limit_ms = 1e3 * (ASKED_S + worst_s)
    kept = sum(delay <= ASKED_S + worst_s for delay in delays)
    median = 1e3 * sorted(delays)[len(delays) // 2] if delays else float("nan")
    return [
        holds(f"{name}: a bare loop of 20 ms is late by at most", True, f"{1e3 * worst_s:.1f} ms", "no limit"),
        equal(f"{name}: STOP in control in time", f"{kept} of {len(tries)}", f"{len(tries)} of {len(tries)}"),
        at_most(f"{name}: STOP to control, worst", 1e3 * max(delays, default=float("nan")), limit_ms, "ms", 1,
                note=f" (median {median:.1f})"),
        equal(f"{name}: STOP answered", f"{len(answers)} of {len(tries)}", f"{len(tries)} of {len(tries)}"),
    ]  # fmt: skip


async def ended_by_the_operator(place: Place, client: Client) -> Figure:
    """Really stop, and check that the rig stops."""
    sent_s = clock.monotonic()
    await asyncio.to_thread(place.end_for_real)
    stopping = ("STOPPING", "COOLDOWN", "OFFLINE", "INTERRUPTED")
    await place.until(client, lambda view: view.mode in stopping, "a stop", 10.0)
    seen_ms = 1e3 * (clock.monotonic() - sent_s)
    await place.until(client, lambda view: view.mode in ENDED, "standstill, and the end", 120.0)
    return holds("the operator's own STOP stops the rig", True, f"seen after {seen_ms:.0f} ms", "stops")


def at_rest(view: StateView) -> bool:
    """Nothing is running."""
    return view.mode in ("OFFLINE", "INTERRUPTED", "IDLE")


async def sliding_and_resting(place: Place, client: Client, attack: Attack, count: int) -> AsyncIterator[Figure]:
    """100 Hz and 10 Hz: a run that slides, then rests."""
    quiet = await begin_to_slide(place, client, max(QUIET_S, 0.8 * count))
    with attack(BY_FORCE):
        await asyncio.sleep(SETTLE_S)
        began_s = clock.monotonic()
        tries = await place.tries(count)
        fresh = await place.tries(count, fresh=True)
        await asyncio.sleep(began_s + QUIET_S - clock.monotonic())
        loud = (began_s, clock.monotonic())
        yield holds("at 100 Hz: the run ticks as", True, place.scheduling(), "no limit")
        yield holds("at 100 Hz: the wheel still slides", slides(client.state), client.state.mode, "RUN")
        for figure in figures_of(place, "at 100 Hz", tries, began_s):
            yield figure
        for figure in figures_of(place, "at 100 Hz, fresh", fresh, began_s):
            yield figure
        await place.until(client, lambda view: view.tick.rate_hz <= 10.0, "a rest", 120.0)
        began_s = clock.monotonic()
        for figure in figures_of(place, "at 10 Hz", await place.tries(count), began_s):
            yield figure
        for figure in figures_of(place, "at 10 Hz, fresh", await place.tries(count, fresh=True), began_s):
            yield figure
        yield at_most("rate at a rest", client.state.tick.rate_hz, 10.0, "Hz", 1)
    yield await ended_by_the_operator(place, client)
    scans = Scans(place, quiet, loud)
    for figure in scans.figures("hostile clients"):
        yield figure
    rounds = [scans]
    while not latest_kept(rounds[:1]) and len(rounds) < MOST_ROUNDS:
        quiet = await begin_to_slide(place, client, QUIET_S)
        with attack(BY_FORCE):
            await asyncio.sleep(SETTLE_S)
            began_s = clock.monotonic()
            await asyncio.sleep(QUIET_S)
            loud = (began_s, clock.monotonic())
        await ended_by_the_operator(place, client)
        rounds.append(Scans(place, quiet, loud))
        yield holds("latest scan once more", True, latest_of(rounds[-1:]), limit_of(rounds[-1:]))
    yield holds(f"latest scan beside them, {len(rounds)} rounds", latest_kept(rounds),
                latest_of(rounds), limit_of(rounds))  # fmt: skip


async def begin_to_slide(place: Place, client: Client, loud_s: float) -> tuple[float, float]:
    """Begin a run that slides; return from when to when it slid without hostile clients (tester.base.clock.monotonic).
    ``loud_s``: how long it must slide beside hostile clients.
    """
    await place.until(client, alone, "hostile clients gone")
    if not client.controls:
        await place.take_control(client)
    text = SLIDES % (QUIET_S + SETTLE_S + loud_s + 8.0)
    await client.command(RunRecipe("slides", text=text, speed=1.0, yes=True))
    await place.until(client, lambda view: slides(view), "a wheel that slides", 120.0)
    from_s = clock.monotonic()
    await asyncio.sleep(QUIET_S)
    return from_s, from_s + QUIET_S


def slides(view: StateView) -> bool:
    """The wheel slides under load."""
    slip, load = view.value("slip"), view.value("load")
    return (slip is not None and load is not None and slip.value is not None and load.value is not None
            and slip.value > 50.0 and load.value > 50.0)  # fmt: skip


async def by_hand(place: Place, client: Client, attack: Attack, count: int) -> AsyncIterator[Figure]:
    """Manual mode that moves, a step of both speeds up or down twice a second.

    If the gateway gets no processor time for a second, no sign of life reaches the owner, and the mode ends as it must.
    It is then armed again, until enough tries fall into it; every try is judged.
    """
    # The commands of the previous scene's clients are processed by then.
    await place.until(client, alone, "hostile clients gone")
    await place.take_control(client)
    hand = Hand(place, client)
    async with hand.at_work():
        await hand.armed()
        with attack(KINDS):
            await asyncio.sleep(SETTLE_S)
            began_s = clock.monotonic()
            tries: list[Try] = []
            inside = 0
            while inside < count and len(tries) < MOST_TRIES * count:
                await hand.armed()
                tries += await place.tries(1)
                inside += moved(client.state)
            to_s = clock.monotonic()
            for figure in figures_of(place, "by hand", tries, began_s):
                yield figure
        yield equal("by hand: tries while it moves", inside, count)
        yield at_least("by hand: steps taken", hand.steps, 4)
        niced_s = place.loop_late_s(began_s, to_s, NICED_LOOPS)
        yield holds("by hand: manual mode stands, or the gateway gets no share of the processor",
                    hand.again == 0 or niced_s > SHARE_S,
                    f"armed {hand.again} times again ({hand.why}); a bare loop beside the gateway is late by "
                    f"{1e3 * niced_s:.0f} ms",
                    f"0, or later than {1e3 * SHARE_S:g} ms")  # fmt: skip
        await hand.armed()
        yield await ended_by_the_operator(place, client)


def moved(view: StateView) -> bool:
    """The rig is moved by hand."""
    return view.mode == "MANUAL" and view.tick.rate_hz > 0.0


def alone(view: StateView) -> bool:
    """Only the operator is connected."""
    return view.clients.viewers + (view.clients.controller_id != 0) <= 1


class Hand:
    """The operator who moves the rig: sends signs of life, moves in steps, arms again if the mode has ended."""

    def __init__(self, place: Place, client: Client) -> None:
        """Nothing is armed."""
        self.place, self.client = place, client
        self.steps = 0
        self.again = 0
        """How often the mode was armed again."""
        self.why = ""
        """Reason for its last end."""
        self._armed = False

    @asynccontextmanager
    async def at_work(self) -> AsyncGenerator[None]:
        """Send signs of life and move in steps during the block."""
        tasks = [asyncio.create_task(self._attend()), asyncio.create_task(self._move())]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()

    async def armed(self) -> None:
        """Ensure that manual mode is armed. Raises NotReachedError."""
        end_s = clock.monotonic() + ARM_S
        while not moved(self.client.state):
            if clock.monotonic() > end_s or self.client.lost:
                state = self.client.state
                raise NotReachedError(f"manual mode: not within {ARM_S:g} s; {state.mode}: {state.mode_text}")
            if at_rest(self.client.state):
                with suppress(RefusedError, TimeoutError):
                    await self.client.command(Arm(), within_s=ARM_S)
                    if self._armed:
                        self.again += 1
                        self.why = "; ".join(one.text for one in self.client.events if one.kind in WHY)[-300:]
                    self._armed = True
            await asyncio.sleep(SIGN_S)

    async def arm_by_force(self) -> None:
        """Repeatedly take control and arm."""
        while not self.client.lost:
            with suppress(RefusedError, LostError, TimeoutError):
                await (await begun(self.place, self.client, Arm()))
                self.again += 1
            await asyncio.sleep(SIGN_S)

    async def _attend(self) -> None:
        while not self.client.lost:
            self.client.attend()
            await asyncio.sleep(SIGN_S)

    async def _move(self) -> None:
        while not self.client.lost:
            if moved(self.client.state):
                with suppress(RefusedError, LostError, TimeoutError):
                    await self.client.command(Jog("both", 1 if self.steps % 8 < 4 else -1), within_s=5.0)
                    self.steps += 1
            await asyncio.sleep(0.5)


async def torn_away(place: Place, client: Client, attack: Attack, count: int) -> AsyncIterator[Figure]:
    """The operator repeatedly arms manual mode, others tear control away: it ends each time, and STOP arrives."""
    hand = Hand(place, client)
    with attack(BY_FORCE):
        await asyncio.sleep(SETTLE_S)
        began_s = clock.monotonic()
        arming = asyncio.create_task(hand.arm_by_force())
        try:
            tries = await place.tries(count, kept=True)
            while not hand.again and clock.monotonic() < began_s + ARM_S:
                tries += await place.tries(1, kept=True)
        finally:
            arming.cancel()
        for figure in figures_of(place, "control torn away", tries, began_s):
            yield figure
    yield at_least("control torn away: manual mode armed", hand.again, 1)
    await place.until(client, lambda view: alone(view) and view.mode in ENDED, "the end of manual mode", 60.0)
    yield holds("control torn away: manual mode ends", True, client.state.mode, "OFFLINE")


@dataclass(slots=True)
class Planned:
    """Planning time from an order to its run, per condition, s; 0 before the first run."""

    condition_s: float = 0.0


async def planning(
    place: Place, client: Client, attack: Attack, count: int, conditions: int, planned: Planned
) -> AsyncIterator[Figure]:
    """A large recipe is being planned and handed over: STOP ends that, and nothing moves.

    If the time is known from a smaller recipe, STOP comes before the run: its tables then take ten times as long.
    """
    recipe = place.folder / "big.yaml"
    recipe.write_text(big(conditions), encoding="utf-8")
    order = RunRecipe(str(recipe), speed=1.0, yes=True)
    made: list[tuple[str, float, float | None]] = []
    ends: list[str] = []
    with attack(BY_FORCE):
        await asyncio.sleep(SETTLE_S)
        began_s = clock.monotonic()
        whole_s = BEFORE * planned.condition_s * conditions
        if not planned.condition_s:
            taken = await begun(place, client, order, PLAN_S)
            await taken
            whole_s = clock.monotonic() - began_s
            planned.condition_s = whole_s / conditions
            await asyncio.to_thread(place.end_for_real)
            await over(place, client, taken)
        began_s = clock.monotonic()
        for number in range(count):
            taken = await begun(place, client, order, PLAN_S)
            await asyncio.sleep(whole_s * moment(number, count))
            made += await place.stops(1)
            ends.append(await end_of(place, client, taken, made[-1][0]))
        for figure in figures_of(place, f"planning {conditions} conditions", place.judged(made, kept=True), began_s):
            yield figure
    yield holds("planning: STOP comes within", True, f"{whole_s:.2f} s of the order", "no limit")
    early = sum(end in (REFUSED, AT_ONCE) for end in ends)
    counts = f"{conditions} conditions: " + ", ".join(f"{end} {ends.count(end)}" for end in sorted(set(ends)))
    yield holds("planning: STOP before the first scan, and nothing moves", early + ends.count(LATER) == count,
                counts, f"{REFUSED}, {AT_ONCE} or {LATER}")  # fmt: skip
    yield at_least("planning: tries before the first scan", early, count // 2, "", 0)


REFUSED, AT_ONCE, LATER = "refused", "ended at the first scan", "sent after the first scan"
"""End states of a planned run that received STOP."""


def moment(number: int, count: int) -> float:
    """Return the time of a try as a share of the time from the order to the run: over all of it, every second one near
    its end, when the plan is handed over."""
    return number / count if number % 2 else 0.85 + 0.2 * number / count


async def end_of(place: Place, client: Client, order: asyncio.Task[object], name: str) -> str:
    """Return how a run ended that received STOP under this name."""
    why = await refusal_of(order)
    if why:
        return REFUSED if PROBE in why else why
    if not place.early(name):
        await asyncio.to_thread(place.end_for_real)
    run = await over(place, client, order)
    if not place.early(name):
        return LATER
    return AT_ONCE if name in run.reason and still(Path(run.folder)) else f"it ran: {run.reason}"


async def over(place: Place, client: Client, order: asyncio.Task[object]) -> RunView:
    """Wait for the end of a run, including its tables, and return its reported end."""
    answer = await order
    begun = answer.get("run") if isinstance(answer, dict) else None

    def true(view: StateView) -> bool:
        return view.run is not None and view.run.name == begun and view.run.outcome != "running"

    await place.until(client, true, "the end of a run that was stopped", TABLES_S)
    assert client.state.run is not None
    return client.state.run


BEFORE = 0.7
"""The tries come within this share of the time until the run begins, as measured with a smaller recipe."""
PLAN_S = 1200.0
"""Time to plan 200,000 conditions beside hostile clients, s."""
TABLES_S = 1200.0
"""Time to write the tables of 200,000 conditions, s."""
STILL_M_S = 1e-3
"""A drive at rest shows less, m/s."""


def still(folder: Path) -> bool:
    """Return whether neither wheel nor belt turned in a run, from its record."""
    with RunReader(folder) as reader:
        found = reader.samples()
    turned = [value for name in ("wheel_speed_m_s", "belt_speed_m_s") for value in found[name].tolist()]
    return all(abs(value) < STILL_M_S for value in turned)


async def begun(place: Place, client: Client, action: Action, within_s: float = ARM_S) -> asyncio.Task[object]:
    """Give an order although others tear control away; return the task that waits for its answer. Raises
    NotReachedError."""
    end_s = clock.monotonic() + ARM_S
    while clock.monotonic() < end_s:
        take = asyncio.create_task(place.take_control(client))
        order: asyncio.Task[object] = asyncio.create_task(client.command(action, within_s=within_s))  # right after it
        with suppress(RefusedError, TimeoutError):
            await take
        order.add_done_callback(lambda done: done.cancelled() or done.exception())  # its sender may be gone
        await asyncio.wait({order}, timeout=TAKEN_S)
        if not order.done() or "control" not in await refusal_of(order):
            return order
    raise NotReachedError(f"{action.command}: somebody else had control for {ARM_S:g} s")


async def refusal_of(order: asyncio.Task[object]) -> str:
    """Return why an order was refused, "" if it was not."""
    try:
        await order
    except RefusedError as error:
        return str(error)
    return ""
