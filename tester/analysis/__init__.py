"""From samples to coefficients: blocks, stability, repeats, conditions, uncertainty. Plain values throughout."""
