"""How light the command is, and what the engine drags in."""

from __future__ import annotations

from collections.abc import Iterator

from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.figure import Figure, at_most, equal
from tests.campaigns.acceptance.topic import Topic

ATTEMPTS = 10
HELP_LIMIT_MS = 150.0
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
    attempts = [bench.tester("--help") for _ in range(ATTEMPTS)]
    yield equal("tester --help: exit codes", sorted({done.code for done in attempts}), [0])
    bare = min(bench.python("pass").cpu_s for _ in range(ATTEMPTS))
    cpu_ms = 1000.0 * min(done.cpu_s for done in attempts)
    name = f"tester --help: CPU time, least of {ATTEMPTS} ({1000.0 * bare:.0f} ms of it a bare interpreter)"
    yield at_most(name, cpu_ms, HELP_LIMIT_MS, "ms", 0)
    loaded = bench.python(EVERY_MODULE)
    yield equal("import of tester.machine and all its modules: exit code", loaded.code, 0)
    lines = [*loaded.stdout.splitlines(), "", ""]
    yield equal(f"of {', '.join(FOREIGN)}, loaded with the {lines[0]} modules of tester.machine", lines[1].split(), [])


TOPIC = Topic("startup", "CPU time of --help, imports of the engine", figures)
