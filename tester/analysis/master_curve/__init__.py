"""Master curves: friction over speeds and temperatures as one curve over aT v, and whether the data support it.

Grosch, Proc. Roy. Soc. A 274 (1963) 21, with the shift of Williams, Landel and Ferry (``sim.physics.wlf``). The
abscissa is x = log10 v + log10 aT(T) - log10 aT(T_reference), v in m/s. Knows no machine: a kind supplies conditions,
and marks those that friction heat spoils (``tester.analysis.master_curve.points``).
"""
