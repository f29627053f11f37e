"""Where the time of a compiled scan goes, measured from outside: nothing can be wrapped inside it.

The rig's ports are ordinary objects, so the wires and the devices behind them are timed there. Control and recorder are
called repeatedly at one moment of a slide; this changes only the run, which is discarded. The rest of a tick belongs to
drivers and engine.
"""

from __future__ import annotations

from collections.abc import Callable
from statistics import median

from bench.effort import Effort
from bench.figures import Figure, Limit
from bench.live import SLIDING_RECIPE, LiveRun, live_run
from bench.stopwatch import cpu_us_per, wall_ns
from drivers.ports import CanFrame, CanPort, CanWatcher, ForeseeingPort, LineWatcher, Unwatch
from tester.machine.tickers import collector_at_rest, next_tick

REPEATED = 2000
"""Number of calls at one moment."""


class Toll:
    """Time spent behind the ports, ns, and the number of calls."""

    def __init__(self) -> None:
        """Nothing is spent yet."""
        self.ns = 0
        self.calls = 0

    def pay(self, begun_ns: int) -> None:
        """Add a call that began at a time."""
        self.ns += wall_ns() - begun_ns
        self.calls += 1


class TimedCan:
    """A CAN port that measures its own time."""

    def __init__(self, port: CanPort, toll: Toll) -> None:
        """Stand before ``port``."""
        self.port = port
        self.toll = toll

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Pass a frame on."""
        begun = wall_ns()
        self.port.send(can_id, data, now)
        self.toll.pay(begun)

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Pass a bus cycle on."""
        begun = wall_ns()
        self.port.send_cycle(can_ids, payloads, now)
        self.toll.pay(begun)

    def receive(self, now: float) -> list[CanFrame]:
        """Fetch what arrived."""
        begun = wall_ns()
        frames = self.port.receive(now)
        self.toll.pay(begun)
        return frames

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Watch the port itself."""
        return self.port.watch(watcher)


class TimedLine:
    """A simulated Modbus line that measures its own time."""

    def __init__(self, port: ForeseeingPort, toll: Toll) -> None:
        """Stand before ``port``."""
        self.port = port
        self.toll = toll

    @property
    def arrives_s(self) -> float:
        """When the next bytes arrive, s."""
        return self.port.arrives_s

    def write(self, data: bytes, now: float) -> None:
        """Pass a request on."""
        begun = wall_ns()
        self.port.write(data, now)
        self.toll.pay(begun)

    def read(self, now: float) -> list[tuple[float, bytes]]:
        """Fetch what arrived."""
        begun = wall_ns()
        chunks = self.port.read(now)
        self.toll.pay(begun)
        return chunks

    def watch(self, watcher: LineWatcher) -> Unwatch:
        """Watch the port itself."""
        return self.port.watch(watcher)


class Empty:
    """A bus on which nothing happens, to measure the cost of timing."""

    def send_cycle(self, can_ids: tuple[int, ...], payloads: tuple[bytes, ...], now: float) -> None:
        """Do nothing."""

    def send(self, can_id: int, data: bytes, now: float) -> None:
        """Do nothing."""

    def receive(self, now: float) -> list[CanFrame]:
        """Return nothing."""
        return []

    def watch(self, watcher: CanWatcher) -> Unwatch:
        """Report nothing."""
        return lambda: None


def measure(effort: Effort, limits: dict[str, Limit]) -> list[Figure]:
    """Return the medians of the parts in a sliding phase at 100 Hz; ``limits`` by the parts' names."""
    seconds = effort.pick(30.0, 10.0)
    columns: dict[str, list[float]] = {}
    with live_run(SLIDING_RECIPE) as live:
        toll = Toll()
        devices = live.engine.devices
        lines = [port for port, _ in devices.lines]
        foreseeing = [port for port in lines if isinstance(port, ForeseeingPort)]
        devices.rewire(TimedCan(devices.can, toll), [TimedLine(port, toll) for port in foreseeing])
        for _ in range(effort.runs):
            live.slide(seconds)
            for name, value in _parts(live, toll, seconds).items():
                columns.setdefault(name, []).append(value)
    notes = {"drivers": "with the engine's own: what is left of a tick", "recorder": "in the scan"}
    return [Figure(name, "us", tuple(runs), limits.get(name), notes.get(name, "")) for name, runs in columns.items()]


def _parts(live: LiveRun, toll: Toll, seconds: float) -> dict[str, float]:
    """Return the medians of one phase, us a scan."""
    inside_ns, outside_ns = _own_cost()
    world, left, wires = _ticks(live, toll, seconds, inside_ns, outside_ns)
    engine = live.engine
    ctx, control = engine.ctx, engine.control
    deciding = {
        "control": _again(lambda: control.step(ctx.demand, ctx.readings, engine.period_s)),
        "executor": _again(lambda: engine.executor.step(ctx)) + _again(lambda: ctx.gates.update(ctx.readings, ctx.dt)),
    }
    recorder = _again(lambda: engine.sampler.record(ctx, control.state.setpoints))
    decided = sum(deciding.values())
    drivers = median(left) - decided - recorder
    return {
        "plant and axes": median(world),
        "wires, nodes, sensors": median(wires),
        "drivers": drivers,
        **deciding,
        "control + executor + engine": decided,
        "recorder": recorder,
        "sum of the parts": median(world) + median(wires) + drivers + decided + recorder,
    }


def _ticks(
    live: LiveRun, toll: Toll, seconds: float, inside_ns: float, outside_ns: float
) -> tuple[list[float], list[float], list[float]]:
    """Tick through a phase; return us of the rig's advance, of the tick without its wires, of the wires, per scan."""
    world: list[float] = []
    left: list[float] = []
    wires: list[float] = []
    advance, tick, end = live.world.advance, live.run.tick, live.now + seconds
    with collector_at_rest():
        while live.now < end:
            now = live.now
            toll.ns = toll.calls = 0
            begun = wall_ns()
            advance(now)
            advanced = wall_ns()
            due = tick(now)
            ticked = wall_ns()
            live.now = next_tick(now, due, live.world.urgent_s)
            behind = toll.ns - toll.calls * inside_ns
            world.append((advanced - begun) * 1e-3)
            wires.append(behind * 1e-3)
            left.append((ticked - advanced - behind - toll.calls * (inside_ns + outside_ns)) * 1e-3)
    return world, left, wires


def _own_cost() -> tuple[float, float]:
    """Return the cost of timing a call, ns: inside its span, and around it."""
    toll = Toll()
    port = TimedCan(Empty(), toll)
    begun = wall_ns()
    for _ in range(REPEATED):
        port.send_cycle((), (), 0.0)
    whole = wall_ns() - begun
    return toll.ns / REPEATED, (whole - toll.ns) / REPEATED


def _again(call: Callable[[], object]) -> float:
    """Return the CPU us of a call, averaged over many."""

    def work(count: int) -> None:
        for _ in range(count):
            call()

    return cpu_us_per(work, REPEATED)
