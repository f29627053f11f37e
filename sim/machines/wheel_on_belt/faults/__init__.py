"""What can go wrong with a wheel on a belt: the catalogue, its ranges, and the language of its scripts."""

from __future__ import annotations

from sim.faults.language import FaultLanguage
from sim.machines.wheel_on_belt.faults.catalogue import CATALOGUE, STEPS
from sim.machines.wheel_on_belt.faults.parametric import PARAMETRIC

LANGUAGE = FaultLanguage(CATALOGUE, STEPS)
parse = LANGUAGE.parse
parse_script = LANGUAGE.parse_script

__all__ = ["CATALOGUE", "LANGUAGE", "PARAMETRIC", "parse", "parse_script"]
