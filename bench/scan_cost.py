"""Where the time of a scan goes: every part's own time, with the cost of measuring taken off.

Each entry point of a part is wrapped while a run is built and ticked, outside the product: the wrapper charges the time
since the last change to the part that was running, and switches parts. The wrapper's own cost, determined by wrapping a
function that does nothing, is subtracted for every call. Spans are of the wall clock, because reading the CPU clock
costs as much as the spans last; the median of thousands of scans leaves out those that were interrupted.
"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median

from bench import scan_outside
from bench.effort import Effort
from bench.figures import Figure, at_most
from bench.ledger import PARTS, Ledger
from bench.live import SLIDING_RECIPE, LiveRun, live_run
from bench.machine import scan_is_compiled
from bench.stopwatch import cpu_seconds_of
from bench.wrapping import wrapped
from tester.machine.tickers import collector_at_rest

DRIVERS_LIMIT_US = 12.0
DECIDING_LIMIT_US = 10.0
RECORDER_LIMIT_US = 3.0
"""Limits of the medians; "control and executor" includes everything in a scan except drivers and recorder."""

GROUPS: dict[str, tuple[str, ...]] = {
    "nodes": tuple(name for name in PARTS if name.startswith("nodes")),
    "bus": tuple(name for name in PARTS if name.startswith("bus")),
    "drivers": tuple(name for name in PARTS if name.startswith("drivers")),
    "control + executor + engine": ("control", "executor", "engine"),
    "plant + nodes + bus + twin": tuple(name for name in PARTS if name.startswith(("plant", "nodes", "bus", "twin"))),
    "sum of the parts": PARTS,
}
"""Sums of parts, taken in every scan before the median is."""

ORDER = (
    "plant", "nodes", *GROUPS["nodes"], "bus", *GROUPS["bus"], "twin", "plant + nodes + bus + twin",
    "drivers", *GROUPS["drivers"], "control", "executor", "engine", "control + executor + engine", "recorder",
    "sum of the parts",
)  # fmt: skip
LIMITS = {
    "drivers": at_most(DRIVERS_LIMIT_US),
    "control + executor + engine": at_most(DECIDING_LIMIT_US),
    "recorder": at_most(RECORDER_LIMIT_US),
}
NOTES = {
    "plant": "friction, heat, contact, wear, sensors",
    "nodes": "five drives, three Modbus slaves",
    "bus": "wire times, queues",
    "twin": "what holds the simulated rig together",
    "engine": "rest of the scan: rate, wear, journal",
    "recorder": "in the scan; the writer's thread: topic recorder",
}


def measure(effort: Effort) -> list[Figure]:
    """Return the medians of every part in a sliding phase at 100 Hz, and the whole without instruments."""
    seconds = effort.pick(30.0, 10.0)
    whole, ticks = _whole(seconds, effort.runs)
    whole_figures = [
        Figure("whole scan without instruments, mean", "us CPU", tuple(whole), note="all threads"),
        Figure("ticks for a scan", "", tuple(ticks), note="those between scans serve heartbeats and time-outs"),
    ]
    if scan_is_compiled() == "yes":
        return scan_outside.measure(effort, LIMITS) + whole_figures
    columns: dict[str, list[float]] = {}
    ledger = Ledger()
    with wrapped(ledger) as missing, live_run(SLIDING_RECIPE) as live:
        for _ in range(effort.runs):
            live.slide(seconds)
            for name, value in summary(_scans(live, ledger, seconds)).items():
                columns.setdefault(name, []).append(value)
    figures = [_figure(name, columns[name]) for name in ORDER]
    figures += [Figure("sum of the parts, mean", "us", tuple(columns["mean"])), *whole_figures]
    if missing:
        note = f"their time counts with the caller's: {', '.join(missing)}"
        figures.append(Figure("entry points not found", "", (float(len(missing)),), note=note))
    return figures


def _figure(name: str, runs: list[float]) -> Figure:
    """Return a part's line; members of a group are indented below it."""
    group, colon, part = name.partition(": ")
    shown = f"  {part}" if colon and group in GROUPS else name
    return Figure(shown, "us", tuple(runs), LIMITS.get(name), NOTES.get(name, ""))


def _whole(seconds: float, runs: int) -> tuple[list[float], list[float]]:
    """Return CPU us per scan of the unwrapped code, and ticks per scan."""
    costs: list[float] = []
    ticks: list[float] = []
    with live_run(SLIDING_RECIPE) as live:
        for _ in range(runs):
            live.slide(seconds)
            scans, turns = live.engine.scans, live.ticks
            with collector_at_rest():
                cpu_s = cpu_seconds_of(lambda: live.advance(seconds))
            scans, turns = live.engine.scans - scans, live.ticks - turns
            costs.append(cpu_s * 1e6 / scans)
            ticks.append(turns / scans)
    return costs, ticks


def _scans(live: LiveRun, ledger: Ledger, seconds: float) -> list[tuple[float, ...]]:
    """Return the us of every part for each scan of a phase; ticks between scans count with the scan before."""
    found: list[tuple[float, ...]] = []
    engine, end = live.engine, live.now + seconds
    with collector_at_rest():
        ledger.take()
        last = engine.scans
        while live.now < end:
            live.tick()
            if engine.scans != last:
                last = engine.scans
                found.append(ledger.take())
    return found


def summary(scans: Sequence[tuple[float, ...]]) -> dict[str, float]:
    """Return the median of every part and of every group, and the mean of the whole, us."""
    place = {name: i for i, name in enumerate(PARTS)}

    def middle(*names: str) -> float:
        places = [place[name] for name in names]
        return median(sum(scan[i] for i in places) for scan in scans)

    medians = {name: middle(name) for name in PARTS}
    medians |= {group: middle(*names) for group, names in GROUPS.items()}
    return medians | {"mean": sum(map(sum, scans)) / len(scans)}
