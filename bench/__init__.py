"""Cost of the software: CPU time, memory and lateness, on this machine. Run by ``python -m bench``."""
