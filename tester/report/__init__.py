"""Figures of runs: charts as data, and their drawing, which alone needs matplotlib (extra ``report``).

Knows no machine: axes tell what a condition is held at, published points and laws are handed in.
"""
