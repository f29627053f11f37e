"""The same seed gives the same bytes; another gives other repeats."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256

from tests.acceptance.bench import Bench, RunSpec
from tests.acceptance.figure import Figure, equal, holds
from tests.acceptance.topic import Topic
from tests.acceptance.truth import OTHER_SEED, RECIPE, SHARED

TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")
LAPSED = RunSpec(RECIPE, SHARED.seed, options=("--json", "--speed", "100000"))
PLAIN = RunSpec(RECIPE, SHARED.seed)


def runs(bench: Bench) -> list[RunSpec]:
    """Name the runs: one with a bus log, one with JSON lines and at a lapse, one with another seed."""
    return [SHARED, LAPSED, OTHER_SEED, *([PLAIN] if bench.full else [])]


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    first, other = bench.run(SHARED), bench.run(OTHER_SEED)
    seconds = {"--bus-log against --json --speed 100000": LAPSED}
    if bench.full:
        seconds["--bus-log against no option"] = PLAIN
    for words, spec in seconds.items():
        second = bench.run(spec)
        for name in TABLES:
            value = _digest(second.bytes_of(name))
            yield equal(f"same seed twice, {words}: {name}", value, _digest(first.bytes_of(name)))
    ours, theirs = (_digest(run.bytes_of("repeats.csv")) for run in (first, other))
    yield holds("another seed: repeats.csv", ours != theirs, theirs, f"not {ours}")
    ours_mu, theirs_mu = ([row["mu_resultant"] for row in run.rows("repeats.csv")] for run in (first, other))
    same = sum(a == b for a, b in zip(ours_mu, theirs_mu, strict=False))
    yield equal("another seed: repeats with the same coefficient", same, 0)


def _digest(data: bytes) -> str:
    return f"{len(data)} bytes, {sha256(data).hexdigest()[:16]}"


TOPIC = Topic("determinism", "same seed, same bytes, whatever the options; another seed, other repeats", figures, runs)
