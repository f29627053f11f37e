"""Faults of the simulated rig: a catalogue, a language to write scripts in, and what applies them.

A rig without a script carries nothing of this: an effect replaces an attribute or wraps a source when it begins, and
only effects that have to be renewed cost something while they last.
"""

from __future__ import annotations

from sim.faults.catalogue import CATALOGUE
from sim.faults.language import FaultTextError, Injection, parse, parse_script
from sim.faults.parametric import PARAMETRIC, Parametric
from sim.faults.scene import Scene
from sim.faults.script import FaultScript

__all__ = [
    "CATALOGUE", "PARAMETRIC", "FaultScript", "FaultTextError", "Injection", "Parametric", "Scene", "parse",
    "parse_script",
]  # fmt: skip
