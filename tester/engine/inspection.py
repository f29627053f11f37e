"""A slower look at the Modbus devices: what they refuse, and how many of their answers fail."""

from __future__ import annotations

from math import inf
from typing import Final

from drivers.ir_thermometer import IrThermometer
from drivers.jacket import HeatingJacket
from drivers.load_cell import LoadCell
from drivers.modbus.request import Counters, Station
from tester.process import Readings

PERIOD_S: Final = 0.5
"""Between two looks, s [A]. Silence and age are watched in every scan; this is for what lasts."""
WINDOW: Final = 4
"""Looks that a share of failed requests is taken over: 2 s [A]."""
LEAST_REQUESTS: Final = 8
"""Fewer requests in the window than this say nothing about a line [A]."""


class _Record:
    """Requests and failures of a station at the last few looks, oldest first."""

    __slots__ = ("looks", "name", "station")

    def __init__(self, name: str, station: Station) -> None:
        self.name = name
        self.station = station
        self.looks: list[tuple[int, int]] = [(0, 0)]

    def look(self) -> float:
        """Take the counters; return the share of failed requests over the window."""
        counters = self.station.counters
        looks = self.looks
        looks.append((counters.requests, failures(counters)))
        if len(looks) > WINDOW + 1:
            looks.pop(0)
        requests = looks[-1][0] - looks[0][0]
        return (looks[-1][1] - looks[0][1]) / requests if requests >= LEAST_REQUESTS else 0.0


def failures(counters: Counters) -> int:
    """Return how many requests of a station have not had a good reply."""
    return counters.timeouts + counters.crc_errors + counters.garbage + counters.late


class Inspector:
    """Fills ``Readings.device_fault`` and ``Readings.line_errors``; ``due_s`` is when to look again."""

    def __init__(self, cell: LoadCell, thermometer: IrThermometer, jacket: HeatingJacket) -> None:
        """Look at the three devices of a rig."""
        self.jacket = jacket
        self.records = (
            _Record("load cell", cell.station),
            _Record("thermometer", thermometer.station),
            _Record("jacket", jacket.station),
        )
        self.due_s = -inf

    def inspect(self, r: Readings, now: float) -> None:
        """Take a look at ``now`` s."""
        self.due_s = now + PERIOD_S
        fault = ""
        worst = 0.0
        for record in self.records:
            share = record.look()
            if share > worst:
                worst = share
            if not fault and record.station.refused is not None:
                fault = f"{record.name}: {record.station.refused}"
        if not fault and self.jacket.remote_failed:
            fault = "jacket: our setpoint does not reach it, its lease has run out"
        r.device_fault, r.line_errors = fault, worst
