"""What a person, or a script, can tell a simulated rig while it lives: faults, its speed, how it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import inf, isfinite

from sim.faults import FaultLanguage, FaultScript, FaultTextError, Scene
from sim.faults.operator_faults import ClockJump, Killed, Operator, Stall
from sim.machines import SimulatedMachine
from sim.rig import SimRig
from tester.base import clock

SLOWEST, FASTEST = 0.01, 100.0
"""Bounds of a speed [A]: below, nobody waits for anything; above, no computer keeps up."""

HELP = (
    "fault WHAT [VALUE] [for TIME]   from now on, e.g.: fault belt drive heartbeat lost for 3 s",
    "fault t=TIME: WHAT ...          at a time of the rig's clock, e.g.: fault t=130 s: load cell gain 70 %",
    "faults                          what is wrong now, and what is to come",
    "clear                           end all of it",
    "catalogue [WORD]                every fault there is, or those with a word in their name",
    "speed [X]                       let the rig live X times as fast, for every program at it",
    "idle speed [X]                  the same while no program is on its CAN bus",
    "state                           the rig's true state",
    "end                             end the rig",
)


class RigClock:
    """Seconds of the rig: this computer's clock, ``speed`` times as fast.

    With another speed than 1 every program at the rig sees it live faster or slower than its own clock: a time-out of
    T s in a simulated device is over after T/speed s of the program's clock.
    """

    def __init__(self, speed: float = 1.0, idle_speed: float | None = None, now: Callable[[], float] = clock.monotonic):
        """Begin at 0 s. ``idle_speed`` counts while no program is on the CAN bus, None = ``speed`` then too."""
        self._now = now
        self._origin_s = now()
        self._rig_s = 0.0
        self._controlled = False
        self._speeds = (speed, idle_speed)

    @property
    def speed(self) -> float:
        """Seconds of the rig in a second of this computer's clock, just now."""
        always, idle = self._speeds
        return always if self._controlled or idle is None else idle

    @property
    def idle_speed(self) -> float | None:
        """Speed while no program is on the CAN bus; None = the same as else."""
        return self._speeds[1]

    def __call__(self) -> float:
        """Return seconds of the rig."""
        return self._rig_s + (self._now() - self._origin_s) * self.speed

    def computer_s(self, rig_s: float) -> float:
        """Return this computer's clock at a time of the rig, s, as if the speed had been the same since then."""
        return self._origin_s + (rig_s - self._rig_s) / self.speed

    def set(self, speed: float | None = None, idle_speed: float | None = None) -> None:
        """Go on at other speeds; None leaves one as it is. Raises ValueError for what is no speed."""
        for one in (speed, idle_speed):
            if one is not None and not SLOWEST <= one <= FASTEST:
                raise ValueError(f"a speed is {SLOWEST:g} to {FASTEST:g}, not {one:g}")
        self._settle()
        was, idle = self._speeds
        self._speeds = (was if speed is None else speed, idle if idle_speed is None else idle_speed)

    def controlled(self, so: bool) -> None:
        """Take note whether a program is on the CAN bus."""
        if so is not self._controlled:
            self._settle()
            self._controlled = so

    def _settle(self) -> None:
        at = self._now()
        self._rig_s += (at - self._origin_s) * self.speed
        self._origin_s = at


class SpoiledLife:
    """A rig's life with faults that come by command."""

    def __init__(self, rig: SimRig) -> None:
        """Begin with nothing wrong."""
        self.script = FaultScript()
        self.scene = Scene(rig, _NotHere())
        self._rig = rig

    @property
    def due_s(self) -> float:
        """When the next fault begins or ends, s of the rig."""
        return self.script.due_s

    def advance(self, now: float) -> None:
        """Let the rig live until ``now`` s, and let happen on the way what is to happen."""
        script = self.script
        while script.due_s <= now:
            due_s = max(script.due_s, self._rig.now_s)
            self._live(due_s)
            try:
                script.act(self.scene, due_s)
            except (LookupError, TypeError, AttributeError) as error:  # what a fault is of, this rig does not have
                script.happened.append((due_s, f"a fault did not begin: this rig has no {error}"))
        self._live(now)

    def _live(self, until_s: float) -> None:
        if self.script.renewed:
            self.script.renew(self.scene, self._rig.now_s)
        self._rig.advance(until_s)


class _NotHere:
    """The controlling program of another process: nothing here can stop it or press its keys."""

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

    ``ended`` is set by ``end``. What begins and ends by itself is told to ``say``.
    """

    def __init__(self, life: SpoiledLife, machine: SimulatedMachine, rig: SimRig, clock: RigClock) -> None:
        """Speak for a rig."""
        self._life = life
        self._machine = machine
        self._rig = rig
        self._clock = clock
        self._language: FaultLanguage | None = None
        self.ended = False

    def command(self, line: str, now: float) -> Sequence[str]:
        """Do what a line says at ``now`` s of the rig. Whatever it says, the answer is text: nothing is raised."""
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
                return (f"{count} ended; nothing is to come",)
            case ["catalogue", *word]:
                known = sorted(self._known().catalogue)
                found = tuple(phrase for phrase in known if all(one in phrase for one in word))
                return found or ("none of that name",)
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
                return HELP
            case _:
                return (f"unknown command {line!r}; help lists them",)

    def happened(self) -> list[str]:
        """Return what has begun and ended since the last call."""
        said = [f"{t:.3f} s  {text}" for t, text in self._life.script.happened]
        self._life.script.happened.clear()
        return said

    def status(self) -> str:
        """Return the rig in one line."""
        script = self._life.script
        wrong = f"{len(script.active)} wrong" if script.active else "nothing wrong"
        return f"{self._rig.now_s:.1f} s  x{self._clock.speed:g}  {wrong}  {'  '.join(self._state())}"

    def _known(self) -> FaultLanguage:
        if self._language is None:
            self._language = self._machine.language()
        return self._language

    def _fault(self, what: str, now: float) -> Sequence[str]:
        timed = ":" in what
        try:
            injection = self._known().parse(what if timed else f"t={now:.6f} s: {what}")
        except FaultTextError as error:
            return str(error).splitlines()
        when = injection.when
        if when.at_s == inf:
            return ("no fault: scans and steps are those of the program at the rig; expected 't=TIME: ...' or no time",)
        if isinstance(injection.kind.effect(injection.value), Stall | Killed | ClockJump | Operator):
            return (f"no fault: {injection.kind.phrase!r} concerns the program at the rig, which is another process",)
        if timed and when.at_s < now:
            return (f"no fault: it is {now:.3f} s already",)
        injection = replace(injection.shifted(0.0), text=what if not timed else what.partition(":")[2].strip())
        self._life.script.add([injection])
        lasts = "until clear" if injection.lasts_s == inf else f"for {injection.lasts_s:g} s"
        return (f"{injection.kind.phrase}: from {when.at_s:.3f} s, {lasts}",)

    def _faults(self, now: float) -> Sequence[str]:
        script = self._life.script
        ends = {id(one.effect): one.at_s for one in script.planned if not one.begins}
        said = [
            f"now: {one.text}" + (f" (ends at {ends[id(one.effect)]:.3f} s)" if id(one.effect) in ends else "")
            for one in script.active
        ]
        said += [f"in {one.at_s - now:.1f} s: {one.text}" for one in script.planned if one.begins]
        return said or ("nothing is wrong",)

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
        said = f"{speed:g} x: 100 ms of a device's time-out are over after {100.0 / speed:.3g} ms of a program's clock"
        return (said, *([f"{idle_speed:g} x while no program is on the CAN bus"] if idle_speed is not None else []))

    def _state(self) -> list[str]:
        row = self._machine.log_row(self._rig)
        columns = zip(self._machine.log_columns, row, self._machine.log_decimals, strict=True)
        return [f"{name} {value:.{digits}f}" for name, value, digits in columns]
