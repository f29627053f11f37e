"""Fits a friction law to measured conditions: all parameters at once, with their uncertainty.

Knows no machine: a kind supplies its laws, their variables and its conditions (``tester.analysis.fit.fit_part``).
Conditions of one group (a compound) are fitted together, each group separately.
"""
