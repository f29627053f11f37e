"""From samples to coefficients: blocks, stability, repeats, conditions, uncertainty. Works on plain values."""
