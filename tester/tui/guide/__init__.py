"""Commissioning on a screen of its own: steps, readings, the question and its answer (`tester commission RIG --tui`).

The engine is in this process, in a thread of its own (``guide``); ``person`` stands between the two, and STOP goes past
the screen's loop into it.
"""
