"""Master curves: friction over speeds and temperatures as one curve over aT v, and whether it is one.

Grosch, Proc. Roy. Soc. A 274 (1963) 21, with the shift of Williams, Landel and Ferry (``sim.physics.wlf``). What is
drawn is x = log10 v + log10 aT(T) - log10 aT(T_reference), v in m/s. Knows no machine: a kind hands conditions in, and
says where friction heat spoils them (``tester.analysis.master_curve.part``).
"""
