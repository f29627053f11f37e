"""Machines of every kind in processes of their own: their runs are killed and resumed, with simulated hands."""
