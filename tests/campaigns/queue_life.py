"""One random life of a queue, for ``tests.campaigns.queue``: services that follow each other on one record."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path
from random import Random
from types import SimpleNamespace
from unittest.mock import patch

from tester.base.screen import Check
from tester.inputs.rig import Rig
from tester.queue.assess import Assessment, AssessTask
from tester.queue.decide import CALIBRATION, CEILINGS, DISK, FREE, RECIPE, RIG, SPECIMEN
from tester.queue.fold import Queue
from tester.queue.items import Hashes, Needs
from tester.queue.places import queue_folder
from tester.queue.record import RECORD, QueueRecord, read_queue
from tester.queue.view import QueueView
from tester.run.kind_lookup import load_rig
from tester.run.session_options import SessionOptions
from tester.service.alarms import Cause
from tester.service.commands import QueueAdd, QueueDrop, QueueMove, QueueSkip, QueueStand, QueueStart, RigAction, Stop
from tester.service.preflight import Past
from tester.service.service import Service, ServiceOptions
from tester.service.service_link import Order, Presence
from tester.service.state_view import RunView
from tester.store.disk import FreeRoom
from tester.store.run_folders import RunStatus
from tests.campaigns.acceptance.figure import Figure, equal
from tests.tester.service.stage import Script
from tests.tester.service.stage import Stage as ServiceStage

SIM: Rig = load_rig("sim")
OPS = 60
"""Number of acts of a life."""
TURNS_MOST = 4000


class Killed(BaseException):
    """The process was killed."""


@dataclass(slots=True)
class World:
    """The true state, and the true events."""

    rig: str = "rig 0"
    disk: bool = True
    alarm: bool = False
    person: bool = False
    """Whether a person has started the queue since the last stop, trip, failure or restart."""
    asks: bool = False
    stood: bool = False
    """Whether a person paused the queue during an item."""
    begun: Counter[int] = field(default_factory=Counter[int])
    """Runs that truly began, by item."""
    over: dict[int, RunStatus] = field(default_factory=dict[int, RunStatus])
    confirmed: set[int] = field(default_factory=set[int])
    """Items whose add command was answered."""
    looked: set[int] = field(default_factory=set[int])
    """Items for which the rig was inspected since they last began."""


class KnownPast:
    """The specimen that the last run left."""

    known = True

    def usable(self, rig: Rig) -> bool:
        return True


class FakeAssessor:
    """Assesses the state of the world."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._task: AssessTask | None = None

    @property
    def busy(self) -> bool:
        return self._task is not None

    def begin(self, task: AssessTask) -> None:
        self._task = task

    def poll(self) -> Assessment | None:
        task, world = self._task, self._world
        self._task = None
        assert task is not None
        if task.then is not None:
            world.looked.add(int(Path(task.folder).name))
        hashes = Hashes(sha256(world.rig.encode()).hexdigest(), "calibration")
        differs = () if task.then is None or task.then == hashes else (f"the rig file changed to {world.rig}",)
        oks = {FREE: True, RIG: True, SPECIMEN: True, RECIPE: not differs, CALIBRATION: True, DISK: world.disk,
               CEILINGS: True}  # fmt: skip
        checks = tuple(Check(name, ok, "; ".join(differs) if name == RECIPE else "") for name, ok in oks.items())
        return Assessment((), "fake", "recipe: fake", "0", "", SIM.name, True, hashes, Needs(60.0, 50.0, 80.0, 1, 1),
                          checks, differs)  # fmt: skip

    def end(self) -> None:
        self._task = None


class Life:
    """A life: successive services until the acts are used up; ``misses`` then lists the faults."""

    def __init__(self, folder: Path, random: Random) -> None:
        """Live in ``folder``."""
        self.folder = folder
        self.runs = folder / "runs"
        self.random = random
        self.world = World()
        self.misses: list[str] = []
        self.counts: Counter[str] = Counter()
        self.acts = OPS
        self._now_s = 0.0
        self._views: QueueView | None = None

    @property
    def record(self) -> Path:
        """The queue's record."""
        return queue_folder(self.runs, SIM.name, simulated=True) / RECORD

    def live(self) -> None:
        """Live to the end, and judge."""
        while self.acts > 0:
            self.world.person = False
            with suppress(Killed), self._patched() as stage:
                assert stage.service is not None
                stage.service.serve()
                stage.service = None
        self._judge()

    @contextmanager
    def _patched(self) -> Iterator[QueueStage]:
        """Make a service with fake time, planning and run, in which a write of the record may be cut."""
        stage = QueueStage(self)
        with patch("tester.service.service.load_rig", lambda *_: SIM), \
             patch("tester.service.service.past_of", lambda *_: Past("done", "", KnownPast())), \
             patch("tester.service.service.aside", lambda work, _look: work()), \
             patch("tester.service.service.interrupted_runs", lambda _runs: iter(())), \
             patch("tester.base.clock.monotonic", self._tick), \
             patch("tester.base.clock.sleep_until", lambda _s: 0.0), \
             patch("tester.service.queue_changes.ThreadPoolExecutor", InlineExecutor), \
             patch.object(FreeRoom, "look", _roomy), \
             patch("tester.queue.recover.run_of", self._run_of), \
             patch.object(QueueRecord, "_write", self._writer()), \
             patch.object(Service, "_session", self._session):  # fmt: skip
            service = stage.service = Service(ServiceOptions("sim", (), self.runs), stage)
            if self.world.alarm:
                service.desk.alarms.raise_(Cause("drawn", 2, "drawn", ""), 0.0)
            service.queue._assessor = FakeAssessor(self.world)  # pyright: ignore[reportAttributeAccessIssue]
            try:
                yield stage
            finally:
                self._bury(service)

    def _bury(self, service: Service) -> None:
        """Release the resources that the operating system would release after a process dies."""
        changes = service.queue.changes
        if changes is not None:
            changes._thread.shutdown()
            changes.record.close()
        service.queue._use.release()

    def _tick(self) -> float:
        self._now_s += 0.05
        return self._now_s

    def _writer(self) -> Callable[[QueueRecord, bytes], None]:
        random, real = self.random, QueueRecord._write

        def write(record: QueueRecord, line: bytes) -> None:
            if random.random() < 0.01:  # a power cut: any part of the line is on the disk, or zeros
                self.counts["kills"] += 1
                part = line[: random.randint(0, len(line))]
                part = b"\0" * len(part) if random.random() < 0.2 else part
                os.write(record._file, part)
                raise Killed
            real(record, line)

        return write

    def _run_of(self, _folder: Path, number: int, _runs: Path) -> tuple[str, RunStatus, str] | None:
        if not self.world.begun[number]:
            return None
        return f"run-{number}", self.world.over.get(number, RunStatus.INTERRUPTED), ""

    # -- the run ------------------------------------------------------------------------------------------------

    def _session(
        self, order: Order, options: SessionOptions, _yes: bool, _notes: str, work: object, start: Callable[[str], None]
    ) -> tuple[RunView | None, str]:
        """Play a run: it may fail to begin, asks, and ends as drawn."""
        stage = self._stage
        service = stage.service
        assert service is not None
        number = int(Path(options.recipe).parts[-3])
        world, random = self.world, self.random
        if service.orders.job is not order:
            return None, "stopped while it was planned"
        if random.random() < 0.05:
            return None, "the bus is gone"
        session = SimpleNamespace(accepts=None, run=lambda: 0)
        assert callable(work)
        work(session)
        if why := session.accepts(SimpleNamespace(work=SimpleNamespace(rig=SimpleNamespace(text=world.rig)))):
            return None, why
        if not world.disk:  # a run itself measures the space again
            return None, "too little room"
        self._check_start(number)
        world.begun[number] += 1
        self.counts["runs"] += 1
        start(f"run-{number}")
        world.asks = random.random() < 0.3
        status = random.choices(
            [RunStatus.DONE, RunStatus.INCOMPLETE, RunStatus.FAILED, RunStatus.TRIPPED], [12, 3, 1, 1]
        )[0]
        for _ in range(random.randint(1, 6)):
            service.desk.poll(0.0)
            while world.asks and service.orders.job is order:
                service.desk.poll(0.0)  # it waits for an answer
                world.asks = random.random() > 0.3
        if service.orders.job is not order:
            status = RunStatus.STOPPED
        if status is not RunStatus.DONE and status is not RunStatus.INCOMPLETE:
            skipped = status is RunStatus.STOPPED and bool(service.queue.queue.entry(number).skip)
            world.person = world.person and skipped
        if status is RunStatus.TRIPPED:
            service.desk.latched = "a trip"
        world.person = world.person and not world.stood
        world.over[number] = status
        return RunView(f"run-{number}", "", "", "", "", "", 0, True, None, "", status.value, "", 0, ()), ""

    def _check_start(self, number: int) -> None:
        world = self.world
        kept = read_queue(self.record.parent)
        entry = kept.entry(number)
        if world.begun[number]:
            self.misses.append(f"item {number} runs twice")
        if not entry.state.under_way:
            self.misses.append(f"item {number} begins without evidence on the disk: {entry.state}")
        wrong = [
            text
            for text, bad in (
                ("no person", not world.person),
                ("not looked at", number not in world.looked),
                ("alarm", world.alarm),
                ("disk", not world.disk),
                ("rig", entry.agreed.rig != sha256(world.rig.encode()).hexdigest()),
            )
            if bad
        ]
        world.looked.discard(number)
        if wrong:
            self.misses.append(f"item {number} begins without evidence: {', '.join(wrong)}")

    # -- judging ------------------------------------------------------------------------------------------------

    def _judge(self) -> None:
        queue = read_queue(self.record.parent)
        numbers = [entry.item.id for entry in queue.entries]
        self.counts["items"] += len(numbers)
        for number in sorted(self.world.confirmed - set(numbers)):
            self.misses.append(f"item {number} is lost")
        if len(numbers) != len(set(numbers)):
            self.misses.append(f"items are twice in the queue: {numbers}")
        for entry in queue.entries:
            if self.world.begun[entry.item.id] > 1:
                self.misses.append(f"item {entry.item.id} ran twice")

    @property
    def _stage(self) -> QueueStage:
        assert self.stage is not None
        return self.stage

    stage: QueueStage | None = None


class QueueStage(ServiceStage):
    """The service's clients, which act at random. Each poll may bring a kill."""

    def __init__(self, life: Life) -> None:
        """Act in ``life``."""
        life.folder.mkdir(parents=True, exist_ok=True)
        super().__init__(life.folder, _silent)
        self.life = life
        life.stage = self
        self._turn = 0
        self._seen = 0

    def queue(self, queue: QueueView) -> None:
        super().queue(queue)
        self.life.counts["waits"] += 1
        waiting = any(entry.state == "waiting" for entry in queue.items)
        if not queue.state.strip() or (waiting and not queue.going and queue.state == "standing: "):
            self.life.misses.append(f"a wait without a reason: {queue.state!r}")

    def accept(self, order: Order, result: object = None) -> None:
        if isinstance(result, dict) and "id" in result:
            self.life.world.confirmed.add(int(str(result["id"])))  # pyright: ignore[reportUnknownArgumentType]
        world = self.life.world
        if isinstance(order.action, QueueStart):
            world.person, world.stood = True, False
        if isinstance(order.action, QueueStand) and self.service is not None:
            world.stood = True  # an item that has started continues
            world.person = world.person and self.service.queue.queue.under_way is not None

    def refuse(self, order: Order, reason: str) -> None:
        self.life.counts["refused starts"] += isinstance(order.action, QueueStart)
        if not reason.strip():
            self.life.misses.append(f"a refusal without a reason: {order.action}")

    def receive(self) -> list[Order | Presence]:
        life, random = self.life, self.life.random
        self._turn += 1
        assert self.service is not None
        if self._turn > TURNS_MOST:
            life.misses.append("the queue hangs")
            life.acts = 0
        if life.acts <= 0:
            self.service.end()
            return []
        if random.random() < 0.002:
            life.counts["kills"] += 1
            raise Killed
        if random.random() < 0.95:
            return []
        life.acts -= 1
        return self._act()

    def _act(self) -> list[Order | Presence]:
        random, world = self.life.random, self.life.world
        assert self.service is not None
        kind = random.choices(
            ["add", "move", "skip", "drop", "start", "stand", "stop", "alarm", "rig", "disk", "ack"],
            [9, 3, 1, 1, 12, 0.5, 0.5, 2, 2, 2, 6],
        )[0]
        view = self.queues[-1] if self.queues else None
        numbers = [entry.id for entry in view.items] if view is not None else []
        number = random.choice(numbers or [1])
        revision = (view.revision if view is not None else 0) - (random.random() < 0.1)
        desk = self.service.desk
        actions: dict[str, RigAction] = {
            "add": QueueAdd("fake", text="recipe: fake", yes=True),
            "move": QueueMove(number, max(revision, 0), random.choice([0, *numbers])),
            "skip": QueueSkip(number, max(revision, 0)),
            "drop": QueueDrop(number, max(revision, 0)),
            "start": QueueStart((number,) if random.random() < 0.15 else ()),
            "stand": QueueStand("for a while"),
            "stop": Stop(),
        }
        if kind == "alarm":
            world.alarm = not world.alarm and random.random() < 0.3
            if world.alarm:
                desk.alarms.raise_(Cause("drawn", 2, "drawn", ""), 0.0)
            else:
                desk.alarms.clear("drawn")
                desk.alarms.acknowledge(0, "anna")
        elif kind == "rig":
            world.rig = f"rig {random.choice((0, 0, 0, 0, 1))}"
        elif kind == "disk":
            world.disk = not world.disk or random.random() < 0.9
        elif kind == "ack":
            desk.latched = ""
        else:
            if kind == "stop":
                world.person = False
            return [self.order(actions[kind])]
        return []


class InlineExecutor:
    """Writes at once, in place of a thread, so that a seed gives the same life on every computer."""

    def __init__(self, *_: object, **__: object) -> None:
        """Accept a thread pool's arguments."""

    def submit(self, work: Callable[..., Queue], *given: object) -> Future[Queue]:
        """Carry out the work now."""
        future: Future[Queue] = Future()
        try:
            future.set_result(work(*given))
        except BaseException as error:  # noqa: BLE001 - a kill also reaches the service by its future
            future.set_exception(error)
        return future

    def shutdown(self) -> None:
        """Do nothing: nothing waits."""


def fault_figures(misses: list[str], where: str = "") -> list[Figure]:
    """Print the first faults of many lives; return the figures of each kind."""
    for miss in misses[:20]:
        print(f"     {miss}")
    kinds = {kind: sum(kind in miss for miss in misses) for kind in ("twice", "lost", "evidence", "reason")}
    return [
        equal(f"{where}items that ran twice", kinds["twice"], 0),
        equal(f"{where}items lost", kinds["lost"], 0),
        equal(f"{where}starts without evidence or a person", kinds["evidence"], 0),
        equal(f"{where}waits without a reason", kinds["reason"], 0),
        equal(f"{where}other faults", len(misses) - sum(kinds.values()), 0),
    ]


def _roomy(room: FreeRoom) -> None:
    """Measure the disk at once: the fake clock would outrun its thread."""
    room.hangs, room._free = False, 10**12


def _silent(_stage: ServiceStage) -> Script:
    yield None


