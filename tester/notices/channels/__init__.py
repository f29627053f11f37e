"""The ways on which a notice leaves the machine, one module each."""
