"""Doors into the simulated rig for other programs: its wires behind sockets, in real time.

``socketcand`` and ``modbus_tcp`` are the protocols, bytes in and bytes out; ``server`` owns the sockets and the loop.
"""
