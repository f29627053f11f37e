"""Plain Python, or with the scan compiled where FRICTION_TESTER_COMPILE=1 (docs/decisions/0019)."""

from __future__ import annotations

import atexit
import shutil
from tempfile import mkdtemp

from setuptools import setup

from compiling.wanted import wanted

# pip builds in the checkout: what an earlier build left behind must not get into this one, so each has its own folder.
base = mkdtemp(prefix="friction-tester-build-")
atexit.register(shutil.rmtree, base, ignore_errors=True)
arguments: dict[str, object] = {"options": {"build": {"build_base": base}}}
if wanted():
    from compiling.command import PLACEHOLDER, CompileScan

    arguments |= {"ext_modules": [PLACEHOLDER], "cmdclass": {"build_ext": CompileScan}}
setup(**arguments)
