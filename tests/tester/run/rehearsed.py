"""A recipe on a simulated rig in virtual time, with the rig's own hands or hands behind its console."""

from __future__ import annotations

from collections.abc import Iterable

from sim import machines
from sim.rig import SimRig
from tester.analysis.results import Burst, RepeatResult
from tester.inputs.rig import Rig
from tester.machine.prompts import Prompts
from tester.machine.run import Run
from tester.machine.run_parts import RunSetup
from tester.machine.tickers import next_tick
from tester.run.kind_lookup import recipe_part, run_parts
from tester.run.remote_hands import RemoteHands
from tester.run.sim_console import RigClock, SimConsole, SpoiledLife
from tester.run.simulated import simulated_ports, spec_of
from tester.store.recorder import NullRecorder
from tester.store.sql import Judged, Ticket
from tests.tester.inputs.recipe.texts import load_recipe

LONGEST_S = 20_000.0


class Kept(NullRecorder):
    """Keeps repeats, trips and the hands' actions."""

    def __init__(self) -> None:
        super().__init__()
        self.repeats: list[RepeatResult] = []
        self.trips: list[str] = []
        self.hands: list[str] = []

    def commit_repeat(
        self, key: int, result: RepeatResult, bursts: Iterable[Burst] = (), judged: Judged | None = None
    ) -> Ticket:
        """Keep a repeat."""
        self.repeats.append(result)
        return Ticket(done=True)

    def trip(
        self, t_s: float, interlock: str, text: str, value: float = 0.0, limit: float = 0.0, unit: str = ""
    ) -> int:
        """Keep a trip."""
        self.trips.append(interlock)
        return len(self.trips)

    def event(self, t_s: float, kind: str, text: str, severity: str = "info", data: str = "") -> None:
        """Keep an action of the hands."""
        if kind == "hands":
            self.hands.append(text)


class ToConsole:
    """A channel to a console in this process; a line that is ``deaf_to`` is neither done nor answered."""

    def __init__(self, rig: Rig, world: SimRig) -> None:
        machine = machines.find(run_parts(rig).plant)
        self.console = SimConsole(SpoiledLife(world), machine, machine.language(spec_of(rig)), world, RigClock())
        self.world = world
        self.lines: list[str] = []
        self.deaf_to = ""
        self._answers = b""

    def send(self, data: bytes) -> None:
        for line in data.decode().splitlines():
            self.lines.append(line)
            if line != self.deaf_to:
                answer = "".join(f"{text}\n" for text in self.console.command(line, self.world.now_s))
                self._answers += f"{answer}\n".encode()

    def receive(self) -> bytes:
        cut = max(len(self._answers) // 2, 1)  # an answer arrives in pieces
        data, self._answers = self._answers[:cut], self._answers[cut:]
        return data

    def close(self) -> None:
        pass


class Rehearsal:
    """A run of a recipe, ticked by hand; ``remote``: its hands are behind the machine's console."""

    def __init__(self, rig: Rig, recipe: str, *, remote: bool, seed: int = 0) -> None:
        part = recipe_part(rig)
        plan = part.expand(load_recipe(recipe, part, "rehearsal.yaml").recipe, rig)
        ports, world, attendant = simulated_ports(rig, seed, None)
        self.world, self.kept = world, Kept()
        self.channel = ToConsole(rig, world)
        hands = None
        if remote:
            verbs = machines.find(run_parts(rig).plant).verbs
            attendant = hands = RemoteHands(self.channel, verbs, "the console", self.kept)
        self.run: Run = run_parts(rig).build(
            RunSetup(rig, plan, ports, attendant, self.kept, Prompts(automatic=True))
        )
        self.run.engine.executor.hands = hands
        self.now = 0.0

    def tick(self) -> None:
        """Let the rig live until the next tick and do it."""
        self.world.advance(self.now)
        self.now = next_tick(self.now, self.run.tick(self.now), self.world.urgent_s)

    def to_the_end(self) -> Rehearsal:
        """Tick until the run is over."""
        while not self.run.finished:
            assert self.now < LONGEST_S
            self.tick()
        return self
