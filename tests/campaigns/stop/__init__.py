"""STOP among hostile clients, measured from outside: how long it takes from its arrival to the order in control."""
