"""Probes of the CAN bus, of its traffic, and of the nodes that are no drives."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from drivers.canopen import objects as o
from sim.wires.can_traffic import frame_bits
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, note, ok, warning

LOAD_MOST = 0.6
"""Greatest acceptable load of the bus: above it, frames arrive after their scan, share [A]."""
BEAT_OFF = 0.2
"""Greatest relative difference between a heartbeat's period and its object [A]."""
MISSED = 3
BUS = "CAN bus"
WIRING = "drives' supply, the plug, CAN high and low, 120 ohm terminators at both ends, can.bitrate"
NODE_WIRING = "its supply, its plug, its node number, its bit rate"


def bus(e: Examination) -> Iterator[Finding]:
    """Check that the bus works, and report the bit rate at which its nodes answer."""
    can, bitrate = e.can, e.rig.can.bitrate
    if can.answers_at:
        yield fault(
            BUS, f"nodes answer at a bit rate of {can.answers_at} bit/s, the rig file has {bitrate}",
            f"set can.bitrate to {can.answers_at}, or the drives to {bitrate}",
        )  # fmt: skip
        return
    if can.lost:
        yield fault(BUS, can.lost, f"another bit rate on the bus, or no node acknowledges: look at {WIRING}")
    elif not can.present and not can.traffic.frames:
        yield fault(BUS, f"silent at {bitrate} bit/s: no frame arrived, and no node answers", f"look at {WIRING}")
    elif not can.present:
        yield fault(BUS, "frames arrive, but no node answers an SDO request", "switch the drives off and on")
    else:
        yield ok(BUS, f"{bitrate} bit/s, nodes {', '.join(map(str, can.present))}")


def masters(e: Examination) -> Iterator[Finding]:
    """Report frames that only a master sends; they were received while the doctor sent none."""
    senders = [*e.can.traffic.masters, *e.watch.can.masters]
    if senders:
        yield fault(
            BUS, f"another master is sending: {', '.join(dict.fromkeys(senders))}",
            "two masters command one machine: end the other program, or unplug the maker's set-up tool",
        )  # fmt: skip


def load(e: Examination) -> Iterator[Finding]:
    """Report the present load of the bus, and the load with a run's scans."""
    watch = e.watch.can
    if e.watch.can_lost and not e.can.lost:
        yield fault(BUS, f"lost while it was watched: {e.watch.can_lost}", f"look at {WIRING}")
    if not watch.seconds or e.can.lost:
        return
    bits = sum(frame_bits(length) * count for length, count in watch.lengths.items())
    now = bits / watch.seconds / e.rig.can.bitrate
    per_scan = frame_bits(0) + sum(frame_bits(6) + frame_bits(8) for _ in e.rig.drives())
    run = now + per_scan * e.rig.scan.sliding_hz / e.rig.can.bitrate
    text = f"load {100 * now:.1f} % now, up to {100 * run:.0f} % while a run is sliding"
    remedy = "a higher bit rate, a lower scan.sliding, or nodes taken off the bus"
    yield warning(BUS, text, remedy) if run > LOAD_MOST else ok(BUS, text)


def heartbeats(e: Examination) -> Iterator[Finding]:
    """Compare every node's heartbeat with its object 0x1017."""
    seconds = e.watch.can.seconds
    for name, config in e.rig.drives().items():
        asked_ms = e.can.number(config.node_id, (o.PRODUCER_HEARTBEAT, 0))
        if asked_ms is None:
            continue
        if asked_ms == 0:
            written_ms = 1e3 * config.heartbeat_s
            yield note(name, f"sends no heartbeat yet (0x1017 = 0); every connect writes {written_ms:g} ms")
            continue
        beats, period_s = e.watch.can.beats.get(config.node_id, []), asked_ms / 1000.0
        if len(beats) < 2 and seconds > MISSED * period_s:
            yield fault(
                name, f"no heartbeat arrives, though 0x1017 asks for one every {asked_ms} ms",
                "the drive's firmware or its CAN set-up: a run would take this drive for lost",
            )  # fmt: skip
            continue
        if len(beats) < 2:
            continue
        measured_s = (beats[-1] - beats[0]) / (len(beats) - 1)
        longest_s = max(b - a for a, b in pairwise(beats))
        if abs(measured_s - period_s) > BEAT_OFF * period_s or longest_s > MISSED * period_s:
            yield warning(
                name, f"heartbeat every {1e3 * measured_s:.0f} ms, at most {1e3 * longest_s:.0f} ms apart;"
                f" 0x1017 holds {asked_ms} ms", "the bus load, and the drive's CAN set-up",
            )  # fmt: skip
        else:
            yield ok(name, f"heartbeat every {1e3 * measured_s:.0f} ms")


def strangers(e: Examination) -> Iterator[Finding]:
    """Report nodes that answer but are not in the rig file, and the rig file's further nodes that do not answer."""
    known = {config.node_id for config in e.rig.drives().values()}
    further = {config.node_id: name for name, config in e.rig.can.nodes.items()}
    for node, name in further.items():
        if not e.can.lost and node not in e.can.present:
            yield fault(name, f"nothing answers at node {node}", NODE_WIRING)
        elif node in e.can.present:
            yield ok(name, f"node {node}: {e.can.text(node, (o.DEVICE_NAME, 0)) or 'no name'}")
    for node in sorted({*e.can.present} - known - {*further}):
        name = e.can.text(node, (o.DEVICE_NAME, 0)) or "no name"
        serial = e.can.number(node, (o.IDENTITY, 4))
        yield warning(
            BUS, f"node {node} is not in the rig file: {name}, serial number {serial}",
            "a device that no run watches: add it to the rig file, or take it off the bus",
        )  # fmt: skip


def emergencies(e: Examination) -> Iterator[Finding]:
    """Report emergencies sent while the doctor listened."""
    names = {config.node_id: name for name, config in e.rig.drives().items()}
    for node, data in {**e.can.traffic.emergencies, **e.watch.can.emergencies}.items():
        code = int.from_bytes(data[:2], "little")
        if code:
            advice = "end other programs on it" if code == o.MACHINE_LATE else "the drive's manual"
            yield warning(names.get(node, f"node {node}"), f"emergency: {o.emergency_text(code)}", advice)


_STATES = {
    "passive": "error-passive: after many errors it no longer marks its own",
    "error": "in an error state: it no longer takes part",
}


def errors(e: Examination) -> Iterator[Finding]:
    """Count error frames and report the adapter's state, if the adapter reports them."""
    watch = e.watch
    if watch.can_errors is not None and watch.seconds:
        count = sum(watch.can_errors.values())
        kinds = ", ".join(f"{number} {kind}" for kind, number in watch.can_errors.items())
        if count:
            yield warning(BUS, f"error frames in {watch.seconds:.0f} s: {kinds}", f"look at {WIRING}; shields, stubs")
        else:
            yield ok(BUS, f"no error frame in {watch.seconds:.0f} s")
    words = _STATES.get(watch.can_state)
    if words is not None:
        yield fault(BUS, f"the adapter is {words}", f"look at {WIRING}; plug the adapter out and in")
