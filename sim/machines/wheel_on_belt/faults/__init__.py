"""Faults of a wheel on a belt: the catalogue, its ranges, and the language of its scripts."""

from __future__ import annotations

from collections.abc import Iterator

from sim.faults.kinds import Parametric
from sim.faults.language import FaultLanguage
from sim.machines.wheel_on_belt.faults.catalogue import CATALOGUE, STEPS

LANGUAGE = FaultLanguage(CATALOGUE, STEPS)
parse = LANGUAGE.parse
parse_script = LANGUAGE.parse_script
_LAGS = {"load cell": 4.0, "thermometer": 6.0, "hub sensor": 40.0}
"""Greatest time constant, or delay, of a sensor in a search, s."""


def _ranges() -> Iterator[tuple[str, float, float, float]]:
    """Yield phrase, least and greatest magnitude, and the faultless magnitude, at which a search begins."""
    yield "load cell offset", -200.0, 200.0, 0.0
    yield "load cell drift", -5.0, 5.0, 0.0
    yield "load cell gain", 50.0, 150.0, 100.0
    yield "hub sensor offset", -40.0, 40.0, 0.0
    yield "hub sensor gain", 60.0, 140.0, 100.0
    yield "hub sensor partly detached", 60.0, 100.0, 100.0
    yield "thermometer offset", -40.0, 40.0, 0.0
    yield "thermometer drift", -1.0, 1.0, 0.0
    yield "thermometer gain", 60.0, 140.0, 100.0
    yield "common supply of hub sensor and thermometer", 60.0, 140.0, 100.0
    for name in ("load cell", "thermometer", "hub sensor"):
        for slow in ("lag", "delay"):
            yield f"{name} {slow}", 0.0, _LAGS[name], 0.0
    for axis in ("wheel", "belt"):
        yield f"{axis} speed scale", 50.0, 200.0, 100.0
    yield "wheel diameter", 85.0, 115.0, 100.0
    yield "belt slips on its roller", 0.0, 100.0, 0.0
    yield "rubber detached", 0.0, 1.0, 0.0
    yield "rubber relaxation", 3.0, 15.0, 3.0
    yield "CAN frames late", 0.0, 1.0, 0.0


PARAMETRIC: dict[str, Parametric] = {
    phrase: Parametric(CATALOGUE[phrase], least, most, normal) for phrase, least, most, normal in _ranges()
}
"""The rows of the catalogue whose magnitude matters, each with its range, by phrase."""

__all__ = ["CATALOGUE", "LANGUAGE", "PARAMETRIC", "parse", "parse_script"]
