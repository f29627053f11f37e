"""What the software costs: CPU time, memory and lateness, on the machine at hand. Run by ``python -m bench``."""
