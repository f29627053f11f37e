"""Checks, from measurements at connect, that the Modbus lines are fast enough for the rig file's limits of age."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Final

from drivers.joined_cell import Transmitter
from drivers.modbus import ModbusLink
from drivers.modbus.request import REPLIES
from drivers.sensor import Sensor
from tester.machine.devices import DeviceList
from tester.machine.modbus_health import FieldDevice

SELDOM_S: Final = 0.2
"""For a device read less often than this, two replies are enough to begin with [A]: its limits are far above a reply
time.
"""
SELDOM_REPLIES: Final = 2
FINE_S: Final = 0.002
"""Period for reading a real line while its reply times are measured, s: it is the resolution of these times."""
READINGS: Final = 2.0
"""A device's limit of age must cover this many readings with their waits [A], because one may be late or lost."""


def needed_s(period_s: float, exchange_s: float, others_s: float) -> float:
    """Return the smallest limit of age that a device's readings can keep, s.

    ``period_s``: between two readings; ``exchange_s``: of one of them; ``others_s``: of the line's other devices.
    """
    return READINGS * (period_s + exchange_s) + others_s


def measured(devices: DeviceList) -> bool:
    """Return whether enough replies of every device were measured."""
    return all(
        device.driver.station.reply.count >= (REPLIES if device.driver.profile.blocks[0].period_s < SELDOM_S else
                                           SELDOM_REPLIES)
        for device in devices.modbus
    )


def too_slow(devices: DeviceList, limits: Mapping[str, tuple[str, float]]) -> str:
    """Return which line is too slow for a device on it, and the remedy; "" if none is.

    ``limits``: for each device's name, the key in the rig file and the greatest age of its reading, s.
    """
    apart = _too_far_apart(devices)
    if apart:
        return apart
    for device in devices.modbus:
        key, limit_s = age_limit(device, limits)
        if limit_s is None:
            continue
        link, station = device.driver.link, device.driver.station
        exchange_s = link.exchange_s(station)
        others_s = sum(link.exchange_s(other) for other in link.stations if other is not station)
        age_s = needed_s(device.driver.profile.blocks[0].period_s, exchange_s, others_s)
        if not age_s <= limit_s:
            return (
                f"{device.title}: line {device.line} is too slow for {key}, {_ms(limit_s)}:"
                f" a reply takes {_ms(exchange_s)},"
                f" {_ms(station.reply.greatest_s)} of them beyond the wire, and two readings {_ms(age_s)}."
                f" To do: {_remedy(devices, link)}"
            )
    return ""


def _too_far_apart(devices: DeviceList) -> str:
    """Return why the transmitters of a load cell are read too far apart, and the remedy; "" if they are not."""
    parts = [device for device in devices.modbus if isinstance(device.driver, Transmitter)]
    cell = next((one.driver.cell for one in parts if isinstance(one.driver, Transmitter)), None)
    if cell is None or cell.measured_skew_s <= cell.most_skew_s:
        return ""
    slowest = max(parts, key=lambda one: one.driver.link.exchange_s(one.driver.station))
    link, station = slowest.driver.link, slowest.driver.station
    return (
        f"load cell: line {slowest.line} is too slow for interlocks.cell_skew, {_ms(cell.most_skew_s)}: its"
        f" transmitters are read {_ms(cell.measured_skew_s)} apart, and a reply of {slowest.title} takes"
        f" {_ms(link.exchange_s(station))}, {_ms(station.reply.greatest_s)} of them beyond the wire (its own time, the"
        f" adapter's latency timer). To do: {_remedy(devices, link)}; or a line for each transmitter"
    )


def _remedy(devices: DeviceList, link: ModbusLink) -> str:
    port = next(port for port, other in devices.lines if other is link)
    return getattr(port, "remedy", "") or "a quicker adapter"


def allow_late(devices: DeviceList, limits: Mapping[str, tuple[str, float]]) -> None:
    """Lengthen time-outs when replies become slower during the run, as far as the limits of age allow."""
    for device in devices.modbus:
        _, limit_s = age_limit(device, limits)
        if limit_s is not None:
            device.driver.station.longest_s = limit_s / READINGS - device.driver.profile.blocks[0].period_s


def described(devices: DeviceList) -> str:
    """Return a line for the journal: replies, time-outs, echoes of adapters, low-latency flags."""
    parts: list[str] = []
    for device in devices.modbus:
        reply = device.driver.station.reply
        parts.append(f"{device.title} {1e3 * reply.least_s:.1f} to {_ms(reply.greatest_s)}")
    text = "replies beyond the wire: " + ", ".join(parts)
    for port, link in devices.lines:
        if link.ear.hears_itself and link.stations:
            text += "; an adapter hears itself, its echo is taken off"
        flag = getattr(port, "low_latency", None)
        if flag is not None:
            text += "; low-latency flag " + ("set" if flag else "not offered by the driver")
    return text


def age_limit(device: FieldDevice, limits: Mapping[str, tuple[str, float]]) -> tuple[str, float | None]:
    """Return the key and the greatest age, s, of a device's reading: of ``limits``, else of its own driver."""
    if device.name in limits:
        return limits[device.name]
    return ("its age", device.driver.stale_s) if isinstance(device.driver, Sensor) else ("", None)


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.1f} ms"
