"""Power cuts: a run is recorded, its file operations are noted, and the disk is cut between any two of them."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from random import Random

from tester.analysis.results import ConditionStatus, RepeatStatus
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.store.record_schema import StoreError
from tester.store.records import PieceInfo, SessionInfo
from tester.store.resumable import resume_point
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.campaigns.acceptance.figure import Figure, at_most, equal
from tests.campaigns.crash.images import Disk, put
from tests.campaigns.crash.syncs import Operation, SyncLog, recording, unavailable
from tests.tester.store.build import BURSTS, CONDITIONS, RUN, SPECIMENS, Clock, result

SCAN_S = 0.01
SERVICE_S = 0.1
REPEATS = 3
SCANS = 230
"""Of a repeat: it ends between two commits of the second."""
STRETCHES = 3
"""The run is recorded in this many stretches; each but the last ends in the middle of a repeat."""


@dataclass(slots=True)
class Recorded:
    """A recorded run: every sample by its time, every repeat, and the operations with marks between them."""

    log: SyncLog
    samples: dict[float, tuple[float, ...]] = field(default_factory=dict[float, tuple[float, ...]])
    repeats: dict[tuple[int, int], float] = field(default_factory=dict[tuple[int, int], float])


def record(folder: Path, random: Random) -> Recorded:
    """Record a run of two conditions in three stretches; time comes from a counter, not a clock."""
    with recording(folder) as log:
        made = Recorded(log)
        clock = Clock()
        left = [(c.condition, r) for c in CONDITIONS for r in range(1, REPEATS + 1)]
        for stretch in range(STRETCHES):
            writer = RunWriter(folder / "run.db", QUANTITIES, clock=clock, synchronous=True, limit=10**6)
            if stretch == 0:
                writer.begin_run(RUN, SPECIMENS, CONDITIONS)
                writer.piece_mounted(PieceInfo(1, 1, 1, "1#", 0.0, 90.0, 90.0))
            writer.begin_session(SessionInfo(stretch + 1, 0.0, "", "", 0, "", "", "", ""))
            if stretch:
                writer.resume_run()
            count = len(left) // STRETCHES if stretch < STRETCHES - 1 else len(left)
            for place in left[:count]:
                _repeat(writer, clock, made, place, random, attempt=1 + (stretch > 0 and place == left[0]))
            del left[:count]
            if left:
                key = writer.begin_repeat(*left[0], 1)
                _scans(writer, clock, made, key, random, SCANS // 2)
            else:
                writer.finish("done", rig_seconds=clock.now)
                log.mark("finished")
            writer.close()
        return made


def _repeat(
    writer: RunWriter, clock: Clock, made: Recorded, place: tuple[int, int], random: Random, attempt: int
) -> None:
    condition, repeat = place
    if repeat == 1:
        writer.begin_condition(condition, clock.now)
    key = writer.begin_repeat(condition, repeat, attempt, clock.now, piece=1)
    _scans(writer, clock, made, key, random, SCANS)
    mu = round(random.uniform(0.3, 1.2), 6)
    made.repeats[place] = mu
    ticket = writer.commit_repeat(key, result(mu), BURSTS)
    assert ticket.done
    made.log.mark("repeat", place, mu)
    if repeat == REPEATS:
        writer.end_condition(condition, ConditionStatus.OK, t_s=clock.now)
        made.log.mark("condition", condition)


def _scans(writer: RunWriter, clock: Clock, made: Recorded, key: int, random: Random, count: int) -> None:
    for scan in range(count):
        clock.now += SCAN_S
        t = round(clock.now, 6)
        row = (t, *(round(random.gauss(100.0, 1.0), 3) for _ in QUANTITIES.names[2:]), float(key))
        made.samples[t] = row
        writer.sample(row)
        if scan % round(SERVICE_S / SCAN_S) == 0:
            writer.service()
            made.log.mark("time", t)


@dataclass(slots=True)
class Damage:
    """The damage of power cuts."""

    images: int = 0
    unreadable: list[str] = field(default_factory=list[str])
    lost_repeats: int = 0
    wrong_values: int = 0
    wrong_points: int = 0
    missing_s: float = 0.0
    """Longest stretch of the newest samples that was missing, s."""


@dataclass(slots=True)
class Known:
    """What must be on the disk at a moment."""

    repeats: set[tuple[int, int]] = field(default_factory=set[tuple[int, int]])
    begun: bool = False
    now_s: float = 0.0

    def take(self, operation: Operation) -> None:
        """Process a mark."""
        match operation.mark:
            case ("repeat", place, _):
                self.repeats.add(place)
                self.begun = True
            case ("time", now):
                self.now_s = now
                self.begun = True
            case _:
                pass


def cuts(made: Recorded, folder: Path, count: int, random: Random) -> Damage:
    """Cut the power ``count`` times at random operations and read the remaining data."""
    operations = made.log.operations
    places = sorted(random.randrange(1, len(operations) + 1) for _ in range(count))
    disk, known, damage = Disk(), Known(), Damage()
    played = 0
    for number, place in enumerate(places):
        while played < place:
            disk.play(operations[played])
            known.take(operations[played])
            played += 1
        image = folder / f"image-{number}"
        put(disk.image(random), image)
        damage.images += 1
        _read(image, made, known, damage)
        shutil.rmtree(image)
    return damage


def _read(image: Path, made: Recorded, known: Known, damage: Damage) -> None:
    if not known.begun:
        return  # the run itself was not recorded yet: there is nothing to lose
    try:
        with RunReader(image) as reader:
            if reader.integrity_problems():
                damage.unreadable.append("integrity")
            found = {
                (r.condition, r.repeat): r.result for r in reader.repeats() if r.result.status is RepeatStatus.VALID
            }
            damage.lost_repeats += len(known.repeats - set(found))
            damage.wrong_values += sum(made.repeats.get(place) != r.mu_resultant for place, r in found.items())
            damage.wrong_points += _wrong_point(reader, set(found))
            newest = _samples(reader, made, damage)
    except StoreError as error:
        damage.unreadable.append(str(error))
        return
    damage.missing_s = max(damage.missing_s, known.now_s - newest)


def _wrong_point(reader: RunReader, found: set[tuple[int, int]]) -> bool:
    """Return whether the run would continue anywhere but at the first missing repeat."""
    point = resume_point(reader)
    order = [(c.condition, r) for c in CONDITIONS for r in range(1, REPEATS + 1)]
    expected = next((place for place in order if place not in found), None)
    if found != set(order[: len(found)]):
        return True
    for condition, so_far in point.conditions.items():
        if len(so_far.results) != sum(1 for place in found if place[0] == condition):
            return True
    if expected is None:
        return point.next_repeat not in (None, (CONDITIONS[-1].condition, REPEATS + 1))
    return any((condition, REPEATS) not in found for condition in point.stand.ended) or (
        point.next_repeat is not None
        and point.next_repeat != expected
        and point.next_repeat != (expected[0] - 1, REPEATS + 1)
    )


def _samples(reader: RunReader, made: Recorded, damage: Damage) -> float:
    """Compare every stored sample with the recorded one; return the newest one's time."""
    newest, seen = -inf, 0.0
    for block in reader.sample_blocks():
        for row in zip(*(block.columns[name] for name in QUANTITIES.names), strict=True):
            damage.wrong_values += made.samples.get(row[0]) != row
            damage.wrong_values += row[0] <= seen  # in order, without duplicates
            seen = row[0]
        newest = seen
    return newest if newest > 0.0 else 100.0


def measure(folder: Path, count: int, seed: int = 1) -> Iterator[Figure]:
    """Yield the figures of ``count`` power cuts."""
    random = Random(seed)
    trial = folder / "trial"
    trial.mkdir()
    why = unavailable(trial)
    if why:
        yield Figure("power cuts", f"skipped: {why}", "needs a shared SQLite", ok=True)
        return
    run = folder / "run"
    run.mkdir()
    made = record(run, random)
    damage = cuts(made, folder, count, random)
    syncs = sum(operation.kind == "sync" for operation in made.log.operations)
    writes = sum(operation.kind == "write" for operation in made.log.operations)
    yield equal("power cuts", damage.images, count)
    yield Figure("operations cut between", f"{writes} writes, {syncs} syncs", "at least 100", writes + syncs >= 100)
    yield equal("unreadable after a power cut", len(damage.unreadable), 0)
    for why in sorted(set(damage.unreadable))[:3]:
        yield Figure("unreadable", why, "none", ok=False)
    yield equal("committed repeats lost by a power cut", damage.lost_repeats, 0)
    yield equal("wrong values after a power cut", damage.wrong_values, 0)
    yield equal("wrong resume points after a power cut", damage.wrong_points, 0)
    yield at_most("samples missing after a power cut", damage.missing_s, 1.0, "s of wall time", 2)
