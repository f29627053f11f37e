"""Probes of the CAN bus and of its nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import pairwise

from drivers import cia402
from drivers.axis import AxisConfig
from drivers.canopen import objects as o
from drivers.canopen.dictionary import describe
from drivers.canopen.messages import state_name
from drivers.cia402 import State
from drivers.drive_settings import RATED_TORQUE_SHARE
from sim.wires.can_traffic import frame_bits
from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, note, ok, warning
from tester.machine.devices import INPUT_GUARD, INPUT_SAFETY_CHAIN
from tester.run.set_up import mapped, written

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


def axes(e: Examination) -> Iterator[Finding]:
    """Compare every drive with its axis in the rig file."""
    if not e.can.present:
        return
    configs = e.rig.drives()
    serials = {config.serial_number: name for name, config in configs.items() if config.serial_number}
    for name, config in configs.items():
        if config.node_id not in e.can.present:
            yield _not_there(e, name, config)
            continue
        yield from _identity(e, name, config, serials)
        if config.node_id in e.can.surplus:
            times = e.can.surplus[config.node_id]
            yield fault(
                name, f"node {config.node_id} answered {times} question more than once: two nodes have one node number",
                "unplug one drive after the other and see which still answers; give one drive another number",
            )  # fmt: skip
        yield from _drive_state(e, name, config)
        yield from _objects(e, name, config)


def _not_there(e: Examination, name: str, config: AxisConfig) -> Finding:
    known = {other.node_id for other in (*e.rig.drives().values(), *e.rig.can.nodes.values())}
    for node in sorted({*e.can.present} - known):
        serial = e.can.number(node, (o.IDENTITY, 4))
        same = serial == config.serial_number if config.serial_number else _same_type(e, node, config)
        if same:
            return fault(
                name, f"nothing answers at node {config.node_id}; node {node}, not in the rig file, is such a drive",
                f"set the drive's node number to {config.node_id}, or axes.{name}.node_id to {node}",
            )  # fmt: skip
    state = e.can.traffic.states.get(config.node_id)
    if state is not None:
        return fault(
            name, f"node {config.node_id} sends heartbeats ({state_name(state)}) and answers no SDO request",
            "switch the drive off and on",
        )  # fmt: skip
    return fault(name, f"nothing answers at node {config.node_id}", NODE_WIRING)


def _same_type(e: Examination, node: int, config: AxisConfig) -> bool:
    """Return whether a node is a drive of the axis' manufacturer and product, as far as the rig file states them."""
    if (e.can.number(node, (o.DEVICE_TYPE, 0)) or 0) & 0xFFFF != o.DEVICE_PROFILE:
        return False
    identity = ((1, config.vendor_id), (2, config.product_code))
    return all(not expected or e.can.number(node, (o.IDENTITY, sub)) == expected for sub, expected in identity)


def _identity(e: Examination, name: str, config: AxisConfig, serials: Mapping[int, str]) -> Iterator[Finding]:
    node, can = config.node_id, e.can
    vendor, product, revision, serial = (can.number(node, (o.IDENTITY, sub)) or 0 for sub in (1, 2, 3, 4))
    who = " ".join(
        text for text in (can.text(node, (o.DEVICE_NAME, 0)), can.text(node, (o.HARDWARE_VERSION, 0)),
                          can.text(node, (o.SOFTWARE_VERSION, 0))) if text
    )  # fmt: skip
    seen = f"node {node}: {who or 'no name'}, vendor 0x{vendor:08X}, product 0x{product:08X}, revision 0x{revision:08X}"
    device_type = can.number(node, (o.DEVICE_TYPE, 0)) or 0
    if device_type & 0xFFFF != o.DEVICE_PROFILE:
        yield fault(name, f"{seen}: device type 0x{device_type:08X} is no CiA 402 drive", "look at axes' node numbers")
        return
    other = serials.get(serial)
    if other is not None and other != name:
        yield fault(
            name, f"node {node} has the serial number {serial}, which the rig file gives to {other}: swapped drives",
            f"exchange the node numbers of the drives of {name} and {other}, or their places in the rig file",
        )  # fmt: skip
        return
    wrong = [
        f"{describe(o.IDENTITY, sub)} is 0x{actual:08X}, the rig file has 0x{expected:08X}"
        for sub, actual, expected in ((1, vendor, config.vendor_id), (2, product, config.product_code),
                                     (4, serial, config.serial_number)) if expected and actual != expected
    ]  # fmt: skip
    if wrong:
        yield fault(
            name, f"{seen}: {'; '.join(wrong)}: another drive than the rig file's",
            "the right drive at this node number, or its own identity and profile in the rig file",
        )  # fmt: skip
    else:
        yield ok(name, f"{seen}, serial number {serial}")


def _drive_state(e: Examination, name: str, config: AxisConfig) -> Iterator[Finding]:
    can, node = e.can, config.node_id
    statusword = can.number(node, (o.STATUSWORD, 0))
    if statusword is not None:
        state = cia402.decode(statusword)
        code = can.number(node, (o.ERROR_CODE, 0)) or 0
        if state in (State.FAULT, State.FAULT_REACTION):
            yield fault(name, f"the drive is in fault: {o.emergency_text(code)}", "look this code up in its manual")
        elif state is State.OPERATION_ENABLED:
            yield fault(name, "the drive is enabled, and no run is under way", "end whatever enabled it")
        if config.drive.remote and not statusword & cia402.REMOTE:
            yield fault(
                name, f"in local mode: it does not obey the bus (statusword 0x{statusword:04X}, bit 9 = 0)",
                "its key switch, its panel, or the maker's set-up tool",
            )  # fmt: skip
    inputs = can.number(node, (o.DIGITAL_INPUTS, 0)) if config.digital_io else None
    if inputs is not None:
        io, shown = config.io, config.io.from_drive(inputs)
        word = f"0x60FD = 0x{inputs & 0xFFFFFFFF:08X}"
        for mask, what, closed, bit in (
            (INPUT_SAFETY_CHAIN, "safety chain", "healthy", io.safety_chain), (INPUT_GUARD, "guard", "closed", io.guard)
        ):  # fmt: skip
            if shown & mask:
                yield ok(name, f"{what} {closed} (bit {bit}, {word}): look whether it is")
                continue
            yield warning(
                name, f"{what} open (bit {bit} = 0, {word})",
                f"if the {what} is {closed} as you read this, the input's polarity or its wire is wrong: 1 is {closed}",
            )  # fmt: skip


def _objects(e: Examination, name: str, config: AxisConfig) -> Iterator[Finding]:
    """Check every object that the set-up needs, and compare ratings and process data with the rig file."""
    answers = e.can.objects.get(config.node_id, {})
    needed = {**written(config), **mapped(config)}
    missing = [describe(*key) for key in needed if key in answers and answers[key].missing
               and key not in config.drive.optional]  # fmt: skip
    if missing:
        yield warning(
            name, f"the drive does not have {len(missing)} of the objects that a set-up writes: {'; '.join(missing)}",
            "its profile has to name them as missing or optional; compare with the maker's EDS",
        )  # fmt: skip
    rated = answers[o.RATED_TORQUE, 0].number if (o.RATED_TORQUE, 0) in answers else None
    expected = config.rated_torque_counts
    actual_nm = (rated or 0) * config.drive.units.rated_torque_nm * config.gear
    if rated and abs(rated - expected) > max(RATED_TORQUE_SHARE * expected, 1.0):
        yield fault(
            name, f"0x6076 rated torque is {actual_nm:.4g} N m, the rig file has {config.rated_torque_nm:g} N m",
            f"every torque would be shown and limited by a factor of {rated / expected:.3g} wrong: correct"
            f" axes.{name}.rated_torque, or the drive's motor data",
        )  # fmt: skip
    other = [key for key, value in mapped(config).items() if key in answers and answers[key].number != value]
    if other:
        yield note(name, f"{len(other)} objects of process data differ from the rig file; every connect writes them")


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
            yield warning(names.get(node, f"node {node}"), f"emergency: {o.emergency_text(code)}", "the drive's manual")


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
