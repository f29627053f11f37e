"""Commissioning of a wheel on a belt: its steps as data (``commission_steps``), a module for each procedure.

``quiet`` is the rig with untested scales: connected, without power except for the one axis that a person jogs.
``armed`` is the rig after proofs that it lifts, follows and stops.
"""
