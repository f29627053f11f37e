"""Figures of runs: charts as data, and their drawing, which alone needs matplotlib (extra ``report``).

Knows no machine: the axes describe the setpoints, and callers pass published points and laws.
"""
