"""The topics by name. A module is imported when its topic is measured; each has ``measure(effort)``."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple, cast

from bench.effort import Effort
from bench.figures import Figure

Measure = Callable[[Effort], list[Figure]]


class Topic(NamedTuple):
    """A topic's module and its subject."""

    module: str
    help: str

    def load(self) -> Measure:
        """Import the module and return its ``measure``."""
        return cast("Measure", import_module(self.module).measure)


TOPICS: dict[str, Topic] = {
    "speed": Topic("bench.speed", "rig seconds per CPU second: whole runs, and the flat 100 Hz tick while sliding"),
    "scan": Topic("bench.scan_cost", "where the time of a scan goes"),
    "twin": Topic("bench.twin", "a Modbus transaction, both ends, and a tick of the plant, on the simulated rig"),
    "jobs": Topic("bench.jobs", "two jobs beside one on four equal specimens, and what putting parts together costs"),
    "lateness": Topic("bench.lateness", "punctuality in real time beside a bare loop, CPU share, missed ticks"),
    "collector": Topic("bench.collector", "garbage-collection pauses during a run"),
    "can": Topic("bench.can_cycle", "process data on CAN: codec and whole cycle, beside canopen and python-can"),
    "modbus": Topic("bench.modbus_line", "a transaction on a pseudo-terminal beside raw bytes and two libraries"),
    "service": Topic("bench.service_shell", "what clients cost the scan, CPU of the service, STOP, coming back"),
    "recorder": Topic("bench.recording", "rows per second, CPU share, samples lost at 1 kHz, a disk hog beside it"),
    "startup": Topic("bench.startup", "CPU time of the commands up to their first work"),
    "recipe": Topic("bench.big_recipe", "a recipe of 100,000 conditions"),
    "modules": Topic("bench.modules", "what each compiled module brings: its share of a plain scan, and its C"),
    "model": Topic("bench.model", "friction model on arrays beside bare NumPy"),
}
"""In the order of measuring and printing."""


def chosen(names: tuple[str, ...]) -> list[str]:
    """Return the topics to measure, all of them if none is named; raises KeyError with the first unknown name."""
    for name in names:
        if name not in TOPICS:
            raise KeyError(name)
    return [name for name in TOPICS if not names or name in names]
