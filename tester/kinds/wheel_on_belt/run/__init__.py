"""A run of a wheel on a belt: built from a rig file, split into parts, with the evidence of past runs."""
