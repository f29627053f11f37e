"""Examines a rig without moving anything: its devices, their differences from the rig file, and the remedies.

Probes are small functions, registered in ``probe_table``; each yields findings (``finding``). They share one
``Examination`` of the rig file, the computer and everything read over the wires. Nothing is written to a device and no
command is sent to a drive: objects are uploaded by SDO, registers are read, and the CAN bus is monitored.
"""
