"""The quickstart's bus traffic: start-up, drive states, SYNC, pre-grind, shutdown."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from tests.campaigns.acceptance.bench import Bench, RunSpec
from tests.campaigns.acceptance.can_record import Axis, CanRecord
from tests.campaigns.acceptance.cell_record import CellRecord
from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds, near
from tests.campaigns.acceptance.topic import Topic
from tests.campaigns.acceptance.truth import SHARED

Vector = np.ndarray[Any, Any]

PC = 127
SYNC_ID = 0x080
NMT_START, NMT_STOP, NMT_PRE_OPERATIONAL = 1, 2, 128
OPERATIONAL = 5
STATES = {0x40: "disabled", 0x21: "ready", 0x23: "on", 0x27: "enabled"}
STATES |= {0x07: "quick stop", 0x0F: "reacting", 0x08: "fault"}
"""Names of statusword & 0x6F (CiA 402-2); bit 5 means nothing with the power off, so 0x60 is 0x40."""
NEIGHBOURS = {("disabled", "ready"), ("ready", "on"), ("on", "enabled")}
PROOF = [0x8130, 0x0000]
"""A drive's emergency codes when a heartbeat is missing, and when it is back (CiA 301, table 26)."""
WHEEL_RADIUS_M = 0.045
WHEEL, BELT, LOAD_N, GRIND_S = 0.8, 0.6, 200.0, 240.0
"""The pre-grind of the recipe: rim and belt speed in m/s."""
SPEED_SHARE = 0.01
SLIDING_M_S = 0.02
"""In contact, the wheel slides above this speed difference between rim and belt; wear alone causes 0.004 m/s."""
CONTACT_N = 20.0
TOUCHED_N = 8.0
"""Half of a wheel's first contact load, well above the noise; the zero is taken before the first contact."""


def runs(bench: Bench) -> list[RunSpec]:
    """Name the run."""
    return [SHARED]


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    run = bench.run(SHARED)
    yield equal("exit code of the run", run.outcome.code, 0)
    record, cell = CanRecord(run.bus_log), CellRecord(run.bus_log / "modbus-load_cell.log")
    yield from _frames(record, cell)
    yield from _start_up(record)
    for axis in record.axes.values():
        yield from _states(record, axis)
    yield from _sync(record, cell)
    yield from _pre_grind(record, cell)
    yield from _shutdown(record, cell)


def _frames(record: CanRecord, cell: CellRecord) -> Iterator[Figure]:
    """Yield figures about all frames."""
    yield holds("CAN frames in the log", record.count > 0, f"{record.count} over {record.end_s:.1f} s", "some")
    yield equal("frames back in time", record.backward, 0)
    unknown = sorted(f"{can_id:03X}" for can_id in set(record.frames) - record.known_ids())
    yield equal("unknown identifiers", unknown, [])
    yield equal("frames with 29-bit identifiers", record.extended, 0)
    messages = [_emergencies(record, axis.node) for axis in record.axes.values()]
    proved = all([code for _, code in each] == PROOF for each in messages)
    seen = " ".join(f"{code:04X}" for each in messages for _, code in each)
    yield holds("emergency messages: to the proof of each watchdog only", proved, seen, "8130 0000 each")
    yield equal("load cell replies with a wrong CRC", cell.bad_frames, 0)


def _start_up(record: CanRecord) -> Iterator[Figure]:
    """Yield boot-up, identity, heartbeats and NMT start of the five nodes."""
    axes = list(record.axes.values())
    nodes = [axis.node for axis in axes]
    yield equal("nodes", sorted(nodes), [1, 2, 3, 4, 5])
    boots = [sum(state == 0 for _, state in record.heartbeats(node)) for node in nodes]
    yield equal("boot-up messages of each node: power-on, reset by the connection", boots, [2] * 5)
    vendor, product = (record.variable(0x1018, sub).default for sub in (1, 2))
    expected = [f"{vendor:X}:{product:X}"] * 5
    identities = [_identity(record, node) for node in nodes]
    yield equal("identity read from 0x1018:01 and :02 of each node", identities, expected)
    first_beat = record.times(0x700 + PC)[0]
    armed, starts = [_armed(record, node) for node in nodes], [_started(record, node) for node in nodes]
    values = [value for _, value in armed]
    yield equal("0x1016:01 of each node: written, then read back alike", values, [f"{PC}:200"] * 5)
    early = first_beat < min(t for t, _ in armed)
    limit = f"before it is armed at {armed[0][0]:.3f} s"
    yield holds("heartbeat of the PC begins", early, f"at {first_beat:.3f} s", limit)
    after = all(t < start < float("inf") for (t, _), start in zip(armed, starts, strict=True))
    times = " ".join(f"{t:.3f}" for t in starts)
    yield holds("NMT start of each node by itself, operational after it", after, f"at {times} s", "after arming")
    late = min(t for axis in axes for t, words in _timed(record, axis) if words == "enabled")
    limit = f"after the last start, {max(starts):.3f} s"
    yield holds("first drive enabled", late > max(starts), f"at {late:.3f} s", limit)


def _identity(record: CanRecord, node: int) -> str:
    read = {x.sub: x.value for x in record.transfers(node) if x.index == 0x1018 and not x.written}
    return f"{read.get(1, 0):X}:{read.get(2, 0):X}"


def _armed(record: CanRecord, node: int) -> tuple[float, str]:
    """Return when a node's first consumer heartbeat read back as written, and node:time in ms."""
    transfers = [x for x in record.transfers(node) if (x.index, x.sub) == (0x1016, 1)]
    written, read = next(x for x in transfers if x.written), next(x for x in transfers if not x.written)
    value = f"{written.value >> 16}:{written.value & 0xFFFF}"
    if read.t < written.t or read.value != written.value:
        value += f", read {read.value:X} at {read.t:.3f} s"
    return read.t, value


def _emergencies(record: CanRecord, node: int) -> list[tuple[float, int]]:
    """Return a node's emergency messages: time in s, code."""
    return [(t, int.from_bytes(data[:2], "little")) for t, data in record.frames[0x080 + node]]


def _started(record: CanRecord, node: int) -> float:
    """Return when a node was started; infinity if it did not become operational."""
    start = next((t for t, command in record.nmt(node) if command == NMT_START), float("inf"))
    beats = [state for t, state in record.heartbeats(node) if start < t < start + 0.2]
    return start if OPERATIONAL in beats else float("inf")


STATUS_BYTES = 2
"""Length of a TPDO2 that contains the statusword; the other length contains digital inputs."""


def _timed(record: CanRecord, axis: Axis) -> list[tuple[float, str]]:
    """Return the changes of a drive's state: time, name."""
    words_at = list(zip(record.times(0x180 + axis.node).tolist(), record.readings(axis)["6041"].tolist(), strict=True))
    # Wheel and belt also report a change at once: the next scan may command another one before TPDO1 is due.
    at_once = (frame for frame in record.frames[0x280 + axis.node] if len(frame[1]) == STATUS_BYTES)
    words_at += [(t, int.from_bytes(data, "little")) for t, data in at_once]
    words_at.sort(key=lambda one: one[0])
    times, words = [t for t, _ in words_at], np.array([word for _, word in words_at])
    words = words & 0x6F
    words = np.where((words & 0x4F) == 0x40, 0x40, np.where((words & 0x48) == 0x08, words & 0x4F, words))
    changes = np.flatnonzero(np.diff(words, prepend=-1))
    return [(times[at], STATES.get(int(words[at]), f"{words[at]:02X}")) for at in changes]


def _states(record: CanRecord, axis: Axis) -> Iterator[Figure]:
    """Yield the order of commands and states of one drive."""
    commands = record.commands(axis)
    words = commands["6040"].astype(int) & 0x8F
    changes = words[np.flatnonzero(np.diff(words, prepend=-1))].tolist()
    first = changes[: changes.index(15) + 1] if 15 in changes else changes
    yield equal(f"{axis.name}: controlwords until enabled", first, [0, 6, 7, 15])
    yield equal(f"{axis.name}: controlwords at the end", changes[-4:], [15, 7, 6, 0])
    timed = _timed(record, axis)
    states = [state for _, state in timed]
    reached = states[: states.index("enabled") + 1] if "enabled" in states else states
    yield equal(f"{axis.name}: states until enabled", reached, ["disabled", "ready", "on", "enabled"])
    proved_s = max((t for t, _ in _emergencies(record, axis.node)), default=0.0)
    pairs = list(pairwise([state for t, state in timed if t > proved_s]))
    odd = [f"{a}>{b}" for a, b in pairs if (a, b) not in NEIGHBOURS and (b, a) not in NEIGHBOURS]
    yield equal(f"{axis.name}: of {len(pairs)} changes of state after that proof, those not to a neighbour", odd, [])
    if axis.mode == "velocity":
        enabled = (words == 15) & (np.concatenate(([0], words[:-1])) != 15)
        targets = sorted(set(commands["60FF"][enabled].tolist()))
        yield equal(f"{axis.name}: target velocity with the first controlword 15", targets, [0])


def _sync(record: CanRecord, cell: CellRecord) -> Iterator[Figure]:
    """Yield the rate of SYNC while the wheel slides, and whether each SYNC has one set of PDOs."""
    sync = record.times(SYNC_ID)
    difference = np.abs(_speeds(record, "wheel", sync) - _speeds(record, "belt", sync))
    loads = np.interp(sync, cell.times_s, cell.raw_n)
    sliding = (difference > SLIDING_M_S) & (loads > CONTACT_N)
    both = sliding[:-1] & sliding[1:]
    periods = 1000.0 * np.diff(sync)[both]
    yield holds("time of sliding in contact", periods.sum() > 240e3, f"{periods.sum() / 1e3:.1f} s", "over 240 s")
    yield near("SYNC while sliding: rate", len(periods) / periods.sum() * 1e3, 100.0, 0.1, "Hz", 3)
    spread = f"{periods.min():.2f} to {periods.max():.2f} ms"
    fits = bool(abs(periods - 10.0).max() <= 0.5)
    yield holds(f"SYNC while sliding: {len(periods)} periods", fits, spread, "10 +- 0.5 ms")
    odd = {
        f"{base + axis.node:03X}": int((counts[:-1][both] != 1).sum())
        for axis in record.axes.values()
        for base, counts in ((0x200, _before(record, axis, sync)), (0x180, _after(record, axis, sync)))
    }
    yield equal("SYNC periods while sliding without exactly one RPDO1 and one TPDO1 a drive", sum(odd.values()), 0)
    extra = [name for name, count in odd.items() if count]
    yield equal("identifiers concerned", extra, [])


def _speeds(record: CanRecord, name: str, sync: Vector) -> Vector:
    """Return an axis' surface speed in m/s as reported after each SYNC; NaN if not reported."""
    axis = record.axes[name]
    radius = WHEEL_RADIUS_M if axis.unit == "rad/s" else 1.0
    speeds = record.readings(axis)["606C"] * (radius / axis.velocity_counts)
    found = np.full(len(sync), np.nan)
    place = np.searchsorted(sync, record.times(0x180 + axis.node), "right") - 1
    found[place[place >= 0]] = speeds[place >= 0]
    return found


def _after(record: CanRecord, axis: Axis, sync: Vector) -> Vector:
    """Return how many TPDO1 follow each SYNC."""
    place = np.searchsorted(sync, record.times(0x180 + axis.node), "right") - 1
    return np.bincount(place[place >= 0], minlength=len(sync))


def _before(record: CanRecord, axis: Axis, sync: Vector) -> Vector:
    """Return how many RPDO1 lie between each SYNC and the one before it."""
    place = np.searchsorted(sync, record.times(0x200 + axis.node), "left")
    return np.bincount(place, minlength=len(sync) + 1)[: len(sync)]


def _pre_grind(record: CanRecord, cell: CellRecord) -> Iterator[Figure]:
    """Yield the pre-grind: commanded speeds of wheel and belt, its duration, and the load."""
    belt, wheel = record.axes["belt"], record.axes["wheel"]
    asked = record.commands(belt)["60FF"] / belt.velocity_counts
    times = record.times(0x200 + belt.node)
    at = np.flatnonzero(np.abs(asked - BELT) < 0.005)
    # The longest stretch: other moves pass through this speed or hold it briefly.
    stretches = np.split(at, np.flatnonzero(np.diff(at) > 1) + 1)
    longest = max(stretches, key=len)
    begin, end = longest[0], longest[-1]
    yield near("pre-grind: target of the belt (0x60FF)", float(asked[begin]), BELT, 0.0005, "m/s", 4)
    chosen = _between(record.times(0x200 + wheel.node), times[begin], times[end])
    rim = record.commands(wheel)["60FF"][chosen] / wheel.velocity_counts * WHEEL_RADIUS_M
    spread = f"{rim.min():.4f} to {rim.max():.4f} m/s"
    fits = bool(abs(rim[0] - WHEEL) <= 0.001 and rim.min() >= WHEEL - 0.001 and rim.max() <= WHEEL + 0.004)
    yield holds("pre-grind: target of the wheel at the radius of a new one (0x60FF)", fits, spread,
                f"{WHEEL} m/s, then rising with wear by less than 0.5 %")  # fmt: skip
    sync = record.times(SYNC_ID)
    ground_s = sync[(sync >= times[begin]) & (sync <= times[end] + 1.0)]
    wheel_m_s = _speeds(record, "wheel", ground_s) * (WHEEL / rim.mean())
    belt_m_s = _speeds(record, "belt", ground_s)
    reached = (np.abs(wheel_m_s - WHEEL) <= SPEED_SHARE * WHEEL) & (np.abs(belt_m_s - BELT) <= SPEED_SHARE * BELT)
    first_touch = cell.times_s[np.flatnonzero(cell.raw_n > TOUCHED_N)[0]]
    zero = cell.zero_n(first_touch - 1.0)
    loads = cell.trailing_mean_n(ground_s, 1.0) - zero
    in_band = np.abs(loads - LOAD_N) <= 0.02 * LOAD_N
    good = np.flatnonzero(reached & in_band)
    span = ground_s[good[-1]] - ground_s[good[0]]
    yield near("pre-grind: both actual speeds within 1 % (0x606C) and load within 2 % (1 s mean)", float(span), GRIND_S,
               0.1, "s", 3)  # fmt: skip
    yield equal("pre-grind: ticks in between with a speed or the load off", int(good[-1] - good[0] + 1 - len(good)), 0)
    within = loads[good[0] : good[-1] + 1]
    spread = f"{within.min():.2f} to {within.max():.2f} N (zero {zero:+.2f} N taken off)"
    fits = bool(np.abs(within - LOAD_N).max() <= 0.02 * LOAD_N)
    yield holds("pre-grind: load, 1 s mean", fits, spread, f"{LOAD_N:g} N +- 2 %")


def _between(times: Vector, first_s: float, last_s: float) -> Vector:
    return (times >= first_s - 0.002) & (times <= last_s + 0.002)


def _shutdown(record: CanRecord, cell: CellRecord) -> Iterator[Figure]:
    """Yield how the run ends: lifted, stopped, disabled, disarmed, pre-operational."""
    moving = {axis.name: axis for axis in record.axes.values() if axis.mode == "velocity"}
    zeroed = {name: _last_moving(record, axis) for name, axis in moving.items()}
    off = {axis.name: _timed(record, axis)[-1] for axis in record.axes.values()}
    yield equal("shutdown: last state of each drive", [state for _, state in off.values()], ["disabled"] * 5)
    disabled = _first_after(record, min(zeroed.values()))
    sync = record.times(SYNC_ID)
    at = int(np.searchsorted(sync, disabled))
    standing = [abs(float(_speeds(record, name, sync)[at])) for name in ("wheel", "belt")]
    slow = all(speed < 0.01 for speed in standing)
    text = f"{standing[0]:.4f} {standing[1]:.4f} m/s at {disabled:.3f} s"
    yield holds("shutdown: wheel and belt when the first drive is told to switch off", slow, text, "under 0.01 m/s")
    stop = min(zeroed["wheel"], zeroed["belt"])
    load = float(cell.trailing_mean_n(np.array([stop]), 0.025)[0])
    yield at_most("shutdown: load before wheel or belt is told to stop", abs(load), 5.0, "N", 2)
    order = ["all targets zero", "all disabled", "0x1016 cleared", "pre-operational or stopped"]
    times = [max(zeroed.values()), max(t for t, _ in off.values())]
    cleared, released = [], []
    for axis in record.axes.values():
        last = [x for x in record.transfers(axis.node) if (x.index, x.sub) == (0x1016, 1)][-2:]
        done = len(last) == 2 and last[0].written and not last[1].written and last[0].value == last[1].value == 0
        cleared.append(last[-1].t if done else float("nan"))
        t, command = record.nmt(axis.node)[-1]
        released.append(t if command in (NMT_STOP, NMT_PRE_OPERATIONAL) else float("nan"))
    yield equal("shutdown: nodes with 0x1016 cleared and read back", int(np.isfinite(cleared).sum()), 5)
    yield equal("shutdown: nodes put into pre-operational or stopped", int(np.isfinite(released).sum()), 5)
    a_node = zip((t for t, _ in off.values()), cleared, released, strict=True)
    ordered = times[0] <= times[1] and all(one < two < three for one, two, three in a_node)
    words = ", ".join(f"{name} {t:.3f} s" for name, t in zip(order, [*times, max(cleared), max(released)], strict=True))
    yield holds("shutdown: order", ordered, words, "in this order for each drive")
    began = min(zeroed.values())
    yield at_most("shutdown: from the first axis stopped to the last frame", record.end_s - began, 5.0, "s")


def _last_moving(record: CanRecord, axis: Axis) -> float:
    """Return when an axis last received a command to move."""
    targets = record.commands(axis)["60FF"]
    return float(record.times(0x200 + axis.node)[np.flatnonzero(targets)[-1]])


def _first_after(record: CanRecord, t: float) -> float:
    """Return when, after a given time, a drive first received a command to leave the enabled state."""
    found: list[float] = []
    for axis in record.axes.values():
        times, words = record.times(0x200 + axis.node), record.commands(axis)["6040"].astype(int) & 0x0F
        found += times[(times > t) & (words != 15)][:1].tolist()
    return min(found)


TOPIC = Topic("bus", "the frames of a run: start-up, drive states, SYNC, pre-grind, shutdown", figures, runs)
