"""Commissioning: guides a person from connected adapters to a first trustworthy coefficient, with a record.

A kind supplies a tuple of ``CommissionStep`` (``step``) as data: the name of each step, the sections of the rig file on
which it depends, and its procedure. A procedure is a generator: it yields questions for a person and conditions of the
rig, and is resumed between two ticks, so that scans, heartbeats and STOP never wait for a person. Terminal, screen and
tests implement one interface (``person``). The record (``record``) is appended and synced entry by entry: a step with a
valid entry is not repeated; an interrupted step starts again, but only after a person agrees.
"""
