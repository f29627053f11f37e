"""Carries out clients' commands for the rig, or refuses them."""

from __future__ import annotations

from tester.machine.prompts import NOT_YET
from tester.machine.state import Mode
from tester.service.commands import (
    Acknowledge,
    Answer,
    Arm,
    Hold,
    Jog,
    QueueOrder,
    Release,
    ResumeRun,
    RunEdit,
    RunRecipe,
    Stop,
    Tare,
)
from tester.service.queue_desk import QueueDesk
from tester.service.run_edits import RunEdits
from tester.service.service_link import Order
from tester.service.state_publisher import Desk


class Orders:
    """Carries out orders between two ticks. It leaves longer work (``job``) to the service's loop."""

    def __init__(self, desk: Desk) -> None:
        """Begin with nothing under way."""
        self.desk = desk
        self.job: Order | None = None
        self.armed_by = 0
        """Number of the client that armed manual mode."""
        self.ending = False
        self.queue: QueueDesk | None = None
        """The queue, once the service has one."""
        self.edits = RunEdits(desk)
        desk.obey, desk.stop, desk.lost_control = self.obey, self.stop, self.lost_control

    def look(self) -> None:
        """Carry on with the queue, and with notes and exclusions."""
        if self.queue is not None:
            self.queue.look()
        self.edits.look()

    def obey(self, order: Order) -> None:
        """Carry out an order, or refuse it with a reason."""
        action = order.action
        if isinstance(action, Stop):
            self.stop(order.by, action.fast)
            self.desk.gateway.accept(order)
        elif isinstance(action, RunRecipe | ResumeRun):
            self._begin(order)
        elif isinstance(action, QueueOrder):
            if self.queue is None:
                self.desk.gateway.refuse(order, "this service has no queue")
            else:
                self.queue.obey(order, action)
        elif isinstance(action, RunEdit):
            self.edits.obey(order)
        elif isinstance(action, Arm):
            self._arm(order, action)
        elif isinstance(action, Acknowledge):
            self._acknowledge(order, action)
        elif isinstance(action, Answer):
            self._reply(order, self._answer(order, action))
        elif isinstance(action, Jog | Tare):
            self._reply(order, self._by_hand(order, action))
        else:
            self._reply(order, self._hold(order, action))

    def _reply(self, order: Order, refusal: str) -> None:
        gateway = self.desk.gateway
        if refusal:
            gateway.refuse(order, refusal)
        else:
            gateway.accept(order)

    def stop(self, name: str, fast: bool) -> None:
        """Carry out STOP from any client, whatever is under way."""
        desk = self.desk
        kind = "fast stop" if fast else "stop"
        desk.command(f"{kind} by {name}", "warning")
        if self.queue is not None:
            self.queue.stopped(f"{kind} by {name}")
        if desk.watch is not None:
            if desk.watch.run.engine.control.state.mode is Mode.LATCHED:
                desk.watch.run.stays_latched = False  # its cause may never clear; the desk stays latched
            desk.watch.run.request_stop(f"{kind} by {name}", fast=fast)
            desk.stop_rest(fast)
        elif self.job is not None:
            desk.gateway.refuse(self.job, f"{kind} by {name}")
            self.job = None

    def end_item(self, reason: str) -> None:
        """Stop the running item of the queue in a controlled way; the queue itself continues if that is on record."""
        watch = self.desk.watch
        if watch is not None:
            watch.run.request_stop(reason)
            self.desk.stop_rest(False)
        elif self.job is not None:
            self.job = None

    def _hold(self, order: Order, action: Hold | Release) -> str:
        """Hold or release a run; return "" or the reason for refusing."""
        watch = self.desk.watch
        if watch is None:
            return "nothing runs"
        name = "hold" if isinstance(action, Hold) else "release"
        self.desk.command(f"{name} by {order.by}")
        run = watch.run
        if isinstance(action, Hold):
            return run.request_hold(f"held by {order.by}")
        return run.request_release(f"released by {order.by}")

    def _acknowledge(self, order: Order, action: Acknowledge) -> None:
        """Acknowledge alarms, a latched rig, and interrupted runs. Nothing moves.

        A latched rig is acknowledged with all alarms, or with the alarm of its trip. The number of another alarm leaves
        it latched.
        """
        desk, watch = self.desk, self.desk.watch
        tripped = watch.tripped if watch is not None else desk.tripped
        trip = next((alarm.number for alarm in desk.alarms.listed() if alarm.name == tripped), 0)
        desk.command(f"ack {action.number or 'all'} by {order.by}")
        count = desk.alarms.acknowledge(action.number, order.by)
        refusal = "" if count or desk.latched or desk.interrupted else "nothing to acknowledge"
        if action.number in (0, trip):
            if watch is None:
                desk.unlatch(order.by)
            elif watch.run.engine.control.state.mode is Mode.LATCHED:
                refusal = watch.run.request_ack(order.by)
        self._reply(order, refusal)

    def _answer(self, order: Order, action: Answer) -> str:
        """Answer the waiting prompt; return "" or the reason for refusing."""
        watch = self.desk.watch
        waiting = watch.run.engine.ctx.prompts.waiting if watch is not None else None
        if waiting is None or waiting.number != action.number:
            return f"prompt {action.number} does not wait for an answer"
        self.desk.command(f"answer {action.answer} by {order.by}")
        if action.answer == NOT_YET:
            return ""
        refusal = waiting.reply(action.answer)
        if not refusal:
            waiting.by = order.by
        return refusal

    def _by_hand(self, order: Order, action: Jog | Tare) -> str:
        """Move one step in manual mode; return "" or the reason for refusing."""
        desk = self.desk
        if desk.hand is None or desk.watch is None or desk.watch.mode[0] != "RUN":
            return "manual mode is not armed"
        ctx = desk.watch.run.engine.ctx
        if isinstance(action, Tare):
            desk.command(f"tare by {order.by}")
            return desk.hand.tare(ctx)
        names = [axis.name for axis in desk.watch.kind.machine.hand]
        if action.axis not in names:
            return f"no axis {action.axis!r} for manual mode here: {', '.join(names)}"
        desk.command(f"jog {action.axis} {action.direction:+d} by {order.by}", "debug")
        return desk.hand.jog(ctx, action.axis, action.direction)

    def lost_control(self) -> None:
        """Disarm manual mode if the client that armed it has lost control."""
        hand = self.desk.hand
        if hand is not None and self.desk.gateway.presence.controller_id != self.armed_by:
            hand.disarm()

    def _begin(self, order: Order) -> None:
        """Accept an order that begins work, if no work is under way."""
        refusal = self.occupied()
        if not refusal and self.queue is not None and self.queue.going:
            refusal = "the queue is going: let it stand first (`tester queue stand`)"
        if refusal:
            self.desk.gateway.refuse(order, refusal)
        else:
            self.job = order

    def occupied(self) -> str:
        """Return why no work may begin; "" if it may."""
        desk = self.desk
        if self.ending:
            return "the service is ending"
        if desk.hand is not None:
            return "manual mode is armed"
        if desk.watch is not None or self.job is not None:
            return f"a run is under way: {desk.run.name if desk.run is not None else 'it begins'}"
        if desk.latched:
            return f"the rig is latched ({desk.latched}): acknowledge first"
        return ""

    def _arm(self, order: Order, action: Arm) -> None:
        if action.on:
            self._begin(order)
            return
        hand = self.desk.hand
        if hand is not None:
            self.desk.command(f"disarm by {order.by}")
            hand.disarm()
        self._reply(order, "" if hand is not None else "manual mode is not armed")
