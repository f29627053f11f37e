"""The record of the wheel's angle and speed whenever a request over its slip ring fails.

The record is stored with the counters of the buses when a run, or a part of one, ends; ``tester.analysis.ring_errors``
evaluates it. The wheel's angle is integrated from the wheel's speed: it counts from the wheel's position when mounted,
and drifts by the error of the drive's scale, which the analysis removes.
"""

from __future__ import annotations

from math import pi
from typing import Final

from drivers.modbus import Device
from tester.analysis.ring_errors import RingSegment, speed_class
from tester.machine.modbus_health import failures
from tester.store.recorder import Recorder

BUS: Final = "slip ring"
"""Name of the data in the record's table of bus counters."""
MOST_NOTED: Final = 2000
"""Greatest number of failed requests recorded for a wheel [A]: more would add nothing, and fill the record."""
DEVICE: Final = "jacket"
"""Device beyond the ring."""
_TURN: Final = 2.0 * pi


class SlipRingWatch:
    """Reads the counters of a device beyond a slip ring, once a scan.

    A request leaves at the end of a scan, so it belongs to the angle in that scan; a later scan has its result.
    Between two scans the wheel turns 12 degrees at 100 Hz and 58 at 20 Hz (3.2 rev/s).
    """

    def __init__(self, device: Device) -> None:
        """Watch this device."""
        self.device = device
        self.segments: list[RingSegment] = [RingSegment()]
        self._requests = self._failures = 0
        self._asked_rev = self._asked_rev_s = 0.0
        self._last_rev = self._last_rad_s = 0.0

    def look(self, angle_rev: float, wheel_rad_s: float) -> None:
        """Read the counters in a scan, with the wheel's turns since it was mounted and its speed in rad/s."""
        counters = self.device.station.counters
        requests, failed = counters.requests, failures(counters)
        if failed != self._failures:
            self._note(failed - self._failures)
            self._failures = failed
        segment = self.segments[-1]
        if requests != self._requests:
            self._asked_rev, self._asked_rev_s = self._last_rev, abs(self._last_rad_s) / _TURN
            segment.requests[speed_class(self._asked_rev_s)] += requests - self._requests
            self._requests = requests
        if angle_rev < self._last_rev - 0.5:  # another wheel
            segment = RingSegment()
            self.segments.append(segment)
        if angle_rev > segment.turns:
            segment.turns = angle_rev
        self._last_rev, self._last_rad_s = angle_rev, wheel_rad_s

    def _note(self, more: int) -> None:
        segment = self.segments[-1]
        place = speed_class(self._asked_rev_s)
        segment.errors[place] += more
        if place > 0 and len(segment.at_rev) < MOST_NOTED:
            segment.at_rev.append(self._asked_rev)

    def store(self, recorder: Recorder, now_s: float) -> None:
        """Store the noted failures with the counters of the buses."""
        for number, segment in enumerate(self.segments, start=1):
            if not any(segment.requests):
                continue
            recorder.bus_statistic(now_s, BUS, DEVICE, "wheel", number)
            recorder.bus_statistic(now_s, BUS, DEVICE, "turns", segment.turns)
            for place, (requests, errors) in enumerate(zip(segment.requests, segment.errors, strict=True)):
                recorder.bus_statistic(now_s, BUS, DEVICE, f"requests {place}", requests)
                recorder.bus_statistic(now_s, BUS, DEVICE, f"errors {place}", errors)
            for turns in segment.at_rev:
                recorder.bus_statistic(now_s, BUS, DEVICE, "error at", turns)
