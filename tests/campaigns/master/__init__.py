"""Master curves: synthetic sets with known truth, and the simulated rig end to end."""
