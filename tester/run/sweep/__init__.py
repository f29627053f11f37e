"""Monte Carlo of a recipe on simulated rigs: many seeds, and values of rig-file parameters."""
