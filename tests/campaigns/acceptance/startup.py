"""Start-up time of the command, and the modules that the engine imports."""

from __future__ import annotations

from collections.abc import Iterator
from statistics import median

from bench.startup import HELP_LIMIT
from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.figure import Figure, at_most, equal
from tests.campaigns.acceptance.topic import Topic

ATTEMPTS = 10
FOREIGN = ("textual", "matplotlib", "scipy")
EVERY_MODULE = f"""
import importlib, pkgutil, sys
import tester.machine
for found in pkgutil.walk_packages(tester.machine.__path__, "tester.machine."):
    importlib.import_module(found.name)
print(sum(name.startswith("tester.machine.") for name in sys.modules))
print(*sorted({{name.partition(".")[0] for name in sys.modules}} & set({FOREIGN!r})))
"""


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    first = bench.tester("--help")  # writes the bytecode of every module
    pairs = [(bench.tester("--help"), bench.python("pass")) for _ in range(ATTEMPTS)]
    yield equal("tester --help: exit codes", sorted({first.code, *(done.code for done, _ in pairs)}), [0])
    ratio = median(done.cpu_s / bare.cpu_s for done, bare in pairs)
    note = f", of {1e3 * median(bare.cpu_s for _, bare in pairs):.0f} ms"
    name = f"tester --help: CPU time beside python -c pass, median of {ATTEMPTS} pairs"
    yield at_most(name, ratio, HELP_LIMIT, "times", 1, note=note)
    loaded = bench.python(EVERY_MODULE)
    yield equal("import of tester.machine and all its modules: exit code", loaded.code, 0)
    lines = [*loaded.stdout.splitlines(), "", ""]
    yield equal(f"of {', '.join(FOREIGN)}, loaded with the {lines[0]} modules of tester.machine", lines[1].split(), [])


TOPIC = Topic("startup", "CPU time of --help, imports of the engine", figures)
