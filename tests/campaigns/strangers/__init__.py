"""Defects that are in no list: any quantity of a machine goes wrong, alone or with another, at any moment.

The catalogue of ``sim.faults`` is not used: a defect here is a place of the machine (a reading, a motion, a piece of
the wheel, a line), a course in time and a size, all drawn by seed.
"""
