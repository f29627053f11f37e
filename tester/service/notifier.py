"""What happens at the rig, as notices for people who are elsewhere. It only makes small messages: another process keeps
and sends them (``notice_forwarder``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from tester.base import clock
from tester.base.words import conditions_done
from tester.notices import causes
from tester.notices.notice import NextNeeded, Notice, NoticeOver
from tester.queue.recover import end_of
from tester.queue.view import QueueView, next_ask
from tester.service.gateway_link import GatewayLink
from tester.service.state_view import PromptView, RunView
from tester.service.values import PlanTrack
from tester.store.run_folders import RunStatus

HOLD: Final = "HOLD"
LOST: Final = ("condition", "warning")
"""Kind and severity of the event of a condition without a value."""
NOTHING: Final = NextNeeded("no run is under way")


@dataclass(frozen=True, slots=True)
class ItemEnd:
    """The end of an item of the queue, in words. ``item``: the item and how it ended; ``follows``: what the queue does
    next by itself; ``todo`` and ``by``: what a person should do, by when.
    """

    item: str
    follows: str
    todo: str
    by: str = ""


def no_item(_view: RunView) -> ItemEnd | None:
    """Return None: a run that no queue has begun."""
    return None


class Notifier:
    """Makes the notices of one service. ``item_of`` returns the queue's words for a run that ends, None without one."""

    def __init__(self, gateway: GatewayLink, rig: str, *, simulated: bool) -> None:
        """``rig``: its name."""
        self._gateway = gateway
        self._rig = f"{rig}, simulated" if simulated else rig
        self.run: RunView | None = None
        """The run under way."""
        self.item_of: Callable[[RunView], ItemEnd | None] = no_item
        self._count = 0
        self._asked = 0
        """Number of the question that waits, 0 if none does."""
        self._held = False
        self._trip_key = ""
        """Key of the trip that ends the run under way."""
        self._queued = NOTHING
        """What the queue does, and the next question behind the run under way."""
        self._expected = NOTHING
        """The ends that the last call expected."""

    def begun(self, view: RunView) -> None:
        """Take the run, or a further part of it, that is under way from now on."""
        self.prompt(None)  # each part counts its questions from 1
        self.run, self._trip_key = view, ""

    # -- what happens ----------------------------------------------------------------------------------------------

    def event(self, kind: str, text: str, severity: str) -> None:
        """Make a notice of an event that the run records, if it is one for people elsewhere."""
        if kind == causes.TRIP:
            notice = self._made(causes.tripped, text)
            self._trip_key = notice.key
            self._gateway.notify(notice)
        elif (kind, severity) == LOST:
            self._gateway.notify(self._made(causes.condition_lost, text))

    def prompt(self, prompt: PromptView | None) -> bool:
        """Look at the question that waits; return whether it is a new one."""
        number = prompt.number if prompt is not None else 0
        if number == self._asked:
            return False
        if self._asked:
            self._over(causes.PROMPT)
        self._asked = number
        if prompt is None:
            return False
        self._gateway.notify(self._made(causes.asked, prompt.text))
        return True

    def mode(self, mode: str, text: str) -> None:
        """Look at the mode of a run."""
        held = mode == HOLD
        if held == self._held:
            return
        self._held = held
        if held:
            self._gateway.notify(self._made(causes.held, text or "held"))
        else:
            self._over("hold")

    def disk(self, text: str) -> None:
        """Make a notice of a disk that has become nearly full."""
        self._gateway.notify(self._made(causes.disk_low, text))

    def ended(self, view: RunView, text: str) -> None:
        """Make a notice of a run's end; one of a queue's item where the queue has words for it.

        The end of a run by a trip has the trip's key: that notice has been sent.
        """
        self.run = view
        outcome = end_of(RunStatus(view.outcome)).value
        if (item := self.item_of(view)) is not None:
            notice = self._item(item, outcome, view)
        else:
            notice = causes.run_ended(self._number(), text, clock.utc_now(), outcome, rig=self._rig, run=view.name,
                                      folder=view.folder)  # fmt: skip
        self._gateway.notify(replace(notice, key=self._trip_key) if outcome == "tripped" and self._trip_key else notice)

    def next(self, track: PlanTrack | None, lapse: float | None) -> None:
        """Tell when a run will need a person. ``lapse``: rig seconds per second, None if unknown."""
        run = self.run
        if track is None or run is None:
            self._tell(self._queued)
            return
        at, question = track.standing(), track.next_question()
        doing = f"run {run.name}: {conditions_done(at.over, at.conditions)}"
        if question is None:
            self._tell(replace(self._queued, doing=doing))
        else:
            self._tell(NextNeeded(doing, clock.utc_in(question[0] / lapse) if lapse else "", question[1]))

    def queue(self, queue: QueueView) -> None:
        """Take the queue as clients see it: the next question is its own where the run under way asks none."""
        ask = next_ask(queue)
        asks = ask is not None or queue.going
        doing = f"the queue: {queue.state}" if asks else NOTHING.doing
        self._queued = NextNeeded(doing, *(ask or ("", "")))
        if self.run is None:
            self._tell(self._queued)

    def _tell(self, expected: NextNeeded) -> None:
        if expected != self._expected:
            self._expected = expected
            self._gateway.notify(expected)

    def over(self) -> None:
        """Withdraw what belonged to a run that is no longer under way."""
        self.prompt(None)
        self.mode("", "")
        self.run, self._trip_key = None, ""
        self.next(None, None)

    # -- its parts -------------------------------------------------------------------------------------------------

    def _made(self, make: Callable[..., Notice], text: str) -> Notice:
        run = self.run
        name, folder = (run.name, run.folder) if run is not None else ("", "")
        return make(self._number(), text, clock.utc_now(), rig=self._rig, run=name, folder=folder)

    def _item(self, item: ItemEnd, outcome: str, view: RunView) -> Notice:
        return causes.item_ended(
            self._number(), item.item, clock.utc_now(), outcome, follows=item.follows, todo=item.todo, by=item.by,
            rig=self._rig, run=view.name, folder=view.folder,
        )  # fmt: skip

    def _over(self, key: str) -> None:
        self._gateway.notify(NoticeOver(self._number(), key))

    def _number(self) -> str:
        self._count += 1
        return f"{self._gateway.service}-{self._count}"
