"""The environment decides whether the scan is compiled."""

from __future__ import annotations

import os

VARIABLE = "FRICTION_TESTER_COMPILE"
_MEANS = {"": False, "0": False, "1": True}


def wanted() -> bool:
    """Return whether to compile. Raises SystemExit, like a failed build, if the variable has another value."""
    value = os.environ.get(VARIABLE, "")
    if value not in _MEANS:
        raise SystemExit(f"{VARIABLE}={value}: expected 1 (compile the scan) or 0 (plain Python, the default)")
    return _MEANS[value]
