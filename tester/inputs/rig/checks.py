"""Checks across the sections that every rig has; the types check each section alone."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping
from dataclasses import replace

from drivers.drive_settings import plan
from drivers.profiles import ProfileError
from drivers.profiles.model import DeviceProfile
from tester.base.source import Location, Problem, Tree
from tester.inputs.rig.config import DeviceConfig, OwnDevice, Rig
from tester.inputs.rig.further_sensors import further_channels, further_sensors, parts_of
from tester.inputs.rig.profiles import profile_of

MAX_BUS_LOAD = 0.5
"""Above this share of the bus the scan rate is refused: bursts of SDO and EMCY need the rest (fieldbus, wire sums)."""
COMMANDED = frozenset({"jacket", "chamber"})
"""Kinds of profiles whose devices take commands: these cannot be further sensors."""
EMISSIVITIES = (0.1, 1.0)
"""Least and greatest plausible emissivity of a surface [A]."""
SYNC_BITS, RPDO_BITS, TPDO_BITS = 55, 115, 135
"""Bits of a frame of 0, 6 and 8 bytes with worst-case stuffing and the space between frames."""
_SHARE = "[a-z][a-z0-9_]*"
"""Names of shares: a fault script has them with spaces in place of the underscores."""

_Found = Iterator[tuple[Location, str]]


def problems_of(rig: Rig, tree: Tree) -> list[Problem]:
    """Return the contradictions, including the kind's own, with positions."""
    profiles, unread = _read(rig)
    sensors = further_sensors(rig)
    parts = {name: parts_of(rig, name) for name, own in rig.own.items() if own.joined}
    faults = [*unread, *_packaged(rig), *_nodes(rig), *_bus_load(rig), *_lines(rig), *_simulation(rig), *_shares(rig)]
    faults += [*_profiles(rig, profiles), *_channels(rig, sensors, profiles), *_own(rig, parts, profiles)]
    faults += [*_drives(rig), *rig.problems()]
    faults += _safety_inputs(rig) if not unread else ()
    return [tree.problem(location, message) for location, message in faults]


def _packaged(rig: Rig) -> _Found:
    if rig.like and rig.like not in rig.packaged:
        yield ("like",), f"{rig.like} is no packaged rig of the kind {rig.kind} (expected {', '.join(rig.packaged)})"


def _safety_inputs(rig: Rig) -> _Found:
    """Yield safety inputs that nothing measures, and names that cannot be an interlock's."""
    measured = {channel.name: channel for channel in further_channels(rig)}
    for name, one in rig.safety_inputs.items():
        channel = measured.get(one.channel)
        if channel is None:
            bits = ", ".join(known for known, other in measured.items() if (other.low, other.high) == (0.0, 1.0))
            expected = f"expected a channel of type bit: {bits or 'no device or node has one'}"
            yield ("safety_inputs", name, "channel"), f"no such channel ({expected})"
        elif (channel.low, channel.high) != (0.0, 1.0):
            yield ("safety_inputs", name, "channel"), f"{one.channel} is no contact (expected type bit)"
        if not re.fullmatch("[a-z][a-z0-9_]*", name):
            yield ("safety_inputs", name), "expected small letters, digits and _"


def _nodes(rig: Rig) -> _Found:
    taken = {rig.can.node: "the PC"}
    nodes = [(("axes", name), name, axis.node_id) for name, axis in rig.drives().items()]
    nodes += [(("can", "nodes", name), name, node.node_id) for name, node in rig.can.nodes.items()]
    for place, name, node_id in nodes:
        if node_id in taken:
            yield (*place, "node_id"), f"node {node_id} is {taken[node_id]} already"
        taken.setdefault(node_id, name)
    for name, node in rig.can.nodes.items():
        if not 1 <= node.node_id <= 126:
            yield ("can", "nodes", name, "node_id"), f"node {node.node_id} (expected 1 to 126)"
    if not 1 <= rig.can.node <= 127:
        yield ("can", "node"), f"node {rig.can.node} is not a CANopen node (expected 1 to 127)"


def _drives(rig: Rig) -> _Found:
    """Yield faults that the profile of a drive reveals without a connection."""
    for name, axis in rig.drives().items():
        if axis.name != name:
            yield ("axes", name, "name"), f'"{axis.name}" (an axis is called as its section: expected {name})'
        for refused in plan(axis).refused:
            yield ("axes", name, "profile"), refused


def bus_load(rig: Rig, scan_hz: float) -> float:
    """Return the share of the CAN bus that cyclic traffic takes at a scan rate, with worst-case stuffing."""
    cycle = SYNC_BITS + len(rig.drives()) * (RPDO_BITS + TPDO_BITS)
    nodes = sum(TPDO_BITS / node.period_s for node in rig.can.nodes.values())
    return (cycle * scan_hz + nodes) / rig.can.bitrate


def _bus_load(rig: Rig) -> _Found:
    load = bus_load(rig, rig.scan.sliding_hz)
    if load > MAX_BUS_LOAD:
        rate = f"{rig.scan.sliding_hz:g} Hz"
        message = f"{rate} loads the CAN bus with {100 * load:.0f} %, more than {100 * MAX_BUS_LOAD:.0f} %"
        yield ("scan", "sliding"), f"{message}: raise can.bitrate or lower the rate"


def _lines(rig: Rig) -> _Found:
    used: dict[tuple[str, int], str] = {}
    for name, device in rig.devices.items():
        line, unit_id = device.line, device.unit_id
        if line not in rig.lines:
            near = difflib.get_close_matches(line, rig.lines, n=1)
            meant = f", did you mean {near[0]}?" if near else ""
            yield ("devices", name, "line"), f"no such line{meant} (lines has {', '.join(rig.lines)})"
        if not 1 <= unit_id <= 247:
            yield ("devices", name, "unit_id"), f"{unit_id} is not a Modbus address (expected 1 to 247)"
        if (line, unit_id) in used:
            yield ("devices", name, "unit_id"), f"{unit_id} on line {line} is {used[line, unit_id]} already"
        used.setdefault((line, unit_id), name)
    ports: dict[str, str] = {}
    for name, line in rig.lines.items():
        if line.baud <= 0:
            yield ("lines", name, "baud"), "expected a baud rate above 0"
        if line.port in ports and line.port != "sim":
            yield ("lines", name, "port"), f"{line.port} is the port of line {ports[line.port]} already"
        ports.setdefault(line.port, name)


def _shares(rig: Rig) -> _Found:
    """Yield members of shares that the rig does not have, and shares of less than two."""
    known = dict.fromkeys((*rig.devices, *(device.part_of for device in rig.devices.values()), *rig.drives()))
    known.pop("", None)
    for name, share in rig.shares.items():
        place = ("shares", name, "members")
        if not re.fullmatch(_SHARE, name):
            yield ("shares", name), "a name has small letters, digits and underscores, and begins with a letter"
        if len(set(share.members)) < 2:
            yield place, "expected two different members at least: one alone shares nothing"
        for member in share.members:
            if member not in known:
                near = difflib.get_close_matches(member, known, n=1)
                meant = f", did you mean {near[0]}?" if near else ""
                yield place, f"{member} is no device and no axis with a drive{meant} (expected {', '.join(known)})"


def _read(rig: Rig) -> tuple[dict[str, DeviceProfile], list[tuple[Location, str]]]:
    """Return the profile of each device, and a fault for each that has none."""
    profiles: dict[str, DeviceProfile] = {}
    unread: list[tuple[Location, str]] = []
    for name, device in rig.devices.items():
        try:
            profiles[name] = profile_of(device.profile)
        except ProfileError as error:
            unread.append((("devices", name, "profile"), str(error)))
    return profiles, unread


def _profiles(rig: Rig, profiles: Mapping[str, DeviceProfile]) -> _Found:
    for name, profile in profiles.items():
        device = rig.devices[name]
        whole = device.part_of or name
        expected = rig.own[whole].profile if whole in rig.own else "sensor"
        if profile.kind != expected and (whole in rig.own or profile.kind in COMMANDED):
            message = f"{device.profile} is a profile of kind {profile.kind} (expected {expected})"
            yield ("devices", name, "profile"), message
        if name in rig.own and (device.channels or device.simulated):
            yield ("devices", name), "channels and simulated are for further sensors"
        if device.part_of and device.simulated:
            yield ("devices", name, "simulated"), "a part of the load cell shows the plant's forces: leave it out"
        yield from _parameters(name, device, profile, own=name in rig.own)


def _parameters(name: str, device: DeviceConfig, profile: DeviceProfile, *, own: bool) -> _Found:
    """Check the parameters in a device's section; a jacket or chamber may have none there."""
    registers = profile.writes if profile.kind not in COMMANDED else {}
    optical = profile.kind == "ir_thermometer"
    for key, value in device.parameters.items():
        place = ("devices", name, key)
        register = registers.get(key)
        if optical and key == "emissivity" and not EMISSIVITIES[0] <= value <= EMISSIVITIES[1]:
            yield place, f"{value:g} is no emissivity (expected {EMISSIVITIES[0]:g} to {EMISSIVITIES[1]:g})"
        elif register is not None and not register.least <= value <= register.greatest:
            yield place, f"{value:g} is beyond {profile.title} (expected {register.least:g} to {register.greatest:g})"
        elif register is None and not (optical and key == "emissivity"):
            keys = ("profile", "line", "unit_id", "part_of", "heat_off", "channels", "simulated", *registers)
            near = difflib.get_close_matches(key, keys, n=1)
            meant = f", did you mean {near[0]}?" if near else ""
            yield place, f'unknown key "{key}"{meant}'
    stated = {*device.parameters, *(key for key, register in registers.items() if register.default is not None)}
    for key in {**registers, **({"emissivity": None} if optical else {})}:
        if key not in stated or (key == "emissivity" and own and key not in device.parameters):
            yield ("devices", name), f"{key} is missing"


def _channels(rig: Rig, sensors: Mapping[str, DeviceConfig], profiles: Mapping[str, DeviceProfile]) -> _Found:
    """Check that every further channel has a unique name that can become a column, and that interlocks find theirs."""
    taken: dict[str, str] = {}
    places: list[tuple[tuple[str, ...], str]] = []
    for name, device in sensors.items():
        if name in profiles:
            yield from _known(name, device, profiles[name])
            channels = dict.fromkeys(device.channels.get(key, key) for key in profiles[name].channels)
            places += [(("devices", name), channel) for channel in channels]
    places += [(("can", "nodes", name), channel) for name, node in rig.can.nodes.items() for channel in node.channels]
    for place, channel in places:
        remedy = ": rename it by `channels`" if place[0] == "devices" else ""  # a node's channels have their names here
        if _is_own(rig, channel):
            yield place, f"channel {channel} is one of the machine's own{remedy}"
        if channel in taken:
            yield place, f"channel {channel} is one of {taken[channel]} already{remedy}"
        if not re.fullmatch("[a-z][a-z0-9_]*", channel):
            yield place, f"channel {channel}: expected small letters, digits and _"
        taken.setdefault(channel, place[-1])
    if sensors.keys() <= profiles.keys():  # else any of them may measure it
        yield from _watched(rig, list(taken))


def _known(name: str, device: DeviceConfig, profile: DeviceProfile) -> _Found:
    """Yield the keys of a sensor that name no channel of its profile."""
    for place, keys in (("channels", device.channels), ("simulated", device.simulated)):
        for key in keys:
            if key not in profile.channels:
                expected = f"no such channel (the profile has {', '.join(profile.channels)})"
                yield ("devices", name, place, key), expected


def _watched(rig: Rig, measured: list[str]) -> _Found:
    """Yield the channels of interlocks that no further sensor measures."""
    for name in rig.watched:
        if name not in measured:
            known = f"there are {', '.join(measured)}" if measured else "there is none"
            message = f"an interlock looks at the channel {name}, which no further sensor measures"
            yield ("devices",), f"{message} (expected a device or a node with it; {known})"


def _is_own(rig: Rig, channel: str) -> bool:
    """Return whether a channel of the kind has this name, in the record or on screens."""
    return any(
        channel in (quantity.name, quantity.screen.key if quantity.screen is not None else "")
        for quantity in rig.quantities
    )


def _own(
    rig: Rig, parts: Mapping[str, Mapping[str, DeviceConfig]], profiles: Mapping[str, DeviceProfile]
) -> _Found:
    """Yield the faults of the machine's own devices; ``parts``: the transmitters of each that may have several."""
    for name, part in rig.devices.items():
        place = ("devices", name, "part_of")
        if part.part_of and part.part_of not in parts:
            expected = f"expected {' or '.join(parts)}" if parts else "this kind of machine has no such device"
            yield place, f"{part.part_of} is no device that may have several transmitters ({expected})"
        elif part.part_of in rig.devices:
            whole = part.part_of
            yield place, f"devices has {whole} itself, too: a load cell is one device, or its transmitters are devices"
    for name, own in rig.own.items():
        transmitters = parts.get(name, {})
        if name not in rig.devices and not own.optional and not transmitters:
            yield ("devices",), f"{name} is missing"
        if own.channels:
            yield from _measures(rig, name, own, transmitters, profiles)


def _measures(
    rig: Rig, name: str, own: OwnDevice, parts: Mapping[str, DeviceConfig], profiles: Mapping[str, DeviceProfile]
) -> _Found:
    """Yield the channels that no transmitter measures, and those that two do."""
    single = rig.devices.get(name)
    asked = {name: single} if single is not None else parts
    if not asked.keys() <= profiles.keys():
        return  # reported elsewhere
    by_channel: dict[str, str] = {}
    for key, device in asked.items():
        profile = profiles[key]
        for channel in profile.channels:
            channel_name = device.channels.get(channel, channel)
            if channel_name in by_channel:
                yield (
                    ("devices", key),
                    f"measures {channel_name}, as {by_channel[channel_name]} does: rename it by `channels`",
                )
            by_channel.setdefault(channel_name, key)
        for channel in device.channels:
            if channel not in profile.channels:
                place = ("devices", key, "channels", channel)
                yield place, f"no such channel (the profile has {', '.join(profile.channels)})"
    missing = [channel for channel in own.channels if channel not in by_channel]
    if missing and asked:
        needed = f"a {own.title} of this machine measures {', '.join(own.channels)}"
        more = f"; further transmitters: `part_of: {name}`" if own.joined else ""
        has = ", ".join(f"{key} has {channel}" for channel, key in by_channel.items())
        for channel in missing:
            yield ("devices", next(iter(asked))), f"nothing measures {channel} ({needed}; {has}{more})"


def _simulation(rig: Rig) -> _Found:
    """Check that a simulated rig has no real wire and a real one no simulated wire: a mixture is a mistake."""
    wires = [(("can", "interface"), rig.can.interface)]
    wires += [(("lines", name, "port"), line.port) for name, line in rig.lines.items()]
    for location, wire in wires:
        if (wire == "sim") != rig.simulated:
            message = 'a simulated rig has "sim" here' if rig.simulated else '"sim" is for a simulated rig'
            yield location, f"{message}, and simulated is {'true' if rig.simulated else 'false'}"


def other_settings(rig: Rig) -> list[str]:
    """Return the lines whose settings differ from the profiles of their devices, each with the remedy.

    Nothing is refused: most devices accept other values than their profile's, which are the maker's or our advice. A
    line over TCP has the settings of its gateway.
    """
    differing: list[str] = []
    for key, line in rig.lines.items():
        if line.framing == "socket":
            continue
        on_line = [(name, device) for name, device in rig.devices.items() if device.line == key]
        for name, device in on_line:
            try:
                due = profile_of(device.profile).line
            except ProfileError:
                continue  # reported elsewhere
            meant = replace(line, baud=due.baud, parity=due.parity, stop_bits=due.stop_bits)
            if meant != line:
                differing.append(
                    f"lines.{key} has {line.settings}; {name} by its profile {device.profile} {meant.settings}: set one"
                    " as the other (`tester doctor` finds what answers)"
                )
    return differing
