"""The commissioning screen: steps, readings, the question and its answer (`tester commission RIG --tui`).

The engine runs in this process in a separate thread (``guide``); ``person`` connects the two, and STOP bypasses the
screen's loop.
"""
