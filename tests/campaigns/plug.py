"""`python -m tests.campaigns.plug [--sample] [--moments N] [--seed N] [--busy [RECIPE]]`: the alarm names the cable.

The CAN plug or the adapter is pulled at N moments, drawn by seed. Half are in one process in virtual time, anywhere
between two scans; in the other half `tester sim` serves over TCP and as an slcan adapter on a pseudo-terminal, and
`tester run` connects, arms or moves. Each first alarm must name cable, adapter or bus. If a bare loop shows that the
computer was late, the alarm may name the computer instead; such a try is repeated.

`--busy` runs RECIPE (default: one short condition) over TCP and over ptys while a third process keeps one core busy:
the run must end, or the alarm must name the late computer. Exit code 1 where a figure misses.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import socket
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

import recipes
from tester.base import clock
from tests.campaigns.acceptance.bench import ROOT
from tests.campaigns.acceptance.figure import Figure, equal, holds
from tests.campaigns.doors.__main__ import DOORS, RECIPE, SAMPLE_SLIPS, through
from tests.campaigns.faults.first_alarm import PULLED, conduct, unnamed
from tests.campaigns.latency import SPIN
from tests.realtime.processes import NotReachedError, RunProcess, SimProcess

MOMENTS, SAMPLE = 200, 3
"""Moments of the whole campaign; tries in two processes of a sample, which has every moment in one process."""
PHASES = ("soak", "roll", "wait", "measure")
TWO_SCANS_S = 0.02
FAULTS = {"plug": "CAN bus off", "adapter": "CAN adapter gone"}
NAMED = re.compile(r"CAN cable|CAN adapter|CAN bus|bus lost")
LATE = re.compile(r"was late|scan late")
STAGES = {"connecting": 4.0, "install wheel": 2.0}
"""Lines of a run after which something is pulled, and the longest delay, s: it connects, or moves."""
WAYS = list(product(FAULTS, STAGES))
ARMED = "install wheel"
NOTICED_S = 1.0
"""An armed run has tripped within this time, s; with the plug back it ends earlier."""
LOOP_LATE_S = 0.015
"""Lateness of a bare loop that shows that the computer was late, s: a scan and a half."""
AGAIN = 3
"""Maximum tries for one moment, if the computer was late."""
PATIENCE_S = 90.0


@dataclass(frozen=True, slots=True)
class Pulled:
    """A pull in two processes: where, the alarm, and a bare loop's lateness at the time, s."""

    where: str
    alarm: str
    loop_late_s: float

    @property
    def named(self) -> bool:
        return bool(NAMED.search(self.alarm)) and "drive data stale" not in self.alarm

    @property
    def late(self) -> bool:
        return bool(LATE.search(self.alarm)) and self.loop_late_s >= LOOP_LATE_S


def in_one_process(count: int, seed: int) -> Figure:
    """Pull plug and adapter in turn, in each phase, at moments between two scans."""
    pulled = [thing for thing in PULLED if thing.what in ("CAN plug out", "CAN adapter out")]
    random = Random(seed)
    each = -(-count // (len(pulled) * len(PHASES)))
    alarms = conduct(pulled, PHASES, seed, [random.uniform(0.0, TWO_SCANS_S) for _ in range(each)])
    wrong = unnamed(alarms)
    for line in wrong:
        print(line)
    return equal("named in one process", f"{len(alarms) - len(wrong)} of {len(alarms)}", f"{each * 8} of {each * 8}")


class Machine:
    """`tester sim` behind one kind of CAN door, with its console and a bare loop beside it."""

    def __init__(self, folder: Path, door: str) -> None:
        """Start them. Raises NotReachedError."""
        folder.mkdir(parents=True)
        self.folder, self.door = folder, door
        self.sim = SimProcess(folder, options=("--control", "0", *(("--slcan",) if door == "slcan" else ())))
        place = re.search(r"127\.0\.0\.1:(\d+) \(commands\)", self.sim.ready)
        assert place is not None
        self._console = socket.create_connection(("127.0.0.1", int(place[1])), timeout=10.0)
        self._loop_file = folder / "loop"
        command = [sys.executable, "-m", "tests.campaigns.stop.loop", str(self._loop_file), "0.003"]
        self._loop = subprocess.Popen(command, cwd=ROOT)

    def command(self, line: str) -> None:
        """Give the machine's console a command."""
        self._console.sendall(f"{line}\n".encode())
        answer = b""
        while not answer.endswith(b"\n\n"):
            answer += self._console.recv(4096)

    def pull(self, what: str, stage: str, after_s: float) -> Pulled:
        """Pull it ``after_s`` after a new run printed ``stage``. Raises NotReachedError."""
        began_s = clock.monotonic()
        run = RunProcess(self.folder, self.sim.rig_file)
        try:
            while stage not in run.errors.read_text(encoding="utf-8"):
                if run.process.poll() is not None or clock.monotonic() > began_s + PATIENCE_S:
                    raise NotReachedError(f"{self.door}: not {stage}: {run.said()}")
                clock.sleep_until(clock.monotonic() + 0.02)
            clock.sleep_until(clock.monotonic() + after_s)
            self.command(f"fault {FAULTS[what]}")
            clock.sleep_until(clock.monotonic() + NOTICED_S)
            if ARMED in run.errors.read_text(encoding="utf-8"):
                self.command("clear")
            run.process.wait(PATIENCE_S)
            self.command("clear")
        finally:
            run.process.kill()
            run.process.wait()
        where = f"{what}, {self.door}, {after_s:.3f} s after {stage}"
        return Pulled(where, alarm_of(run.errors.read_text(encoding="utf-8")), self._late_s(began_s))

    def _late_s(self, since_s: float) -> float:
        rows = [line.split() for line in self._loop_file.read_text(encoding="utf-8").splitlines()]
        return max((float(row[1]) for row in rows if len(row) == 2 and float(row[0]) >= since_s), default=0.0)

    def close(self) -> None:
        """End all."""
        self._console.close()
        for process in (self._loop, self.sim.process):
            process.kill()
            process.wait()


def alarm_of(printed: str) -> str:
    """Return the line in which a run reports why it ended, "" if there is none."""
    ends = re.compile(r"(tripped|rig unreachable|failed|stopped): ")
    return next((line for line in printed.splitlines() if ends.match(line)), f"no alarm: {printed.strip()[-300:]}")


def in_two_processes(folder: Path, door: str, count: int, seed: int) -> list[Pulled]:
    """Pull plug and adapter in turn at drawn moments; return the last try of each moment."""
    random = Random(f"{seed} {door}")
    machine = Machine(folder / door, door)
    tries: list[Pulled] = []
    try:
        for number in range(count):
            what, stage = WAYS[number % len(WAYS)]
            after_s = random.uniform(0.0, STAGES[stage])
            for _ in range(AGAIN):
                tries[number:] = [tried := machine.pull(what, stage, after_s)]
                late = f"bare loop {1e3 * tried.loop_late_s:.0f} ms late"
                print(f"{tried.where}: {tried.alarm[:150]} ({late})", flush=True)
                if tried.named or not tried.late:
                    break
    finally:
        machine.close()
    return tries


def pulls(folder: Path, count: int, seed: int) -> Iterator[Figure]:
    """Pull in two processes, at both kinds of door at a time."""
    doors = ("TCP", "slcan") if hasattr(os, "openpty") else ("TCP",)
    shares = [len(range(number, count, len(doors))) for number in range(len(doors))]
    with ThreadPoolExecutor(len(doors)) as pool:
        lanes = list(pool.map(lambda door, share: in_two_processes(folder, door, share, seed), doors, shares))
    for door, lane in zip(doors, lanes, strict=True):
        for tried in lane:
            if not tried.named:
                print(f"not named: {tried.where}: {tried.alarm}")
        named = sum(tried.named or tried.late for tried in lane)
        yield equal(f"named in two processes, {door}", f"{named} of {len(lane)}", f"{len(lane)} of {len(lane)}")
    late = Counter(tried.late and not tried.named for lane in lanes for tried in lane)[True]
    yield holds("of them named the late computer", True, str(late), "no limit")


@contextmanager
def one_core_busy() -> Iterator[None]:
    """Keep one core busy at ordinary priority."""
    spinner = subprocess.Popen([sys.executable, "-c", SPIN])
    try:
        yield
    finally:
        spinner.kill()
        spinner.wait()


def busy(folder: Path, recipe: str) -> Iterator[Figure]:
    """Run a recipe in two processes beside a busy core."""
    for door, options in DOORS.items():
        place = folder / door
        place.mkdir(parents=True)
        if recipe:
            shutil.copy(Path(recipes.__file__).parent / f"{recipe}.yaml", folder / "recipe.yaml")
        else:
            (folder / "recipe.yaml").write_text(RECIPE.format(slip=SAMPLE_SLIPS), encoding="utf-8")
        with one_core_busy():
            try:
                ended = f"done: {through(place, options).name}"
            except (ValueError, subprocess.TimeoutExpired) as error:
                ended = str(error)
        well = ended.startswith("done") or bool(LATE.search(ended))
        yield holds(f"one core busy, {door}", well, ended, "ends, or the alarm names the late computer")


def main(arguments: list[str] | None = None) -> int:
    """Measure; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.plug", description="The alarm names the cable.")
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE} tries in two processes")
    parser.add_argument("--moments", type=int, default=MOMENTS, metavar="N", help=f"default {MOMENTS}")
    parser.add_argument("--seed", type=int, default=1, metavar="N")
    parser.add_argument("--busy", nargs="?", const="", metavar="RECIPE", help="run RECIPE beside a busy core instead")
    read = parser.parse_args(arguments)
    missed = 0
    with TemporaryDirectory(prefix="plug-", ignore_cleanup_errors=True) as temporary:
        folder = Path(temporary)
        try:
            for figure in busy(folder, read.busy) if read.busy is not None else figures(folder, read):
                missed += not figure.ok
                print(figure, flush=True)
        except NotReachedError as error:
            missed += 1
            print(holds("can be measured", False, str(error), "yes"))
    return 1 if missed else 0


def figures(folder: Path, read: argparse.Namespace) -> Iterator[Figure]:
    """Yield the figures of one process and of two."""
    yield in_one_process(read.moments // 2, read.seed)
    yield from pulls(folder, SAMPLE if read.sample else read.moments // 2, read.seed)


if __name__ == "__main__":
    sys.exit(main())
