"""`python -m tests.campaigns.page [--sample]`: STOP from a page, and the cost of pages to the scan.

A run slides at 100 Hz. Twenty pages stream and one is frozen; a page sends STOP 200 times at random moments, then again
during 1,000 wrong codes. Then the lateness of scans is measured, in turns with the run alone. Prints a line a figure
with its limit, and exits with 1 where one misses. A bare loop beside them shows how late the machine itself is.
"""

from __future__ import annotations

import argparse
import asyncio
import json
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any

from websockets.asyncio.client import ClientConnection, connect

from tester.base import clock
from tester.base.processes import tester_command
from tester.page.desk_call import DeskView, NewCode, NoPageError, ShowDesk, call_desk
from tester.page.roles import Role
from tester.service.address import HAS_UNIX
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.stop import scenes
from tests.campaigns.stop.owner import STOPS
from tests.campaigns.stop.place import NotReachedError, Place, ended
from tests.campaigns.stop.scans import Scans

TRIES, SAMPLE = 200, 60
MEDIAN_MS, MOST_MS = 50.0, 100.0
PAGES, GUESSES = 20, 1000
GROWS_MB = 10.0
"""Maximum growth of the page process while a page is frozen."""
START_S = 60.0
FINGER = "finger"
FLOOD_S = 40.0
"""Time limit of tries during wrong codes."""


class Pages:
    """The page process of a place, and its crowd."""

    def __init__(self, place: Place, stack: ExitStack, port: int) -> None:
        """Start it; it ends with ``stack``."""
        self.place, self.stack = place, stack
        self.origin = f"http://127.0.0.1:{port}"
        self.url = f"ws://127.0.0.1:{port}/socket"
        self._random = Random(11)
        self.process = subprocess.Popen(
            tester_command("page", "--port", str(port), "--connect", str(place.address), "--out",
                           str(place.folder / "runs")),
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
        )  # fmt: skip
        stack.callback(ended, self.process)

    async def desk(self, request: NewCode | ShowDesk) -> DeskView:
        """Ask the page process as the machine's screen does. Raises NotReachedError."""
        end_s = clock.monotonic() + START_S
        while True:
            try:
                return await asyncio.to_thread(call_desk, self.place.address, request)
            except NoPageError as error:
                if clock.monotonic() > end_s or self.process.poll() is not None:
                    raise NotReachedError(f"no page within {START_S:g} s: {error}") from error
                await asyncio.sleep(0.1)

    async def paired(self, role: Role, name: str) -> tuple[ClientConnection, str]:
        """Return a paired page and its secret."""
        code = (await self.desk(NewCode(role))).code
        assert code is not None
        page = await connect(self.url, origin=self.origin, max_size=None, compression=None)  # type: ignore[arg-type]
        await page.send(json.dumps({"type": "pair", "code": code.digits, "name": name}))
        answer = json.loads(await page.recv())
        if answer["type"] != "paired":
            raise NotReachedError(f"pairing: {answer}")
        return page, answer["secret"]

    def crowd(self, *words: str) -> subprocess.Popen[bytes]:
        """Start pages in a process of their own; return it once they have begun."""
        process = subprocess.Popen(
            [sys.executable, "-m", "tests.campaigns.page.crowd", self.url, self.origin, *words],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        assert process.stdout is not None
        process.stdout.readline()
        self.stack.callback(ended, process)
        return process

    def resident_mb(self) -> float:
        """Return the memory of the page process, MB; NaN if the system does not report it."""
        try:
            pages = int(Path(f"/proc/{self.process.pid}/statm").read_text().split()[1])
        except OSError:
            return float("nan")
        return pages * 4096 / 1e6

    async def stop(self, page: ClientConnection, number: int) -> tuple[float, float, float]:
        """Send STOP once; return when it was sent, in control and answered, s."""
        await asyncio.sleep(0.03 + 0.07 * self._random.random())
        before = len(self._carried_out())
        sent_s = clock.monotonic()
        await page.send(json.dumps({"type": "command", "id": number, "action": {"command": "stop"}}))
        async with asyncio.timeout(10.0):
            while True:
                answer: dict[str, Any] = json.loads(await page.recv())
                if answer.get("id") == number and answer["type"] in ("accepted", "refused"):
                    break
        answered_s = clock.monotonic()
        carried_out = self._carried_out()
        if answer["type"] != "accepted" or len(carried_out) <= before:
            raise NotReachedError(f"STOP {number}: {answer}")
        return sent_s, carried_out[before], answered_s

    def _carried_out(self) -> list[float]:
        """Return when STOPs of the page were in control."""
        lines = (self.place.folder / STOPS).read_text(encoding="utf-8").splitlines()
        return [float(line.split(" ", 1)[0]) for line in lines if FINGER in line and " done " in line]


def figures_of(name: str, tries: list[tuple[float, float, float]], count: int, late_s: float) -> list[Figure]:
    """Compare tries with the limits of STOP; ``late_s``: of the bare loops at the same time."""
    control = sorted(1e3 * (control_s - sent_s) for sent_s, control_s, _ in tries)
    answers = sorted(1e3 * (answered_s - sent_s) for sent_s, _, answered_s in tries)
    loops = f" (a bare loop of 20 ms is late by up to {1e3 * late_s:.1f} ms)"
    return [
        equal(f"{name}: STOP accepted", len(tries), count),
        at_most(f"{name}: STOP to control, median", control[len(control) // 2], MEDIAN_MS, "ms", 1),
        at_most(f"{name}: STOP to control, worst", control[-1], MOST_MS + 1e3 * late_s, "ms", 1, note=loops),
        at_most(f"{name}: STOP answered, median", answers[len(answers) // 2], MEDIAN_MS, "ms", 1),
    ]


async def measured(folder: Path, count: int, port: int) -> list[Figure]:
    """Return the figures. Raises NotReachedError."""
    found: list[Figure] = []
    with ExitStack() as stack:
        place = Place(folder, stack)
        async with await place.operator() as client:
            loud_s = 0.25 * count + FLOOD_S + 40.0
            quiet = await scenes.begin_to_slide(place, client, loud_s)
            pages = Pages(place, stack, port)
            page, _ = await pages.paired("stop", FINGER)
            other, secret = await pages.paired("look", "streams")
            await other.close()
            pages.crowd("reads", secret, str(PAGES))
            pages.crowd("frozen", secret)
            await asyncio.sleep(scenes.SETTLE_S)
            began_s, began_mb = clock.monotonic(), pages.resident_mb()
            (streams,) = [one for one in (await pages.desk(ShowDesk())).pairings if one.name == "streams"]
            found.append(equal("pages that stream, with the frozen one", streams.pages, PAGES + 1))
            tries = [await pages.stop(page, n) for n in range(count)]
            found += figures_of("with 20 pages", tries, count, place.loop_late_s(began_s, clock.monotonic()))
            flood_s = clock.monotonic()
            guesses = pages.crowd("guesses", str(GUESSES))
            tries = []
            while guesses.poll() is None and len(tries) < count and clock.monotonic() - flood_s < FLOOD_S:
                tries.append(await pages.stop(page, count + len(tries)))
            found += figures_of("among wrong codes", tries, len(tries), place.loop_late_s(flood_s, clock.monotonic()))
            await asyncio.to_thread(guesses.wait)
            view = await pages.desk(ShowDesk())
            found.append(equal("pairings after 1,000 wrong codes", len(view.pairings), 2))
            found.append(at_most("the page process grew by", pages.resident_mb() - began_mb, GROWS_MB, "MB", 1))
            calm_s = clock.monotonic()
            await asyncio.sleep(scenes.QUIET_S)
            loud = calm_s, clock.monotonic()
            found.append(holds("the wheel still slides", scenes.slides(client.state), client.state.mode, "RUN"))
            found.append(await scenes.ended_by_the_operator(place, client))
            found += Scans(place, quiet, loud).figures(f"{PAGES + 1} pages")
    return found


def main(arguments: list[str] | None = None) -> int:
    """Measure; return 1 if a figure misses."""
    parser = argparse.ArgumentParser("python -m tests.campaigns.page", description="STOP from a page.")
    parser.add_argument("--sample", action="store_true", help=f"{SAMPLE} tries instead of {TRIES}")
    parser.add_argument("--port", type=int, default=18010, help="port of the page")
    read = parser.parse_args(arguments)
    if not HAS_UNIX:
        print("not measured: no Unix sockets on this system")
        return 0
    with TemporaryDirectory(prefix="page-", ignore_cleanup_errors=True) as folder:
        try:
            found = asyncio.run(measured(Path(folder), SAMPLE if read.sample else TRIES, read.port))
        except (NotReachedError, OSError) as error:
            found = [holds("can be measured", False, str(error), "yes")]
    for figure in found:
        print(figure, flush=True)
    missed = sum(not figure.ok for figure in found)
    print(f"== {'every figure is kept' if not missed else f'{missed} missed'}")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
