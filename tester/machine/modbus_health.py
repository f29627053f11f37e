"""The Modbus devices of a rig, and a slow check of each: refused requests, and the share of failed requests."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Final

from drivers.modbus import Device
from drivers.modbus.request import Counters


@dataclass(slots=True)
class FieldDevice:
    """A Modbus device of the rig file."""

    name: str
    """The device's key in the rig file."""
    title: str
    """The device's name for people."""
    line: str
    driver: Device


PERIOD_S: Final = 0.5
"""Time between two checks, s [A]. Every scan watches silence and age; these checks find lasting trouble."""
WINDOW: Final = 4
"""Number of checks over which the share of failed requests is computed: 2 s [A]."""
NAMED: Final = 0.1
"""From this share of failed requests on, a trip names the device [A]."""
LEAST_REQUESTS: Final = 8
"""A device with fewer requests than this in the window is not judged [A]."""


class _Record:
    """Requests and failures of a station at the last few checks, oldest first."""

    __slots__ = ("device", "looks", "title")

    def __init__(self, listed: FieldDevice) -> None:
        self.title = listed.title
        self.device = listed.driver
        self.looks: list[tuple[int, int]] = [(0, 0)]

    def look(self) -> float:
        """Read the counters; return the share of failed requests over the window."""
        counters = self.device.station.counters
        looks = self.looks
        looks.append((counters.requests, failures(counters)))
        if len(looks) > WINDOW + 1:
            looks.pop(0)
        requests = looks[-1][0] - looks[0][0]
        return (looks[-1][1] - looks[0][1]) / requests if requests >= LEAST_REQUESTS else 0.0


def failures(counters: Counters) -> int:
    """Return how many requests to a station have not received a good reply."""
    return counters.timeouts + counters.crc_errors + counters.garbage + counters.late


class Inspector:
    """Checks the Modbus devices of a rig; ``due_s``: time of the next check.

    ``fault``: the first device that refuses a request or does not receive our commands; "" = none. ``line_errors``: the
    largest share of failed requests of any device in the last few seconds, 0..1. ``noisy``: the device with that share,
    if it is at least one in ten; "" = none.
    """

    def __init__(self, devices: Sequence[FieldDevice]) -> None:
        """``devices``: the devices to check."""
        self.records = tuple(map(_Record, devices))
        self.due_s = -inf
        self.fault = ""
        self.line_errors = 0.0
        self.noisy = ""

    def inspect(self, now: float) -> None:
        """Check every device at ``now`` s."""
        self.due_s = now + PERIOD_S
        fault = complaint = ""
        worst, title = 0.0, ""
        for record in self.records:
            share = record.look()
            if share > worst:
                worst, title = share, record.title
            device = record.device
            if not fault and device.refused is not None:
                fault = f"{record.title}: {device.refused}"
            if not complaint and device.complaint:
                complaint = f"{record.title}: {device.complaint}"
        self.fault, self.line_errors = fault or complaint, worst
        self.noisy = f"{title}: {100.0 * worst:.0f} % of its requests failed" if worst >= NAMED else ""
