"""Fitting a law of friction to measured conditions: all parameters at once, with what the data say of them.

Knows no machine: a kind says which laws it has, what they depend on, and where its conditions come from
(``tester.analysis.fit.part``). Conditions of one group (a compound) are fitted together, groups apart.
"""
