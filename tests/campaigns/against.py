"""This tree beside an earlier one: commands, options, keys, channels and rows; tables of fixed seeds byte for byte.

    python -m tests.campaigns.against COMMIT                  # 4 recipes x seeds 0, 7, 1001; about 25 minutes
    python -m tests.campaigns.against COMMIT --sample         # quickstart and grosch at seed 7
    python -m tests.campaigns.against COMMIT --lists          # the lists alone; seconds
    python -m tests.campaigns.against COMMIT --words FILE     # old and new wording of cells, a pair a line, by a tab

The earlier tree is taken from git into a folder of its own, and both run with this interpreter and its packages. An
item that only the earlier tree has is a miss unless ``GONE`` lists it; items that only this tree has are printed.
Tables are compared byte by byte, after the words of FILE are replaced. Exit code 1 on a miss.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import sqlite3
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

from bench.versions import TESTER, sources

ROOT = Path(__file__).parents[2]
RIGS = {"grosch": "grosch", "pin-on-disc": "pin-on-disc"}
"""The rig of a recipe; the others run on ``sim``."""
RECIPES, SEEDS = ("quickstart", "table2-load", "grosch", "pin-on-disc"), (0, 7, 1001)
SAMPLE = (("quickstart", 7), ("grosch", 7))
GONE = {
    "command record": "bus record",
    "command sdo": "bus sdo",
    "command params": "bus params",
    "command eds": "bus eds",
    "command exclude": "results exclude",
    "command include": "results include",
    "command slip-ring": "results slip-ring",
}
"""Commands that were replaced, with all of their options."""
COMMANDS = """
import click
from tester.cli.main import root
def walk(command, context, words):
    for parameter in command.params:
        if isinstance(parameter, click.Option) and not parameter.hidden:
            print(f"command {words} {parameter.opts[0]}")
    if isinstance(command, click.Group):
        for name in command.list_commands(context):
            inner = command.get_command(context, name)
            print(f"command {words} {name}".replace("  ", " "))
            walk(inner, click.Context(inner, context, info_name=name), f"{words} {name}".strip())
walk(root, click.Context(root, info_name="tester"), "")
"""


def python(tree: Path, code: str, *arguments: str) -> str:
    """Run code with a tree's packages and return what it prints."""
    environment = os.environ | {"PYTHONPATH": str(tree)}
    done = subprocess.run(
        [sys.executable, "-P", "-c", code, *arguments], cwd=tree, env=environment, capture_output=True, text=True
    )
    if done.returncode:
        raise SystemExit(f"{tree}: {arguments or code[:40]}: exit code {done.returncode}\n{done.stderr[-2000:]}")
    return done.stdout


# -- lists ----------------------------------------------------------------------------------------------------------


def keys_of(value: Any, path: str = "") -> Iterator[str]:
    """Yield the dotted keys of a YAML document."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield f"{path}{key}"
            yield from keys_of(inner, f"{path}{key}.")
    elif isinstance(value, list):
        for inner in value:
            yield from keys_of(inner, path)


def properties(schema: dict[str, Any], part: Any, path: str = "", inside: tuple[str, ...] = ()) -> Iterator[str]:
    """Yield the dotted keys that a part of a JSON Schema allows; stops at a reference to itself."""
    if isinstance(part, list):
        for item in part:
            yield from properties(schema, item, path, inside)
    elif isinstance(part, dict):
        if (reference := part.get("$ref")) is not None and reference not in inside:
            name = reference.rpartition("/")[2]
            yield from properties(schema, schema["$defs"][name], path, (*inside, reference))
        for name, inner in part.get("properties", {}).items():
            yield f"{path}{name}"
            yield from properties(schema, inner, f"{path}{name}.", inside)
        for word in ("anyOf", "oneOf", "allOf", "items", "additionalProperties"):
            yield from properties(schema, part.get(word), path, inside)


def rows_of(tree: Path) -> Iterator[str]:
    """Yield the interlock rows of each kind, from the tables of the pages."""
    for page in sorted((tree / "docs").rglob("*.md")):
        for table in re.findall(r"<!-- interlocks: begin -->\n(.*?)<!--", page.read_text(encoding="utf-8"), re.DOTALL):
            kind = "wheel" if "camber" in table else "track"
            yield from (f"row {kind} {line.split('|')[1].strip()}" for line in table.splitlines()[2:])


def lists_of(tree: Path) -> set[str]:
    """Return every command, option, key and row of a tree, one per line."""
    listed = set(python(tree, COMMANDS).splitlines())
    for path in sorted([*(tree / "recipes").glob("*.schema.json"), *(tree / "docs").glob("*.schema.json")]):
        schema = json.loads(path.read_text(encoding="utf-8"))
        listed |= {f"key {path.name.partition('.')[0]} {key}" for key in properties(schema, schema)}
        if "properties" not in schema:  # messages of the service: a schema of its parts only
            for name, part in schema.get("$defs", {}).items():
                listed |= {f"key {path.name.partition('.')[0]} {name}.{key}" for key in properties(schema, part)}
    for path in sorted([*(tree / "sim").glob("*.yaml"), *(tree / "tester").rglob("*.yaml")]):
        listed |= {f"key rig {path.stem} {key}" for key in keys_of(yaml.safe_load(path.read_text(encoding="utf-8")))}
    return listed | set(rows_of(tree))


def missing(before: set[str], now: set[str]) -> list[str]:
    """Return what only the earlier tree lists, except renamed commands."""
    lost = before - now
    for old, new in GONE.items():
        moved = {line for line in lost if line == old or line.startswith(f"{old} ")}
        lost -= {line for line in moved if line.replace(old, f"command {new}", 1) in now}
    return sorted(lost)


# -- tables ---------------------------------------------------------------------------------------------------------


def run_of(tree: Path, recipe: str, seed: int, folder: Path) -> Path:
    """Run a recipe with every scan and return the run's folder."""
    rig = RIGS.get(recipe, "sim")
    every = ["--no-leaps"] if (tree / "tester/machine/leaps.py").exists() else []  # an earlier tree never leaps
    printed = python(
        tree, TESTER, "run", recipe, "--rig", rig, "--seed", str(seed), "--yes", "--out", str(folder), *every
    )  # fmt: skip
    return Path(printed.splitlines()[-1])


def channels_of(run: Path) -> set[str]:
    """Return the channels that a run has recorded."""
    with sqlite3.connect(f"file:{run / 'run.db'}?mode=ro", uri=True) as store:
        return {f"channel {name}" for (name,) in store.execute("SELECT name FROM channel")}


def tables_of(run: Path, words: list[tuple[str, str]]) -> dict[str, str]:
    """Return the tables of a run by name, with old words replaced by new ones."""
    tables: dict[str, str] = {}
    for path in sorted(run.glob("*.csv")):
        text = path.read_bytes().decode("utf-8")
        for old, new in words:
            text = text.replace(old, new)
        tables[path.name] = text
    return tables


def words_of(path: Path | None) -> list[tuple[str, str]]:
    """Return the pairs of old and new words of a file."""
    lines = path.read_text(encoding="utf-8").splitlines() if path else []
    return [(old, new) for old, _, new in (line.partition("\t") for line in lines if line)]


def compare_runs(before: Path, recipe: str, seed: int, folder: Path, words: list[tuple[str, str]]) -> int:
    """Run a recipe on both trees, print the differences, and return the number of misses."""
    old = run_of(before, recipe, seed, folder / f"before-{recipe}-{seed}")
    new = run_of(ROOT, recipe, seed, folder / f"now-{recipe}-{seed}")
    earlier, later = tables_of(old, words), tables_of(new, [])
    different = sorted(name for name in earlier if earlier[name] != later.get(name))
    lost = sorted(channels_of(old) - channels_of(new))
    print(f"{recipe} at seed {seed}: {len(earlier)} tables, {len(different)} differ {different or ''} {lost or ''}")
    return len(different) + len(lost)


def main() -> int:
    """Compare; return 1 on a miss."""
    parser = argparse.ArgumentParser(description="Hold this tree against an earlier one.")
    parser.add_argument("commit")
    parser.add_argument("--sample", action="store_true", help="two runs instead of twelve")
    parser.add_argument("--lists", action="store_true", help="no runs")
    parser.add_argument("--words", type=Path, help="old and new words of tables, a pair a line")
    options = parser.parse_args()
    misses = 0
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        before = sources(options.commit, folder / "before")
        was, now = lists_of(before), lists_of(ROOT)
        for line in sorted(now - was):
            print(f"new   {line}")
        for line in missing(was, now):
            print(f"LOST  {line}")
            misses += 1
        print(f"{len(was)} commands, options, keys and rows before, {len(now)} now, {misses} lost")
        pairs = SAMPLE if options.sample else [(recipe, seed) for recipe in RECIPES for seed in SEEDS]
        for recipe, seed in () if options.lists else pairs:
            misses += compare_runs(before, recipe, seed, folder, words_of(options.words))
    return int(bool(misses))


if __name__ == "__main__":
    sys.exit(main())
