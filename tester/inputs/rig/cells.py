"""Checks a load cell in a rig file: its required channels, and its transmitters."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from drivers.profiles import ProfileError
from drivers.profiles.model import DeviceProfile
from tester.base.source import Location
from tester.inputs.rig.config import DeviceConfig, OwnDevice, Rig
from tester.inputs.rig.further_sensors import parts_of, title_of
from tester.inputs.rig.profiles import profile_of

if TYPE_CHECKING:
    from drivers.joined_cell import Transmitter
    from drivers.modbus import ModbusLink

_Found = Iterator[tuple[Location, str]]


def problems_of_cells(rig: Rig, profiles: Mapping[str, DeviceProfile]) -> _Found:
    """Yield the faults of the machine's own devices with required channels, and of parts of devices."""
    for name, part in rig.devices.items():
        if part.part_of:
            yield from _belongs(rig, name, part)
    for name, own in rig.own.items():
        if own.channels:
            yield from _measures(rig, name, own, profiles)


def _belongs(rig: Rig, name: str, part: DeviceConfig) -> _Found:
    whole = part.part_of
    joined = [key for key, own in rig.own.items() if own.joined]
    place = ("devices", name, "part_of")
    if whole not in joined:
        expected = f"expected {' or '.join(joined)}" if joined else "this kind of machine has no such device"
        yield place, f"{whole} is no device that may have several transmitters ({expected})"
    elif whole in rig.devices:
        yield place, f"devices has {whole} itself, too: a load cell is one device, or its transmitters are devices"


def _measures(rig: Rig, name: str, own: OwnDevice, profiles: Mapping[str, DeviceProfile]) -> _Found:
    """Yield the channels that no transmitter measures, and those that two do."""
    parts = parts_of(rig, name) if own.joined else {}
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


def transmitters_of(rig: Rig, links: Mapping[str, ModbusLink]) -> dict[str, Transmitter]:
    """Return the drivers of a load cell's transmitters by their keys; none where it is one device.

    Raises ProfileError, and ValueError for a profile of no transmitter.
    """
    from drivers.joined_cell import Transmitter

    return {
        key: Transmitter(
            title_of(rig, key), profile_of(part.profile), part.unit_id, links[part.line], part.channels, part.parameters
        )
        for key, part in parts_of(rig, "load_cell").items()
    }


def skew_problem(rig: Rig, channels: tuple[str, ...], most_skew_s: float) -> _Found:
    """Yield why the transmitters of a load cell cannot be read close enough together at their lines' usual times."""
    parts = parts_of(rig, "load_cell")
    if not parts or any(line.baud <= 0 for line in rig.lines.values()):
        return
    from drivers.joined_cell import JoinedCell  # only such a rig pays for the wire's library
    from drivers.modbus import ModbusLink

    links = {name: ModbusLink(line.framing, line.baud, line.parity) for name, line in rig.lines.items()}
    try:
        cell = JoinedCell(list(transmitters_of(rig, links).values()), channels, most_skew_s)
    except (ProfileError, ValueError, KeyError):
        return  # reported elsewhere
    if cell.usual_skew_s <= most_skew_s:
        return
    apart = f"are read {1e3 * cell.usual_skew_s:.0f} ms apart at the usual times of their lines"
    limit = f"interlocks.cell_skew is {1e3 * most_skew_s:g} ms"
    yield (
        ("devices", next(iter(parts))),
        (f"the load cell's transmitters {apart}, and {limit}: raise the baud, or give each a line of its own"),
    )
