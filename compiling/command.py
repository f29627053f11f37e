"""The build step that compiles the scan, file by file on all cores, and says what it does (`pip -v` shows it)."""

from __future__ import annotations

import os
import sysconfig
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from distutils.ccompiler import new_compiler
from distutils.errors import CCompilerError, DistutilsError
from distutils.sysconfig import customize_compiler
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic  # noqa: TID251 - how long a build takes is told to people

from setuptools import Extension
from setuptools.command.build_ext import build_ext

from compiling.modules import HOT
from compiling.wanted import VARIABLE

LIBRARY = "friction_tester"
"""Begins the name of the library that all compiled modules share."""
OPTIONS = ("--ignore-missing-imports", "--follow-imports=silent")
PLACEHOLDER = Extension("tester.compiled", [])
"""Says that there is something to compile, so that the wheel is one for this platform."""
_ROOT = Path(__file__).parents[1]
_LINES = 10
"""Progress lines of the long step."""


class CompileScan(build_ext):
    """Translates the modules of the scan to C and compiles them; fails clearly where that cannot be done."""

    def run(self) -> None:
        """Look for a compiler, translate, compile, link. Raises SystemExit with what is missing."""
        require_compiler()
        begun = monotonic()
        with TemporaryDirectory(prefix="friction-tester-") as folder:
            extensions = translated(Path(folder))
            files = sum(len(extension.sources) for extension in extensions)
            say(f"translated {len(extensions) - 1} modules to C in {monotonic() - begun:.0f} s")
            self.distribution.ext_modules = extensions
            self.reinitialize_command(self, inplace=self.inplace)
            self.ensure_finalized()
            say(f"compiling {files} files, {cores()} at a time")
            try:
                super().run()
            except (CCompilerError, DistutilsError) as error:
                raise impossible(f"the compiler failed: {error}") from error
        say(f"compiled {files} files in {monotonic() - begun:.0f} s")

    def build_extensions(self) -> None:
        """Compile every file by itself, the greatest first, then what is left of each module side by side."""
        self.check_extensions_list(self.extensions)
        self.compiler.compile = side_by_side(self.compiler.compile, cores())
        alone = [extension for extension in self.extensions if len(extension.sources) > 1]
        for extension in alone:
            self.build_extension(extension)
        with ThreadPoolExecutor(cores()) as pool:
            list(pool.map(self.build_extension, [one for one in self.extensions if one not in alone]))


Compile = Callable[..., list[str]]


def side_by_side(compile_files: Compile, jobs: int) -> Compile:
    """Return a compiler's ``compile`` with ``jobs`` files at a time; objects come in the order of the sources."""

    def compile_all(sources: list[str], *args: object, **options: object) -> list[str]:
        if len(sources) == 1:
            return compile_files(sources, *args, **options)
        begun, done = monotonic(), count(1)
        every = max(len(sources) // _LINES, 1)

        def compile_one(source: str) -> list[str]:
            objects = compile_files([source], *args, **options)
            number = next(done)
            if number % every == 0 or number == len(sources):
                say(f"{number} of {len(sources)} files, {monotonic() - begun:.0f} s")
            return objects

        greatest_first = sorted(sources, key=lambda source: -Path(source).stat().st_size)
        with ThreadPoolExecutor(jobs) as pool:
            objects = dict(zip(greatest_first, pool.map(compile_one, greatest_first), strict=True))
        return [name for source in sources for name in objects[source]]

    return compile_all


def translated(folder: Path) -> list[Extension]:
    """Translate the modules to C files in ``folder``; return what is to be compiled. Raises SystemExit."""
    try:
        from mypyc.build import mypycify
    except ImportError as error:
        raise impossible(f"mypy is not there: {error} (a build without isolation has to bring it)") from error
    found = sorted(str(path.relative_to(_ROOT)) for pattern in HOT for path in _ROOT.glob(pattern))
    options = [*OPTIONS, f"--cache-dir={folder / 'cache'}"]
    try:
        return mypycify(
            [*options, *found], opt_level="2", debug_level="0", multi_file=True, group_name=LIBRARY,
            target_dir=str(folder),
        )  # fmt: skip
    except SystemExit as error:
        raise impossible("mypyc cannot translate the modules (its messages are above)") from error


def require_compiler() -> None:
    """Raise SystemExit unless a C compiler compiles a file that includes Python.h."""
    compiler = new_compiler()
    with TemporaryDirectory(prefix="friction-tester-") as folder:
        source = Path(folder) / "tried.c"
        source.write_text("#include <Python.h>\n", encoding="ascii")
        try:
            customize_compiler(compiler)
            include = sorted({sysconfig.get_path("include"), sysconfig.get_path("platinclude")})
            compiler.compile([str(source)], output_dir=folder, include_dirs=include)
        except (CCompilerError, DistutilsError, OSError) as error:
            raise impossible(f"no C compiler and Python headers that work together: {error}") from error


def impossible(why: str) -> SystemExit:
    """Return the end of a build that was asked to compile and cannot."""
    return SystemExit(
        f"friction-tester: {VARIABLE}=1 asks for a compiled scan: {why}\n"
        f"Without {VARIABLE} the same program is installed as plain Python, with the same results."
    )


def cores() -> int:
    """Return on how many cores this process may run."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def say(text: str) -> None:
    """Print a line at once."""
    print(f"friction-tester: {text}", flush=True)
