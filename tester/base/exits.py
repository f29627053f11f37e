"""Exit codes of the `tester` command, as its help lists them: what a script may rely on."""

from __future__ import annotations

EXIT_DONE = 0
EXIT_FAILED = 1
"""A run failed, a service refused, a record differs."""
EXIT_USAGE = 2
EXIT_INVALID = 3
"""Recipe or rig file; or recipe, rig or calibration are not those of the run that is to go on."""
EXIT_UNREACHABLE = 4
EXIT_TRIPPED = 5
"""Tripped or stopped."""
EXIT_INCOMPLETE = 6
EXIT_INTERRUPTED = 130
EXIT_READER_GONE = 141
"""Nobody reads the output any more (`tester runs | head -1`): what a shell calls the end by SIGPIPE."""
