"""`tester predict`: the published model's values, units, refusals."""

from __future__ import annotations

import json
from collections.abc import Iterator

from tests.campaigns.acceptance.bench import Bench
from tests.campaigns.acceptance.figure import Figure, equal, holds, near
from tests.campaigns.acceptance.model import COEFFICIENTS, coefficient
from tests.campaigns.acceptance.topic import Topic

ORACLES = {"1#": 0.72977, "2#": 0.49736, "3#": 1.04982}
ROUNDING = 5.5e-6


def figures(bench: Bench) -> Iterator[Figure]:
    """Measure."""
    for compound, expected in ORACLES.items():
        for slip in ("300 mm/s", "0.3 m/s"):
            yield near(f"{compound} at {slip}", _mu(bench, compound, slip), expected, ROUNDING)
    yield near("1# at 20 deg of sideslip", _mu(bench, "1#", "300 mm/s", "--sideslip", "20 deg"), 0.9893, 5.5e-5)
    for compound in COEFFICIENTS:
        expected = coefficient(compound, 70.0, 400.0, 0.4)
        mu = _mu(bench, compound, "400 mm/s", load="400 N", temperature="70 degC")
        yield near(f"{compound} at 400 mm/s, 400 N, 70 degC against the equations", mu, expected, ROUNDING)
    refused = bench.tester(*_arguments("1#", "300 N"))
    yield equal("wrong unit: exit code", refused.code, 2)
    named = all(unit in refused.stderr for unit in ("m/s", "mm/s"))
    last = (refused.stderr.strip().splitlines() or [""])[-1]
    yield holds("wrong unit: the units accepted are named", named, last, "names m/s and mm/s")


def _arguments(compound: str, slip: str, load: str = "200 N", temperature: str = "25 degC") -> list[str]:
    quantities = ["--slip", slip, "--load", load, "--temperature", temperature]
    return ["predict", "--compound", compound, *quantities]


def _mu(bench: Bench, compound: str, slip: str, *more: str, load: str = "200 N", temperature: str = "25 degC") -> float:
    done = bench.tester(*_arguments(compound, slip, load, temperature), *more, "--json")
    return float(json.loads(done.stdout)["mu"]) if done.code == 0 else float("nan")


TOPIC = Topic("predict", "the model's published values, units and refusals", figures)
