"""Faults of a simulated rig: those of any machine's wires, drives and devices, the language of fault scripts, and the
code that applies them. Each kind of machine lists its faults in its own catalogue: see ``sim.machines``.

A rig without a script has no cost from this: an effect replaces an attribute or wraps a source when it begins, and
only effects that have to be renewed cost something while they last.
"""

from __future__ import annotations

from sim.faults.language import FaultLanguage, FaultTextError, Injection
from sim.faults.scene import Scene
from sim.faults.script import FaultScript

__all__ = ["FaultLanguage", "FaultScript", "FaultTextError", "Injection", "Scene"]
