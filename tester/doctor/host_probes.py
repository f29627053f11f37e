"""Probes of the computer (adapters, permissions, clock, disk, punctuality) and of the rig file itself."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, cast

from tester.doctor.examination import Examination
from tester.doctor.finding import Finding, fault, note, ok, warning
from tester.inputs.rig import LineConfig
from tester.inputs.rig.rig_files import risks_of
from tester.store.disk import CONTACT_ROWS_S, FIXED_BYTES, MARGIN, ROW_BYTES

DAY_S = 8 * 3600.0
"""Contact time of a working day, whose data must fit on the disk, s [A]."""
LATENCY_MS = 2
"""A latency timer of this length or more costs readings, ms: the least that FTDI's driver accepts is 1."""
OFTEN = 0.999
"""Share of the scans that the second figure for punctuality covers."""


def serial_ports(e: Examination) -> Iterator[Finding]:
    """Compare the lines' serial ports with those of the computer, and check the permissions."""
    ports = _serial_lines(e)
    if not ports:
        return
    present = {e.computer.real(port.device): port for port in e.computer.serial_ports()}
    used: set[str] = set()
    for name, line in ports.items():
        subject, real = f"line {name}", e.computer.real(line.port)
        used.add(real)
        if real not in present and not e.computer.exists(line.port):
            there = ", ".join(port.device for port in present.values()) or "none"
            yield fault(
                subject, f"there is no serial port {line.port} (there are: {there})",
                f"plug the adapter in, or set lines.{name}.port to one of these",
            )  # fmt: skip
        elif not e.computer.may_use(line.port):
            group = e.computer.group_of(line.port)
            yield fault(
                subject, f"this user may not use {line.port}",
                f"add yourself to its group {group} (sudo usermod -a -G {group} $USER) and log in again"
                if group else "ask the owner of the port",
            )  # fmt: skip
        else:
            port = present.get(real)
            yield ok(subject, f"serial port {line.port}" + (f" ({port.description})" if port is not None else ""))
            if line.port.startswith(("/dev/ttyUSB", "/dev/ttyACM")):
                yield note(
                    subject, f"{line.port} is numbered in the order in which adapters are plugged in",
                    f"name it by its serial number: lines.{name}.port: /dev/serial/by-id/...",
                )  # fmt: skip
    spare = [port for real, port in present.items() if real not in used]
    if spare:
        named = ", ".join(f"{port.device} ({port.description})" for port in spare)
        yield note("computer", f"serial ports that the rig file does not use: {named}")


def _serial_lines(e: Examination) -> dict[str, LineConfig]:
    """Return the lines on serial ports of this computer; none for a rig simulated in this process."""
    if e.in_memory:
        return {}
    return {name: line for name, line in e.rig.lines.items() if line.framing == "rtu"}


def latency_timers(e: Examination) -> Iterator[Finding]:
    """Read the latency timers of USB serial adapters."""
    for name, line in _serial_lines(e).items():
        milliseconds = e.computer.latency_ms(line.port)
        if milliseconds is None:
            continue
        if milliseconds < LATENCY_MS:
            yield ok(f"line {name}", f"latency timer {milliseconds} ms")
            continue
        yield warning(
            f"line {name}",
            f"latency timer {milliseconds} ms: every answer may come that much later",
            _latency_remedy(e, line.port),
        )


def _latency_remedy(e: Examination, port: str) -> str:
    if e.computer.platform == "win32":
        return "set it to 1 ms: Device Manager, the port, Port Settings, Advanced, Latency Timer"
    device = e.computer.real(port).rpartition("/")[2]
    return (
        f"echo 1 | sudo tee /sys/bus/usb-serial/devices/{device}/latency_timer, and for good a udev rule:"
        ' ACTION=="add", SUBSYSTEM=="usb-serial", DRIVER=="ftdi_sio", ATTR{latency_timer}="1"'
    )


def can_adapter(e: Examination) -> Iterator[Finding]:
    """Check the SocketCAN interface: present, up, with the rig file's bit rate; also its queue and its errors."""
    can = e.rig.can
    if can.interface != "socketcan":
        if not e.in_memory:
            yield note("CAN adapter", f"{can.interface} {can.channel}: the adapter's settings cannot be read")
        return
    folder = f"/sys/class/net/{can.channel}"
    if not e.computer.exists(folder):
        there = [name for name in e.computer.names("/sys/class/net") if name.startswith(("can", "vcan", "slcan"))]
        yield fault(
            "CAN adapter", f"there is no interface {can.channel} (there are: {', '.join(there) or 'none'})",
            "plug the adapter in, load its driver, or set can.channel",
        )  # fmt: skip
        return
    details = _details(e, can.channel)
    state = e.computer.text(f"{folder}/operstate")
    up = f"sudo ip link set {can.channel} up type can bitrate {can.bitrate} restart-ms 0"
    if state == "down":
        yield fault("CAN adapter", f"{can.channel} is down", up)
    bitrate = details.get("bittiming", {}).get("bitrate")
    if bitrate is not None and bitrate != can.bitrate:
        yield fault(
            "CAN adapter", f"{can.channel} runs at a bit rate of {bitrate} bit/s, the rig file has {can.bitrate}",
            f"sudo ip link set {can.channel} down; {up}",
        )  # fmt: skip
    elif bitrate is not None:
        yield ok("CAN adapter", f"{can.channel} at {bitrate} bit/s, {str(details.get('state', 'up')).lower()}")
    elif state != "down":
        yield note("CAN adapter", f"{can.channel} reports no bit rate (a virtual bus has none)")
    if details.get("state") in ("BUS-OFF", "ERROR-PASSIVE"):
        yield fault(
            "CAN adapter", f"{can.channel} is {details['state'].lower()}",
            "bit rate, wiring and the 120 ohm terminators at both ends; then set it down and up again",
        )  # fmt: skip
    yield from _queue(e, folder)


def _details(e: Examination, channel: str) -> dict[str, Any]:
    """Return the output of ``ip`` about a CAN interface; empty on failure."""
    text = e.computer.output("ip", "-json", "-details", "link", "show", channel)
    try:
        return cast("dict[str, Any]", json.loads(text or "[]")[0]["linkinfo"]["info_data"])
    except (ValueError, LookupError, TypeError):
        return {}


def _queue(e: Examination, folder: str) -> Iterator[Finding]:
    text = e.computer.text(f"{folder}/tx_queue_len") or ""
    needed = 2 * (len(e.rig.drives()) + 3)  # a command each, outputs, SYNC, heartbeat; twice, for a late scan
    if not text.isdecimal():
        return
    if int(text) < needed:
        yield warning(
            "CAN adapter", f"txqueuelen {text}: two scans send {needed} frames, and one that finds no room ends a run",
            f"sudo ip link set {e.rig.can.channel} txqueuelen 100",
        )  # fmt: skip
    else:
        yield ok("CAN adapter", f"txqueuelen {text}")


def disk(e: Examination) -> Iterator[Finding]:
    """Compare the free space with the need of a working day, and check that runs can be written."""
    folder = str(e.runs)
    if not e.computer.may_use(folder):
        yield fault("run folder", f"nothing can be written to {folder}", "choose another (--out), or ask its owner")
    free = e.computer.free_bytes(folder)
    if free is None:
        yield warning("run folder", f"the free space on the disk of {folder} is unknown", "look at the disk")
        return
    least, day = MARGIN * FIXED_BYTES, MARGIN * (FIXED_BYTES + ROW_BYTES * CONTACT_ROWS_S * DAY_S)
    room = f"{free / 1e6:.0f} MB free for {folder}"
    if free < least:
        yield fault("run folder", f"the disk is full: {room}", "make room, or choose a folder on another disk (--out)")
    elif free < day:
        yield warning("run folder", f"{room}: less than a day of contact takes ({day / 1e6:.0f} MB)", "make room")
    else:
        yield ok("run folder", room)


def clock(e: Examination) -> Iterator[Finding]:
    """Check that a time server sets the computer's clock. Records contain its time; control does not use it."""
    text = e.computer.output("timedatectl", "show", "--property=NTPSynchronized", "--value")
    if text is None:
        yield note("clock", "it is unknown whether a time server sets it; only recorded times depend on it")
    elif text.strip() == "yes":
        yield ok("clock", "set by a time server")
    else:
        yield note(
            "clock", "no time server sets it: times on record are its own; control uses another, which never jumps",
            "sudo timedatectl set-ntp true",
        )  # fmt: skip


def punctuality(e: Examination) -> Iterator[Finding]:
    """Report how late the computer's scans were during the watch, and which limits would be possible."""
    late = sorted(e.watch.late_s)
    if not late:
        why = "nothing answers" if e.wires.real else "rig time is simulated"
        yield note("scan", f"{why}: how punctual this computer is was not measured")
        return
    most, often = late[-1], late[min(int(OFTEN * len(late)), len(late) - 1)]
    period_s = 1.0 / e.rig.scan.sliding_hz
    text = (
        f"{len(late)} scans of {1e3 * period_s:g} ms: at most {1e3 * most:.1f} ms late,"
        f" 99.9 % within {1e3 * often:.1f} ms"
    )
    scans = e.limit("stale_can_scans")
    allowed_s = scans * period_s if scans is not None else None
    trip_s = e.limit("late_scan_s")
    remedy = "end other programs; real-time priority (ulimit -r 10); no power saving; a computer of its own"
    supports = f"it supports stale limits from {1e3 * (most + period_s):.0f} ms"
    if trip_s is not None and most > trip_s:
        yield fault("scan", f"{text}: interlocks.late_scan trips at {1e3 * trip_s:g} ms", remedy)
    elif allowed_s is not None and most + period_s > allowed_s:
        yield warning("scan", f"{text}; {supports}, drive data may be {1e3 * allowed_s:g} ms old", remedy)
    else:
        yield ok("scan", f"{text}; {supports}")


def rig_file(e: Examination) -> Iterator[Finding]:
    """Report what the rig file does not define, and which limits it loosens."""
    if e.packaged_keys:
        yield note(
            "rig file", f"packaged values count for {', '.join(e.packaged_keys)}", "`tester rig upgrade` writes them in"
        )
    for risk in risks_of(e.rig):
        yield warning(
            "rig file", f"{risk.key}: {risk.compared}", "tighten it, or run with --accept-risk and the reason"
        )
    for name, end in e.rig.certificates().ends().items():
        if end is None and not e.rig.simulated:
            yield note("rig file", f"no end of the certificate of {name} is stated", "state it in calibration")
