"""The machine of the figures."""

from __future__ import annotations

import importlib.util
import os
import platform
import sys
import sysconfig
from pathlib import Path


def built_with_pgo() -> str:
    """Return "yes" or "no": was the interpreter's build guided by a profile; "unknown" if it does not state this."""
    arguments: object = sysconfig.get_config_var("CONFIG_ARGS")
    flags: object = sysconfig.get_config_var("PY_CORE_CFLAGS") or ""
    if not isinstance(arguments, str):
        return "unknown"
    guided = "--enable-optimizations" in arguments or "-fprofile-use" in str(flags)
    return "yes" if guided else "no"


def scan_is_compiled() -> str:
    """Return "yes" or "no": are the modules of the scan machine code (setup.py) or Python."""
    found = importlib.util.find_spec("tester.kinds.wheel_on_belt.control.step")
    origin = found.origin if found is not None else None
    return "yes" if origin is not None and not origin.endswith(".py") else "no"


def measures_installed() -> bool:
    """Return whether ``tester`` is imported from an installation, not from beside this package."""
    found = importlib.util.find_spec("tester")
    places = found.submodule_search_locations if found is not None else None
    return all(Path(place).resolve().parent != Path(__file__).resolve().parent.parent for place in places or ())


def usable_cpus() -> int:
    """Return the number of CPUs that this process may use."""
    if sys.platform == "linux":
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def machine() -> dict[str, str | int]:
    """Return interpreter, build, CPUs and system, as in the report."""
    return {
        "interpreter": f"{platform.python_implementation()} {platform.python_version()}",
        "pgo": built_with_pgo(),
        "measured": "installed" if measures_installed() else "checkout",
        "compiled scan": scan_is_compiled(),
        "compiler": platform.python_compiler(),
        "cpus": usable_cpus(),
        "processor": _processor(),
        "system": f"{platform.system()} {platform.machine()}",
    }


def _processor() -> str:
    """Return the processor's name; Linux keeps it in a file."""
    listing = Path("/proc/cpuinfo")
    if listing.exists():
        for line in listing.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown"
