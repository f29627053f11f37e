"""The topics: the README's two commands, the ways of installing, interpreters, the compiled installation."""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import zipfile
from collections.abc import Callable, Iterator
from math import inf
from pathlib import Path

from tests.campaigns.acceptance.figure import Figure, at_most, equal, holds
from tests.campaigns.install.place import (
    PASS_S,
    CommandResult,
    carry_out,
    fresh_copy,
    megabytes,
    pass_s,
    readme_command,
    without_warnings,
)

CPU_AT_MOST_S = 60.0
"""From the first keystroke to the table, where `python3 -c pass` takes PASS_S."""
INSTALLED_AT_MOST_MB = 250.0
TESTS_BEGIN_WITHIN_S = 90.0
"""Wall time where `python3 -c pass` takes PASS_S or less; more on a slower machine, as for the CPU time."""
COMPILED_AT_MOST = 0.6
"""Two cores against one."""
BUILD_CPU_AT_MOST_S = 110.0
"""Of a compiled wheel, including mypy's installation, where `python3 -c pass` takes PASS_S: a minute on two cores."""
VERSIONS = ("3.11", "3.12", "3.13", "3.14")
_ROW = re.compile(r"^1#\s+300\s+(100|200)\s+0\s+40\s+0\.\d{3}\s+0\.\d{3}\s+\d of \d", re.MULTILINE)
_SDIST = "import sys; sys.path.insert(0, '.'); from compiling import backend; backend.build_sdist(sys.argv[1])"
_DOTS = re.compile(r"^[.sxFE]", re.MULTILINE)


def main_command(work: Path) -> Iterator[Figure]:
    """The README's main command, from the first keystroke to the table."""
    copy = fresh_copy(work / "main")
    result = carry_out(readme_command("run quickstart --yes"), copy)
    unit = pass_s(copy / ".venv" / "bin" / "python")
    limit = CPU_AT_MOST_S * unit / PASS_S
    note = f" ({result.cpu_s / unit:.0f} x `python3 -c pass`, {1e3 * unit:.1f} ms)"
    yield equal("exit code", result.code, 0)
    yield at_most("CPU time to the table", result.cpu_s, round(limit, 1), "s", 1, note=note)
    yield unjudged("wall time, downloads included", f"{result.wall_s:.0f} s; load {os.getloadavg()[0]:.1f}")
    yield unjudged("first output; longest silence", f"{result.first_s:.1f} s; {result.silence_s:.1f} s")
    yield at_most("installed", megabytes(copy / ".venv"), INSTALLED_AT_MOST_MB, "MB", 0)
    folder = result.text.rstrip().splitlines()[-1]
    table = copy / folder / "appendix.csv"
    yield holds("last line is the run's folder", table.is_file(), folder, "holds appendix.csv")
    lines = table.read_text(encoding="utf-8").splitlines() if table.is_file() else []
    yield equal("rows of that table", len(lines) - 1, 2)
    rows = {match[1] for match in _ROW.finditer(result.text)}
    yield equal("loads in the table that is printed, with uncertainty (N)", sorted(rows), ["100", "200"])
    named = "\nnext: " in result.text
    yield holds("a command to try next", named, "named" if named else "no", "named")
    left = [path.name for path in copy.iterdir() if path.name in ("build", "dist", ".mypy_cache")]
    yield equal("left behind by the build", left, [])


def _begun(text: str) -> bool:
    """Return whether an output has a test's result."""
    return _DOTS.search(text, text.find("Successfully installed") + 1) is not None and "Successfully" in text


def test_command(work: Path) -> Iterator[Figure]:
    """The README's test command, from the first keystroke to the first test's result."""
    copy, unit_s = fresh_copy(work / "tests"), _pass_before_s(work)
    result = carry_out(readme_command("/pytest"), copy, until=_begun)
    if result.code is not None:
        yield holds("tests begin", False, without_warnings(result.text), "a test's result")
        return
    yield _begins(unit_s, result.wall_s)


def whole_test_command(work: Path) -> Iterator[Figure]:
    """The README's test command to its end, with its output, and the time to the first test's result."""
    copy, unit_s = fresh_copy(work / "tests"), _pass_before_s(work)
    so_far, first_s = "", inf

    def on_output(piece: str, at_s: float) -> None:
        nonlocal so_far, first_s
        print(piece, end="", flush=True)
        if first_s == inf:
            so_far += piece
            first_s = at_s if _begun(so_far) else inf

    result = carry_out(readme_command("/pytest"), copy, on_output=on_output)
    yield equal("exit code", result.code, 0)
    yield unjudged("wall and CPU time", f"{result.wall_s:.0f} s, {result.cpu_s:.0f} s; load {os.getloadavg()[0]:.1f}")
    yield _begins(unit_s, first_s)


def _pass_before_s(work: Path) -> float:
    """Return the time of `python -c pass` just before the command, s: a machine's speed drifts within minutes."""
    work.mkdir(parents=True, exist_ok=True)
    must(carry_out("python3 -m venv --without-pip bare", work))
    return pass_s(work / "bare" / "bin" / "python")


def _begins(unit_s: float, wall_s: float) -> Figure:
    """Return the figure of the time to the first test's result; ``unit_s``: the time of `python -c pass`."""
    limit = TESTS_BEGIN_WITHIN_S * max(1.0, unit_s / PASS_S)
    note = f" (wall, downloads included; `python3 -c pass` {1e3 * unit_s:.1f} ms before)"
    return at_most("tests begin after", wall_s, round(limit, 1), "s", 0, note=note)


def ways(work: Path) -> Iterator[Figure]:
    """From a checkout, twice, and from its source archive: the same wheel, for any platform."""
    copy = fresh_copy(work / "ways")
    stale = copy / "build" / "lib" / "tester" / "stale.py"
    stale.parent.mkdir(parents=True)
    stale.write_text("raise SystemExit('of an earlier build')\n", encoding="ascii")
    must(carry_out("python3 -m venv .venv && .venv/bin/pip install -q 'setuptools>=77'", copy))
    must(carry_out(f'.venv/bin/python -c "{_SDIST}" sdist', copy))
    (archive,) = (copy / "sdist").glob("*.tar.gz")
    for name, source in (("one", "."), ("two", "."), ("archive", f"sdist/{archive.name}")):
        must(carry_out(f".venv/bin/pip wheel -q --no-deps -w wheels-{name} {source}", copy))
    wheels = {name: next((copy / f"wheels-{name}").glob("*.whl")) for name in ("one", "two", "archive")}
    yield holds("wheel", wheels["one"].name.endswith("-py3-none-any.whl"), wheels["one"].name, "for any platform")
    contents = {name: digests(path) for name, path in wheels.items()}
    yield equal("files that differ when built again", differing(contents["one"], contents["two"]), [])
    yield equal("files that differ when built from the archive", differing(contents["one"], contents["archive"]), [])
    yield equal("files of an earlier build", [name for name in contents["one"] if "stale" in name], [])


def interpreters(work: Path) -> Iterator[Figure]:
    """Every interpreter on this machine: installs, and runs the quickstart with the same table."""
    tables: dict[str, bytes] = {}
    for version in VERSIONS:
        python = interpreter(version)
        if python is None:
            yield unjudged(f"Python {version}", "not on this machine")
            continue
        copy = fresh_copy(work / f"python-{version}")
        command = f"{python} -m venv .venv && .venv/bin/pip install -q . && .venv/bin/tester run quickstart --yes"
        result = carry_out(command, copy)
        yield holds(f"Python {version}", result.code == 0, f"exit {result.code}, {result.cpu_s:.0f} s of CPU", "exit 0")
        if result.code:
            print(without_warnings(result.text))
        else:
            tables[version] = (copy / result.text.rstrip().splitlines()[-1] / "appendix.csv").read_bytes()
    yield equal("different tables", len(set(tables.values())), 1)


def compiled(work: Path) -> Iterator[Figure]:
    """The compiled installation on one core and on two; both must be idle. Takes some minutes."""
    usable = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
    if len(usable) < 2:
        yield holds("cores", False, str(len(usable)), "two")
        return
    copy = fresh_copy(work / "compiled")
    took: dict[int, float] = {}
    for cores in (2, 1):
        load = os.getloadavg()[0]
        must(carry_out(f"python3 -m venv venv-{cores}", copy))
        result = must(
            carry_out(
                f"venv-{cores}/bin/pip install -v --no-deps .", copy, cores=set(usable[:cores]),
                FRICTION_TESTER_COMPILE="1",
            )
        )  # fmt: skip
        took[cores] = result.wall_s
        lines = len(re.findall(r"friction-tester: ", result.text))
        name = f"cores: {cores}; wall, CPU, lines of progress"
        yield unjudged(name, f"{result.wall_s:.0f} s, {result.cpu_s:.0f} s, {lines}; load before it {load:.1f}")
        library = list((copy / f"venv-{cores}").rglob("friction_tester__mypyc*"))
        yield holds(f"compiled on {cores}", len(library) == 1, str(len(library)), "one library")
    yield at_most("two cores against one", took[2] / took[1], COMPILED_AT_MOST, "", 2)
    refused = carry_out("venv-1/bin/pip install --no-deps .", copy, FRICTION_TESTER_COMPILE="1", CC="no-such-compiler")
    clear = refused.code != 0 and "asks for a compiled scan: no C compiler" in refused.text
    yield holds("without a compiler", clear, f"exit {refused.code}", "fails and says why")


def wheel(work: Path) -> Iterator[Figure]:
    """A compiled wheel: CPU time to build; used without a compiler, with a laboratory's own kind. Takes minutes."""
    copy = fresh_copy(work / "wheel")
    must(carry_out("python3 -m venv builder && python3 -m venv user", copy))
    result = must(carry_out("builder/bin/pip wheel -v --no-deps -w dist .", copy, FRICTION_TESTER_COMPILE="1"))
    unit = pass_s(copy / "user" / "bin" / "python")
    limit = round(BUILD_CPU_AT_MOST_S * max(1.0, unit / PASS_S), 1)
    note = f" (wall {result.wall_s:.0f} s, load {os.getloadavg()[0]:.1f}, `python3 -c pass` {1e3 * unit:.1f} ms)"
    yield at_most("CPU time to build", result.cpu_s, limit, "s", 1, note=note)
    (built,) = (copy / "dist").glob("*.whl")
    yield holds("wheel", "-py3-none-any" not in built.name, built.name, "for this platform")
    elsewhere = work / "elsewhere"
    elsewhere.mkdir()
    for folder in ("tests", "docs"):
        shutil.copytree(copy / folder, elsewhere / folder)
    tools = work / "tools"  # a shell, and nothing else from this computer
    tools.mkdir()
    (tools / "bash").symlink_to(shutil.which("bash") or "/bin/bash")
    bare = {"PATH": f"{copy / 'user' / 'bin'}{os.pathsep}{tools}", "CC": "/nonexistent"}
    must(carry_out(f"pip install -q {built} pytest", elsewhere, **bare))
    found = carry_out("command -v cc gcc clang", elsewhere, **bare)
    yield equal("compilers that can be found", found.text.split(), [])
    ran = must(carry_out("tester run quickstart --yes --seed 0", elsewhere, **bare))
    rows = {match[1] for match in _ROW.finditer(ran.text)}
    yield equal("loads in the quickstart's table (N)", sorted(rows), ["100", "200"])
    where = carry_out("python -c 'import tester.machine.control as found; print(found.__file__)'", elsewhere, **bare)
    yield holds("scan", ".py" not in Path(where.text.strip()).suffix, Path(where.text.strip()).name, "compiled")
    extension = "tests/extension --ignore tests/extension/test_counts.py"  # it counts files of a checkout
    extended = carry_out(f"python -m pytest -q -p no:cacheprovider {extension}", elsewhere, **bare)
    yield holds("tests of extensions", extended.code == 0, without_warnings(extended.text, 1), "pass")


TOPICS: dict[str, Callable[[Path], Iterator[Figure]]] = {
    "main": main_command,
    "tests": test_command,
    "ways": ways,
    "interpreters": interpreters,
    "compiled": compiled,
    "wheel": wheel,
}
SAMPLE = ("main", "tests", "ways")
"""What takes two minutes together."""


def unjudged(name: str, value: str) -> Figure:
    """Return a figure without a limit."""
    return Figure(name, value, "no limit", True)


def must(result: CommandResult) -> CommandResult:
    """Return the command's result; raises ValueError with its last lines if it failed."""
    if result.code:
        raise ValueError(f"exit {result.code}: {without_warnings(result.text)}")
    return result


def interpreter(version: str) -> str | None:
    """Return the path of a working interpreter: on the search path or from pyenv."""
    pyenv = sorted((Path.home() / ".pyenv" / "versions").glob(f"{version}.*/bin/python3"))
    for found in (*map(str, pyenv), shutil.which(f"python{version}")):
        if found and carry_out(f"{found} -c 'import venv, ssl'", Path.cwd()).code == 0:
            return found
    return None


def digests(wheel: Path) -> dict[str, str]:
    """Return the digest of every file in a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        return {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}


def differing(one: dict[str, str], other: dict[str, str]) -> list[str]:
    """Return the names of the files that differ."""
    return sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))
