"""Monte Carlo of a recipe: many seeds, and values of rig-file parameters, on simulated rigs."""
