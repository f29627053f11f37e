"""A look at a rig that moves nothing: what is connected, whether it is as the rig file says, and what to do.

Probes are small functions, registered in ``table``; each yields findings (``finding``). They look at one
``Examination``: the rig file, the computer behind a door (``system``), the wires behind another (``wires``), and what
was read over them. Nothing is written to a device and no drive is told anything: objects are uploaded by SDO, registers
read, and the CAN bus is listened to.
"""
