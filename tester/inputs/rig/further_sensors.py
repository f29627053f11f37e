"""The Modbus devices of a rig file: those of its kind, and further sensors with their channels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from math import ceil, isfinite, log10
from typing import TYPE_CHECKING, Final

from drivers.canopen.node_config import NodeChannel
from drivers.profiles import ProfileError
from drivers.profiles.registers import Signal
from tester.base.config_reader import SUFFIXES
from tester.base.quantities import FURTHER, Channel, Figure, Quantities, Screen
from tester.base.source import Location
from tester.inputs.rig.config import DeviceConfig, Rig, ShareConfig
from tester.inputs.rig.profiles import profile_of

if TYPE_CHECKING:
    from drivers.joined_cell import Transmitter
    from drivers.modbus import ModbusLink

DECIMALS: Final = 3
"""Most decimals of a further channel on screens."""
COUNTS: Final = {
    "bit": (0.0, 1.0), "u8": (0.0, 255.0), "i8": (-128.0, 127.0), "u16": (0.0, 65535.0), "i16": (-32768.0, 32767.0),
    "u32": (0.0, 2.0**32), "i32": (-(2.0**31), 2.0**31), "f32": (-100.0, 100.0),
}  # fmt: skip
"""Ends of the bar, in counts, where a profile states no range: those of the type, for a float arbitrary [A]."""


@dataclass(frozen=True, slots=True)
class FurtherChannel:
    """A quantity measured by a further sensor, under its recorded name."""

    name: str
    unit: str
    device: str
    """Place of the sensor in the rig file: ``devices.torque``, ``can.nodes.climate``."""
    low: float
    """Ends of its range, in its unit."""
    high: float
    decimals: int

    def channel(self, place: int, after: Quantities) -> Channel:
        """Return its line in the run's table, after those of the kind; ``place``: in ``Readings.channels``, from 0."""
        bar = Screen(
            self.name, _last(row.screen.rank for row in after.shown if row.screen is not None) + place + 1,
            self.device, Figure(offset=self.low), Figure(offset=self.high),
        )  # fmt: skip
        words = self.name.removesuffix(SUFFIXES.get(self.unit, "")).replace("_", " ")
        return Channel(
            self.name, "°C" if self.unit == "degC" else self.unit, words[:1].upper() + words[1:], f"{FURTHER}.{place}",
            _last(quantity.mean for quantity in after.averaged) + place + 1, self.decimals, screen=bar,
        )  # fmt: skip


def _last(numbers: Iterable[int]) -> int:
    return max(numbers, default=0)


def title_of(rig: Rig, device: str) -> str:
    """Return a device's name for people, by its key in the rig file."""
    return rig.own[device].title if device in rig.own else device.replace("_", " ")


def further_sensors(rig: Rig) -> dict[str, DeviceConfig]:
    """Return the sensors besides the machine's own and their parts, in the order of the rig file."""
    return {name: device for name, device in rig.devices.items() if name not in rig.own and not device.part_of}


def parts_of(rig: Rig, own: str) -> dict[str, DeviceConfig]:
    """Return the transmitters of a joined device, in the order of the rig file; none = a single device."""
    return {name: device for name, device in rig.devices.items() if device.part_of == own}


def shares_of(rig: Rig) -> dict[str, ShareConfig]:
    """Return what fails together: the file's ``shares``, and each line that several devices are on."""
    found = dict(rig.shares)
    for line in rig.lines:
        members = tuple(name for name, device in rig.devices.items() if device.line == line)
        if len(members) > 1:
            found.setdefault(f"{line}_line", ShareConfig("line", members))
    return found


def further_channels(rig: Rig) -> tuple[FurtherChannel, ...]:
    """Return the channels of further sensors and further CANopen nodes, in the order of ``Readings.channels``.

    Raises ProfileError.
    """
    channels: list[FurtherChannel] = []
    for key, device in further_sensors(rig).items():
        profile = profile_of(device.profile)
        channels += [
            _channel(device.channels.get(name, name), f"devices.{key}", profile.signal(name))
            for name in profile.channels
        ]
    for key, node in rig.can.nodes.items():
        channels += [_channel(name, f"can.nodes.{key}", channel) for name, channel in node.channels.items()]
    return tuple(channels)


def _channel(name: str, device: str, number: Signal | NodeChannel) -> FurtherChannel:
    offset = number.offset if isinstance(number, Signal) else 0.0
    ends = [end * number.scale + offset for end in COUNTS[number.type]]
    low, high = min(ends), max(ends)
    if isinstance(number, Signal):
        low = number.least if isfinite(number.least) else low
        high = number.greatest if isfinite(number.greatest) else high
    steps = DECIMALS if number.type == "f32" else ceil(-log10(abs(number.scale)) - 1e-9)
    return FurtherChannel(name, number.unit, device, low, high, min(max(steps, 0), DECIMALS))


def quantities_on(rig: Rig) -> Quantities:
    """Return the channels of a run on a rig: its kind's, and those of its further sensors. Raises ProfileError."""
    of_kind = rig.quantities.fitted_with(rig.devices)
    return of_kind.with_further(
        [further_channel.channel(place, of_kind) for place, further_channel in enumerate(further_channels(rig))]
    )


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


def skew_problem(rig: Rig, channels: tuple[str, ...], most_skew_s: float) -> Iterator[tuple[Location, str]]:
    """Yield why the transmitters of a load cell cannot be read close enough together at their lines' usual times."""
    parts = parts_of(rig, "load_cell")
    if not parts or any(line.baud <= 0 for line in rig.lines.values()):
        return
    from drivers.joined_cell import JoinedCell  # only such a rig pays for the wire's library
    from drivers.modbus import ModbusLink

    links = {
        name: ModbusLink(line.framing, line.baud, line.parity, line.stop_bits) for name, line in rig.lines.items()
    }
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
