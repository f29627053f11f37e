"""The service: cost of clients to the scan, its own cost, and time until STOP is taken and a screen is back.

The shell is measured in two ways, as its decision requires: the gateway in a process of its own, and the same gateway
as a thread beside the scan. Clients are in a separate process; some watch, some reconnect repeatedly.
"""

from __future__ import annotations

import asyncio
import os
import subprocess
from collections.abc import Generator
from contextlib import contextmanager
from io import FileIO
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Thread, get_native_id

from bench.child import ROOT, command
from bench.effort import Effort, TopicFailedError
from bench.figures import Figure, at_most, ratio, unavailable
from bench.lateness import percentile
from tester.base import clock
from tester.machine.tickers import collector_at_rest
from tester.service.address import UnixAddress
from tester.service.child_process import INHERITS
from tester.service.client import Client, NoServiceError
from tester.service.commands import RunRecipe, Stop
from tester.service.gateway_link import GatewayLink, LinkConfig
from tester.service.gateway_process import serve_link
from tester.service.service import Service, ServiceOptions
from tester.service.service_link import OwnerEnd

PERIOD_S = 0.01
POLL_EVERY = 2
VIEWERS, COMERS = 4, 2
SHELL_LIMIT = 2.0
"""Limit of the lateness with clients relative to that without."""
CPU_LIMIT = 5.0
"""Limit of the service without clients, % of a core."""
STOP_LIMIT_MS = 50.0
BACK_LIMIT_MS = 1000.0
CLIENTS = """\
import asyncio, sys
from pathlib import Path
from tester.service.address import UnixAddress
from tester.service.client import Client

async def view(address):
    async with await Client.connect(address, name="viewer") as client:
        async for _ in client:
            pass

async def come_and_go(address):
    while True:
        async with await Client.connect(address, name="comer"):
            await asyncio.sleep(0.2)

async def main():
    address = UnixAddress(Path(sys.argv[1]))
    viewers, comers = int(sys.argv[2]), int(sys.argv[3])
    await asyncio.gather(*(view(address) for _ in range(viewers)), *(come_and_go(address) for _ in range(comers)))

asyncio.run(main())
"""
SERVE = "import sys; from tester.cli.main import main; main()"


def measure(effort: Effort) -> list[Figure]:
    """Return lateness with both shells, CPU share of the service, time to take STOP and to come back."""
    if not INHERITS or not Path("/proc/self/stat").exists():
        return [unavailable("service", "", "needs Unix sockets and /proc")]
    seconds = effort.pick(20.0, 4.0)
    figures: list[Figure] = []
    p99_us: list[list[float]] = []
    for shell, clients in (("process", False), ("process", True), ("thread", True)):
        runs = [lateness(shell == "process", clients, seconds) for _ in range(effort.runs)]
        name = f"gateway as a {shell}, {f'{VIEWERS} viewers, {COMERS} coming and going' if clients else 'no clients'}"
        p99_us.append([1e6 * percentile(late, 0.99) for late in runs])
        figures.append(Figure(f"{name}: p99 late", "us", tuple(p99_us[-1]), note="less the wait for a core"))
        figures.append(Figure(f"{name}: latest", "us", tuple(1e6 * max(late) for late in runs)))
    figures.append(ratio("gateway as a process: p99 late, clients / none", p99_us[1], p99_us[0], at_most(SHELL_LIMIT)))
    figures.append(ratio("gateway as a thread: p99 late, clients / none", p99_us[2], p99_us[0]))
    shares: list[float] = []
    stops: list[float] = []
    backs: list[float] = []
    for _ in range(effort.runs):
        with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
            share, stop_ms, back_ms = asyncio.run(_live(Path(folder), seconds))
        shares.append(share)
        stops += stop_ms
        backs += back_ms
    return [
        *figures,
        Figure("service, quickstart in real time, no clients: CPU", "% of a core", tuple(shares), at_most(CPU_LIMIT)),
        Figure("STOP, from a client's call to its answer", "ms", tuple(stops), at_most(STOP_LIMIT_MS, worst=True)),
        Figure("coming back, until the next live state", "ms", tuple(backs), at_most(BACK_LIMIT_MS, worst=True)),
    ]


def lateness(own_process: bool, clients: bool, seconds: float) -> list[float]:
    """Return the lateness of each tick of a 100 Hz loop that talks to clients as the service does."""
    with TemporaryDirectory(prefix="bench-", ignore_cleanup_errors=True) as folder:
        path = Path(folder) / "service.sock"
        hub = GatewayLink(LinkConfig(UnixAddress(path), Path(folder) / "service.json", Path(folder), "sim"))
        service = Service(ServiceOptions(runs=Path(folder)), hub)
        if own_process:
            hub.open()
        else:
            _open_in_thread(hub)
        _fill(service)
        with _clients(path) if clients else _no_clients():
            late = _ticks(service, seconds)
        hub.close()
    return late


def _open_in_thread(hub: GatewayLink) -> None:
    """Run the same gateway as a thread of this process."""
    import socket

    ours, theirs = socket.socketpair()
    Thread(target=lambda: asyncio.run(serve_link(theirs)), daemon=True).start()
    hub.adopt(OwnerEnd(ours))


def _fill(service: Service) -> None:
    """Provide clients with the data of an hour's run: ten minutes of trend, two thousand events."""
    for number in range(2000):
        service.desk.tell("step", f"something that has happened, number {number}")
        service.desk.poll(0.0)
    for _ in range(2400):
        service.desk.show()
        clock.sleep_until(clock.monotonic() + 2e-4)


def _ticks(service: Service, seconds: float) -> list[float]:
    """Return lateness less the thread's waiting time for a core: the rest is the process's own."""
    late: list[float] = []
    with collector_at_rest(), Path(f"/proc/self/task/{get_native_id()}/schedstat").open("rb", buffering=0) as waits:
        origin = clock.monotonic() + 0.5
        for number in range(round(seconds / PERIOD_S)):
            before = _waited_s(waits)
            late_s = clock.sleep_until(origin + number * PERIOD_S)
            if late_s < PERIOD_S:  # later ones only catch up after another process had the core
                late.append(max(late_s - (_waited_s(waits) - before), 0.0))
            if number % POLL_EVERY == 0:
                service.desk.poll(0.0)
    return late


def _waited_s(schedstat: FileIO) -> float:
    """Return this thread's waiting time on a run queue (Linux, schedstats: the second field, ns)."""
    schedstat.seek(0)
    return int(schedstat.read(100).split()[1]) * 1e-9


@contextmanager
def _clients(path: Path) -> Generator[None]:
    while not path.exists():
        clock.sleep_until(clock.monotonic() + 0.05)
    process = subprocess.Popen(
        command(["-c", CLIENTS, str(path), str(VIEWERS), str(COMERS)]), cwd=ROOT, stderr=subprocess.DEVNULL
    )
    clock.sleep_until(clock.monotonic() + 2.0)
    try:
        yield
    finally:
        process.kill()
        process.wait()


@contextmanager
def _no_clients() -> Generator[None]:
    yield


async def _live(folder: Path, seconds: float) -> tuple[float, list[float], list[float]]:
    """Return CPU share in %, and the times in ms that STOPs and returns took, of a service that runs the quickstart."""
    address = UnixAddress(folder / "service.sock")
    process = subprocess.Popen(
        command(["-c", SERVE, "serve", "--connect", str(address), "--out", str(folder / "runs")]),
        cwd=ROOT, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        async with await _connected(address) as client:
            await client.command(RunRecipe("quickstart", speed=1.0, yes=True))
        await asyncio.sleep(3.0)
        used, began = _cpu_s(process.pid), clock.monotonic()
        await asyncio.sleep(seconds)
        share = 100.0 * (_cpu_s(process.pid) - used) / (clock.monotonic() - began)
        backs = [await _back_ms(address) for _ in range(5)]
        stops: list[float] = []
        async with await _connected(address) as client:
            for _ in range(5):
                before = clock.monotonic()
                await client.command(Stop())
                stops.append(1e3 * (clock.monotonic() - before))
    finally:
        process.terminate()
        process.wait()
    return share, stops, backs


async def _connected(address: UnixAddress) -> Client:
    for _ in range(200):
        try:
            return await Client.connect(address, name="bench", control=True)
        except NoServiceError:
            await asyncio.sleep(0.05)
    raise TopicFailedError("the service does not come up")


async def _back_ms(address: UnixAddress) -> float:
    before = clock.monotonic()
    async with await Client.connect(address, name="back") as client:
        t_s = client.state.t_s
        async for _ in client:
            if client.state.t_s > t_s:
                break
    return 1e3 * (clock.monotonic() - before)


def _cpu_s(pid: int) -> float:
    """Return the CPU seconds of a process and its children (Linux: proc(5), fields utime, stime)."""
    ticks = os.sysconf("SC_CLK_TCK")
    found = 0.0
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text(encoding="utf-8", errors="replace").rpartition(")")[2].split()
        except OSError:
            continue  # the process has ended
        if int(stat.parent.name) == pid or int(fields[1]) == pid:
            found += (int(fields[11]) + int(fields[12])) / ticks
    return found
