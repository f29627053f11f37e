"""Doors into the simulated rig for other programs: its wires behind sockets, in real time.

``socketcand`` and ``modbus_tcp`` implement the protocols, bytes in and bytes out; ``server`` has the sockets and the
loop.
"""
