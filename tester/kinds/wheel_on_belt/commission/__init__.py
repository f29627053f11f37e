"""Commissioning of a wheel on a belt: its steps as data (``steps``), a module for each procedure.

``quiet`` holds a rig with untested scales: connected, answering, nothing powered but the one axis that a person
jogs. ``armed`` holds one that has been shown to lift, to follow and to stop.
"""
