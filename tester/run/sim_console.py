"""Commands that a person or a script gives a simulated rig while it runs: faults, hands at it, its speed, its state."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf, isfinite

from sim.faults import FaultLanguage, FaultScript, FaultTextError, Scene
from sim.faults.cabinet import OfComputer
from sim.hands import DONE, REFUSED, Verb, by_word
from sim.machines import SimulatedMachine
from sim.rig import SimRig
from tester.base import clock
from tester.base.source import InvalidSource

SLOWEST, FASTEST = 0.01, 100.0
"""Limits of the speed [A]: a slower rig takes too long to watch; no computer keeps up with a faster one."""

HELP = (
    "fault WHAT [VALUE] [for TIME]   from now on, e.g.: fault belt drive heartbeat lost for 3 s",
    "fault t=TIME: WHAT ...          at a time of the rig's clock, e.g.: fault t=130 s: load cell gain 70 %",
    "faults                          list active and planned faults",
    "clear                           end all faults",
    "catalogue [WORD]                list all faults, or those with a word in their name",
    "speed [X]                       run the rig X times as fast, for every program at it",
    "idle speed [X]                  the same while no program is on its CAN bus",
    "state                           the rig's true state",
    "end                             end the rig",
)


class RigClock:
    """The rig's time in s: this computer's clock, ``speed`` times as fast.

    At any speed but 1, a program connected to the rig sees it run faster or slower than the program's own clock: a
    time-out of T s in a simulated device takes T/speed s of that clock.
    """

    def __init__(self, speed: float = 1.0, idle_speed: float | None = None, now: Callable[[], float] = clock.monotonic):
        """Begin at 0 s. ``idle_speed`` applies while no program is on the CAN bus; None: ``speed`` always applies."""
        self._now = now
        self._origin_s = now()
        self._rig_s = 0.0
        self._controlled = False
        self._speeds = (speed, idle_speed)

    @property
    def speed(self) -> float:
        """Present number of rig seconds in a second of this computer's clock."""
        always, idle = self._speeds
        return always if self._controlled or idle is None else idle

    @property
    def idle_speed(self) -> float | None:
        """Speed while no program is on the CAN bus; None = ``speed``."""
        return self._speeds[1]

    def __call__(self) -> float:
        """Return the rig's time, s."""
        return self._rig_s + (self._now() - self._origin_s) * self.speed

    def computer_s(self, rig_s: float) -> float:
        """Return the time of this computer's clock at a rig time, s, as if the present speed had applied since then."""
        return self._origin_s + (rig_s - self._rig_s) / self.speed

    def set(self, speed: float | None = None, idle_speed: float | None = None) -> None:
        """Change the speeds; None keeps a speed. Raises ValueError for a speed beyond the limits."""
        for value in (speed, idle_speed):
            if value is not None and not SLOWEST <= value <= FASTEST:
                raise ValueError(f"a speed is {SLOWEST:g} to {FASTEST:g}, not {value:g}")
        self._settle()
        was, idle = self._speeds
        self._speeds = (was if speed is None else speed, idle if idle_speed is None else idle_speed)

    def controlled(self, so: bool) -> None:
        """Set whether a program is on the CAN bus."""
        if so is not self._controlled:
            self._settle()
            self._controlled = so

    def _settle(self) -> None:
        at = self._now()
        self._rig_s += (at - self._origin_s) * self.speed
        self._origin_s = at


class SpoiledLife:
    """Advances a rig, with faults that commands cause."""

    def __init__(self, rig: SimRig) -> None:
        """Begin without faults."""
        self.script = FaultScript()
        self.scene = Scene(rig, _NotHere())
        self._rig = rig

    @property
    def due_s(self) -> float:
        """Return when the next fault begins or ends, in rig seconds."""
        return self.script.due_s

    def advance(self, now: float) -> None:
        """Advance the rig to ``now`` s, beginning and ending faults on the way."""
        script = self.script
        while script.due_s <= now:
            due_s = max(script.due_s, self._rig.now_s)
            self._live(due_s)
            try:
                script.act(self.scene, due_s)
            except (LookupError, TypeError, AttributeError) as error:  # the rig lacks the part that the fault concerns
                script.happened.append((due_s, f"a fault did not begin: this rig has no {error}"))
        self._live(now)

    def _live(self, until_s: float) -> None:
        if self.script.renewed:
            self.script.renew(self.scene, self._rig.now_s)
        self._rig.advance(until_s)


class _NotHere:
    """Replaces the controlling program, which runs in another process: faults cannot stop it or press its keys."""

    def stall(self, seconds: float) -> None:
        """Do nothing."""

    def kill(self) -> None:
        """Do nothing."""

    def jump(self, seconds: float) -> None:
        """Do nothing."""

    def operate(self, action: str) -> None:
        """Do nothing."""


class SimConsole:
    """Answers commands: ``command`` takes a line and the rig's time, and returns the lines of the answer.

    ``ended`` is set by the command ``end``. ``happened`` returns the faults that began or ended without a command.
    """

    def __init__(
        self, life: SpoiledLife, machine: SimulatedMachine, language: FaultLanguage, rig: SimRig, clock: RigClock
    ) -> None:
        """Begin a console for a rig; ``language``: of its fault scripts."""
        self._life = life
        self._machine = machine
        self._rig = rig
        self._clock = clock
        self._language = language
        self._verbs = by_word(machine.verbs)
        self.ended = False

    def command(self, line: str, now: float) -> Sequence[str]:
        """Carry out a command at rig time ``now``, s. The answer reports an error as text; none is raised."""
        words = line.split()
        match words:
            case []:
                return ()
            case ["fault", *what] if what:
                return self._fault(" ".join(what), now)
            case ["faults"]:
                return self._faults(now)
            case ["clear"]:
                count = len(self._life.script.active)
                self._life.script.clear(self._life.scene, now)
                return (f"{count} ended; no fault is planned",)
            case ["catalogue", *word]:
                known = sorted(self._language.catalogue)
                matching = tuple(phrase for phrase in known if all(part in phrase for part in word))
                return matching or ("none of that name",)
            case ["speed", *factor]:
                return self._speed(factor, idle=False)
            case ["idle", "speed", *factor]:
                return self._speed(factor, idle=True)
            case ["state"]:
                return self._state()
            case ["end"]:
                self.ended = True
                return ("ending",)
            case ["help" | "?"]:
                return (*HELP, *(f"{verb.form:<31} {verb.about}" for verb in self._verbs.values()))
            case [word, *_] if word in self._verbs:
                return (self._hand(self._verbs[word], line),)
            case _:
                return (f"unknown command {line!r}; help lists them",)

    def _hand(self, verb: Verb, line: str) -> str:
        try:
            verb.act(self._rig, shlex.split(line)[1:])
        except (ValueError, InvalidSource) as error:
            return f"{REFUSED}{' '.join(str(error).split())}"
        return DONE + line.strip()

    def happened(self) -> list[str]:
        """Return the faults that began and ended since the last call."""
        lines = [f"{t:.3f} s  {text}" for t, text in self._life.script.happened]
        self._life.script.happened.clear()
        return lines

    def status(self) -> str:
        """Return the rig's state in one line."""
        script = self._life.script
        wrong = f"{len(script.active)} wrong" if script.active else "nothing wrong"
        return f"{self._rig.now_s:.1f} s  x{self._clock.speed:g}  {wrong}  {'  '.join(self._state())}"

    def _fault(self, what: str, now: float) -> Sequence[str]:
        timed = ":" in what
        try:
            injection = self._language.parse(what if timed else f"t={now:.6f} s: {what}")
        except FaultTextError as error:
            return str(error).splitlines()
        when = injection.when
        if when.at_s == inf:
            return ("no fault: this console knows no scans or steps of the program; expected 't=TIME: ...' or no time",)
        if isinstance(injection.kind.effect(injection.value), OfComputer):
            return (f"no fault: {injection.kind.phrase!r} concerns the program at the rig, which is another process",)
        if timed and when.at_s < now:
            return (f"no fault: it is {now:.3f} s already",)
        injection = replace(injection.shifted(0.0), text=what if not timed else what.partition(":")[2].strip())
        self._life.script.add([injection])
        lasts = "until clear" if injection.lasts_s == inf else f"for {injection.lasts_s:g} s"
        return (f"{injection.kind.phrase}: from {when.at_s:.3f} s, {lasts}",)

    def _faults(self, now: float) -> Sequence[str]:
        script = self._life.script
        ends = {id(change.effect): change.at_s for change in script.planned if not change.begins}
        lines = [
            f"now: {change.text}" + (f" (ends at {ends[id(change.effect)]:.3f} s)" if id(change.effect) in ends else "")
            for change in script.active
        ]
        lines += [f"in {change.at_s - now:.1f} s: {change.text}" for change in script.planned if change.begins]
        return lines or ("nothing is wrong",)

    def _speed(self, words: Sequence[str], *, idle: bool) -> Sequence[str]:
        try:
            if words:
                [text] = words
                factor = float(text.removeprefix("x").removesuffix("x"))
                if not isfinite(factor):
                    raise ValueError(f"a speed is {SLOWEST:g} to {FASTEST:g}, not {text}")
                self._clock.set(**{"idle_speed" if idle else "speed": factor})
        except ValueError as error:
            return (str(error),)
        speed, idle_speed = self._clock.speed, self._clock.idle_speed
        answer = f"{speed:g} x: a device's time-out of 100 ms takes {100.0 / speed:.3g} ms of a program's clock"
        return (answer, *([f"{idle_speed:g} x while no program is on the CAN bus"] if idle_speed is not None else []))

    def _state(self) -> list[str]:
        row = self._machine.log_row(self._rig)
        columns = zip(self._machine.log_columns, row, self._machine.log_decimals, strict=True)
        return [f"{name} {value:.{digits}f}" for name, value, digits in columns]
