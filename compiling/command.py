"""The build step that compiles the scan on all cores, and reports its progress (`pip -v` shows it)."""

from __future__ import annotations

import os
import shutil
import sysconfig
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from distutils.ccompiler import new_compiler
from distutils.errors import CCompilerError, DistutilsError
from distutils.sysconfig import customize_compiler
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic  # noqa: TID251 - the build prints its duration

from setuptools import Extension
from setuptools.command.build_ext import build_ext

from compiling.modules import BUSIEST, HOT
from compiling.wanted import VARIABLE

LIBRARY = "friction_tester"
"""Prefix of the name of the library that all compiled modules share."""
OPTIONS = ("--ignore-missing-imports", "--follow-imports=silent")
PLACEHOLDER = Extension("tester.compiled", [])
"""Marks the build as compiled, so that the wheel is for this platform."""
FLAGS = {"unix": ("-O1", "-fvisibility=hidden", "-fno-asynchronous-unwind-tables")}
"""By the kind of compiler, after mypyc's own flags: -O1 is as fast as -O2 here and takes two thirds of the time to
build."""
FLAGS_OF_REST = {"unix": ("-Og",)}
"""After those, for all but the busiest modules: if used for all, 7 % slower than -O1 and built in two thirds of the
time."""
UNITS = 6
"""Number of C files for the busiest modules, and for the rest."""
_REST = "rest"
_ROOT = Path(__file__).parents[1]
_LINES = 10
"""Progress lines of the long step."""


class CompileScan(build_ext):
    """Translates the modules of the scan to C and compiles them; fails with a clear message if it cannot."""

    def run(self) -> None:
        """Look for a compiler, translate, compile, link. Raises SystemExit that names what is missing."""
        require_compiler()
        begun = monotonic()
        with TemporaryDirectory(prefix="friction-tester-") as folder:
            extensions = translated(Path(folder))
            say(f"translated {len(extensions) - 1} modules to C in {monotonic() - begun:.0f} s")
            self.distribution.ext_modules = extensions
            self.reinitialize_command(self, inplace=self.inplace)
            self.ensure_finalized()
            try:
                super().run()
            except (CCompilerError, DistutilsError) as error:
                raise impossible(f"the compiler failed: {error}") from error
        say(f"compiled in {monotonic() - begun:.0f} s")

    def build_extensions(self) -> None:
        """Compile the library that holds every module, then the small files through which Python finds its modules."""
        self.check_extensions_list(self.extensions)
        library, *doors = sorted(self.extensions, key=lambda extension: -len(extension.sources))
        kind = self.compiler.compiler_type
        self.compiler.compile = side_by_side(self.compiler.compile, cores(), FLAGS_OF_REST.get(kind, ()))
        library.extra_compile_args += FLAGS.get(kind, ())
        library.sources = joined(library.sources)
        say(f"compiling {len(library.sources)} files, {cores()} at a time")
        self.build_extension(library)
        for number, alike in enumerate(without_namesakes(doors)):
            self.build_doors(alike, Path(library.sources[0]).with_name(f"doors_{number}.c"))

    def build_doors(self, doors: Sequence[Extension], source: Path) -> None:
        """Build one file with the entry functions of all these modules, and copy it to the place of each."""
        write_doors([door.sources[0] for door in doors], source)
        first, *others = doors
        first.sources = [str(source)]
        self.build_extension(first)
        for door in others:
            place = Path(self.get_ext_fullpath(door.name))
            place.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(self.get_ext_fullpath(first.name), place)


def joined(sources: Sequence[str]) -> list[str]:
    """Write C files that include the sources, of about equal size, beside them, and return their names.

    Every file reads a megabyte of headers, so a few files compile faster than many. One includes mypyc's own.
    """
    busiest = {c_file(name) for name in BUSIEST}
    units: dict[str, list[Path]] = {}
    for path in sorted(map(Path, sources), key=lambda path: (-path.stat().st_size, path)):
        kind = "busiest" if path.name in busiest else _REST if path.name.startswith("__native_") else "mypyc"
        names = [f"{kind}_{number}.c" for number in range(1 if kind == "mypyc" else UNITS)]
        smallest = min(names, key=lambda name: sum(one.stat().st_size for one in units.get(name, ())))
        units.setdefault(smallest, []).append(path)
    for name, unit in units.items():
        text = "".join(f'#include "{path.name}"\n' for path in unit)
        unit[0].with_name(name).write_text(text, encoding="ascii")
    return [str(unit[0].with_name(name)) for name, unit in units.items()]


def c_file(module: str) -> str:
    """Return the name of the C file that mypyc makes of a module's file."""
    return f"__native_{module.removesuffix('.py').replace('/', '___')}.c"


def without_namesakes(doors: Sequence[Extension]) -> list[list[Extension]]:
    """Return the modules in lists without duplicate last names: an entry function has that name."""
    lists: list[dict[str, Extension]] = []
    for door in doors:
        last = door.name.rpartition(".")[2]
        room = next((one for one in lists if last not in one), None)
        if room is None:
            lists.append(room := {})
        room[last] = door
    return [list(one.values()) for one in lists]


def write_doors(sources: Sequence[str], file: Path) -> None:
    """Write a C file that includes the sources; each also defines one function of the same name, never called."""
    lines = [
        f'#define PyInit___init__ unused_{number}\n#include "{Path(source).as_posix()}"\n#undef PyInit___init__\n'
        for number, source in enumerate(sources)
    ]
    file.write_text("".join(lines), encoding="utf-8")


Compile = Callable[..., list[str]]


def side_by_side(compile_files: Compile, jobs: int, flags_of_rest: Sequence[str] = ()) -> Compile:
    """Return a compiler's ``compile`` with ``jobs`` files at a time; objects come in the order of the sources."""

    def compile_all(sources: list[str], *args: object, **options: object) -> list[str]:
        if len(sources) == 1:
            return compile_files(sources, *args, **options)
        begun, done = monotonic(), count(1)
        every = max(len(sources) // _LINES, 1)

        def compile_one(source: str) -> list[str]:
            own = flags_of_rest if Path(source).name.startswith(_REST) else ()
            postargs = [*(options.get("extra_postargs") or ()), *own]
            objects = compile_files([source], *args, **options | {"extra_postargs": postargs})
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
    """Translate the modules to C files in ``folder``; return the sources to compile. Raises SystemExit."""
    try:
        from mypyc.build import mypycify
    except ImportError as error:
        raise impossible(f"mypy is not there: {error} (a build without isolation has to bring it)") from error
    options = [*OPTIONS, f"--cache-dir={folder / 'cache'}"]
    try:
        return mypycify(
            [*options, *HOT], opt_level="2", debug_level="0", multi_file=True, group_name=LIBRARY,
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
    """Return the exception of a build that should compile but cannot."""
    return SystemExit(
        f"friction-tester: {VARIABLE}=1 asks for a compiled scan: {why}\n"
        f"Without {VARIABLE} the same program is installed as plain Python, with the same results."
    )


def cores() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def say(text: str) -> None:
    """Print a line at once."""
    print(f"friction-tester: {text}", flush=True)
