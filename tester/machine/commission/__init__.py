"""Commissioning: the guided way from plugged adapters to a first trusted coefficient, kept on record.

A kind brings a tuple of ``CommissionStep`` (``step``), data: what each is called, which sections of the rig file it
depends on, and its procedure. A procedure is a generator: it yields questions for a person and conditions of the rig,
and is woken between two ticks, so that scans, heartbeats and STOP never wait for a person. Terminal, screen and tests
are fronts of one interface (``person``). The record (``record``) is appended to and synced, entry by entry: a step
whose entry stands is not done again, one that was cut off begins anew, and begins only when a person says so.
"""
