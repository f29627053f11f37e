"""Faults of a wheel on a belt: the catalogue, and the language of its scripts."""

from sim.machines.wheel_on_belt.faults.catalogue import CATALOGUE, LANGUAGE

__all__ = ["CATALOGUE", "LANGUAGE"]
