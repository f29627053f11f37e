"""Faults of a simulated rig: what any machine's wires, drives and devices can have, a language to write scripts in, and
what applies them. Which faults there are to a kind of machine is its catalogue's: see ``sim.machines``.

A rig without a script carries nothing of this: an effect replaces an attribute or wraps a source when it begins, and
only effects that have to be renewed cost something while they last.
"""

from __future__ import annotations

from sim.faults.kinds import Parametric
from sim.faults.language import FaultLanguage, FaultTextError, Injection
from sim.faults.scene import Scene
from sim.faults.script import FaultScript

__all__ = ["FaultLanguage", "FaultScript", "FaultTextError", "Injection", "Parametric", "Scene"]
