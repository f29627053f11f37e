"""A run on a simulated rig with scripted faults: a layer between the ticker and the run with its rig."""

from __future__ import annotations

from collections.abc import Callable
from math import inf

from drivers.ports import CanFrame, CanPort, CanWatcher, LinePort, LineWatcher, Unwatch
from sim.faults import FaultScript, Scene
from sim.rig import SimRig
from tester.machine.run import Run

RIG_STEP_S = 0.01
"""Time step of the rig while no controlling process runs, s."""


class Skew:
    """How far the computer's clock is ahead of the rig's clock, s."""

    __slots__ = ("ahead_s",)

    def __init__(self) -> None:
        """Begin without a difference."""
        self.ahead_s = 0.0


class SkewedCan:
    """A CAN port that reports times of the computer's own clock."""

    def __init__(self, port: CanPort, skew: Skew) -> None:
        """Wrap ``port``, changing its times by ``skew``."""
        self.port = port
        self.skew = skew

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Send a frame; raises BusLost."""
        self.port.send(can_id, data, now - self.skew.ahead_s)

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Send the frames of a bus cycle; raises BusLost."""
        self.port.send_cycle(can_ids, payloads, now - self.skew.ahead_s)

    def receive(self, now: float) -> list[CanFrame]:
        """Return the frames that arrived, stamped with the computer's clock; raises BusLost."""
        ahead_s = self.skew.ahead_s
        return [(t + ahead_s, can_id, data) for t, can_id, data in self.port.receive(now - ahead_s)]

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Call ``watcher`` with every frame, stamped with the computer's clock."""
        return self.port.watch(lambda t, can_id, data, sent: watcher(t + self.skew.ahead_s, can_id, data, sent))


class SkewedLine:
    """A Modbus line that reports times of the computer's own clock."""

    def __init__(self, port: LinePort, skew: Skew) -> None:
        """Wrap ``port``, changing its times by ``skew``."""
        self.port = port
        self.skew = skew

    def write(self, data: bytes, now: float) -> None:
        """Send bytes; raises BusLost."""
        self.port.write(data, now - self.skew.ahead_s)

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Return the bytes that arrived, stamped with the computer's clock; raises BusLost."""
        ahead_s = self.skew.ahead_s
        return [(t + ahead_s, data) for t, data in self.port.read(now - ahead_s)]

    def watch(self, watcher: LineWatcher) -> Unwatch:
        """Call ``watcher`` with all bytes, stamped with the computer's clock."""
        return self.port.watch(lambda t, data, sent: watcher(t + self.skew.ahead_s, data, sent))


class FaultyRun:
    """A run and its rig under a fault script. A ticker drives this object in place of both (``Ticked`` and ``World``).

    ``killed`` is set when the controlling process is killed; ``on_kill``, if given, is then called.
    """

    def __init__(self, run: Run, rig: SimRig, script: FaultScript, on_kill: Callable[[], None] | None = None) -> None:
        """Begin with the script's faults for time 0 s."""
        self.run = run
        self.script = script
        self.killed = False
        self.skew = Skew()
        self._scene = Scene(rig, self)
        self._rig = rig
        self._stalled_until_s = -inf
        self._now_s = 0.0
        self._step = -1
        self._phase = ""
        self._measured = (0, 0)
        self._on_kill = on_kill

    # the ticker's side ---------------------------------------------------------------------------------------

    @property
    def finished(self) -> bool:
        """Whether the run has nothing left to do."""
        return self.run.finished

    @property
    def waiting(self) -> bool:
        """Whether a prompt waits for a person."""
        return self.run.waiting

    @property
    def urgent_s(self) -> float:
        """Time of the next arrival that a scan should not wait for, or of the next scripted fault, s."""
        urgent = self.script.due_s
        if not self.killed and self._stalled_until_s <= self._now_s:
            urgent = min(urgent, self._rig.urgent_s)
        return urgent

    def advance(self, now: float) -> None:
        """Advance the rig to ``now`` s, beginning and ending faults on the way."""
        script, scene = self.script, self._scene
        while script.due_s <= now:
            due_s = max(script.due_s, self._now_s)
            self._live(due_s)
            script.act(scene, due_s)
        self._live(now)
        if script.happened:
            self._tell(now)

    def tick(self, now: float) -> float:
        """Do what is due in the controlling process, unless it is killed or stalled."""
        if self.killed:
            return now + RIG_STEP_S
        if now < self._stalled_until_s:
            return min(self._stalled_until_s, now + RIG_STEP_S)
        ahead_s = self.skew.ahead_s
        due = self.run.tick(now + ahead_s) - ahead_s
        if self.script.waiting:
            self._notice(now)
        return due

    def _live(self, until_s: float) -> None:
        script, rig = self.script, self._rig
        if script.renewed:
            script.renew(self._scene, rig.now_s)
        rig.advance(until_s)
        self._now_s = until_s

    def _notice(self, now: float) -> None:
        """Report the run's position to the script; the names of a step count once, when the step begins."""
        engine = self.run.engine
        progress = engine.ctx.progress
        names: list[str] = []
        if progress.step != self._step:
            self._step = progress.step
            names += progress.title.split() if progress.step else ["connect"]
            if ":" in progress.title and next(engine.executor.plan.conditions(), None) is not None:
                names.append("soak")
        phase = progress.phase.split(" ")[0]
        if phase != self._phase:
            self._phase = phase
            names.append(phase)
        measured = (progress.condition, progress.repeat)
        if measured != self._measured:
            if measured[0] != self._measured[0]:
                names.append(f"condition {measured[0]}")
            names.append(f"condition {measured[0]}/{measured[1]}")
            self._measured = measured
        self.script.notice(now, engine.scans, names)

    def _tell(self, now: float) -> None:
        """Record the faults that occurred in the run's journal."""
        for t, text in self.script.happened:
            self.run.engine.ctx.journal.event(t, "injected", text)
        self.script.happened.clear()

    # the script's side ---------------------------------------------------------------------------------------

    def stall(self, seconds: float) -> None:
        """Perform no scan for this many seconds."""
        self._stalled_until_s = max(self._stalled_until_s, self._now_s + seconds)

    def kill(self) -> None:
        """Perform no further scan."""
        self.killed = True
        if self._on_kill is not None:
            self._on_kill()

    def jump(self, seconds: float) -> None:
        """Move the computer's clock ahead by this many more seconds."""
        if self.skew.ahead_s == 0.0:
            devices = self.run.engine.devices
            lines = [SkewedLine(port, self.skew) for port, _ in devices.lines]
            devices.rewire(SkewedCan(devices.can, self.skew), lines)
        self.skew.ahead_s += seconds

    def operate(self, action: str) -> None:
        """Press one of the operator's keys, by its name."""
        run = self.run
        if action == "hold":
            run.request_hold()
        elif action == "release":
            run.request_release()
        else:
            run.request_stop(f"operator: {action}", fast=action == "fast stop")
