"""The same seed gives the same bytes; another seed gives other repeats."""

from __future__ import annotations

from collections.abc import Iterator
from hashlib import sha256

import recipes
from tests.campaigns.acceptance.bench import Bench, ProductError, RunSpec
from tests.campaigns.acceptance.figure import Figure, equal, holds
from tests.campaigns.acceptance.topic import Topic

TABLES = ("appendix.csv", "conditions.csv", "repeats.csv")
SEED, OTHER_SEED = 0, 2
SHORTER = (
    ("load: [100 N, 200 N]", "load: 200 N"),
    ("temperature: 40 degC", "temperature: 25 degC"),
    ("duration: 4 min", "duration: 10 s"),
    ("at_least: 20 min", "at_least: 1 min"),
)
"""Changes to the quickstart in the short form; its wheel counts as run in (sim.running_in=0)."""


class Trials:
    """The runs of a bench: plain, with a bus log, with JSON lines at a lapse, with another seed."""

    def __init__(self) -> None:
        """Nothing is written yet."""
        self._recipes: dict[Bench, str] = {}
        self._pairs: dict[Bench, str] = {}

    def specs(self, bench: Bench) -> dict[str, RunSpec]:
        """Return the runs by description; the others are compared with the first."""
        overrides = () if bench.full else ("sim.running_in=0",)
        recipe = self._recipe(bench)
        found = {
            "--bus-log": RunSpec(recipe, SEED, overrides, bus_log=True),
            "--json --speed 100000": RunSpec(recipe, SEED, overrides, ("--json", "--speed", "100000")),
            "another seed": RunSpec(recipe, OTHER_SEED, overrides),
        }
        return found | ({"no option": RunSpec(recipe, SEED, overrides)} if bench.full else {})

    def pair(self, bench: Bench) -> list[RunSpec]:
        """Return a run of two specimens with one job and with two; long form only (2 x 45 min of rig time)."""
        if not bench.full:
            return []
        if bench not in self._pairs:
            one = '  - compound: "1#"\n'
            text = (recipes.FOLDER / "quickstart.yaml").read_text(encoding="utf-8")
            self._pairs[bench] = str(bench.write("two-specimens.yaml", text.replace(one, f'{one}  - compound: "2#"\n')))
        return [RunSpec(self._pairs[bench], SEED, options=("--jobs", jobs)) for jobs in ("1", "2")]

    def runs(self, bench: Bench) -> list[RunSpec]:
        """Name the runs."""
        return [*self.specs(bench).values(), *self.pair(bench)]

    def figures(self, bench: Bench) -> Iterator[Figure]:
        """Measure."""
        done = {words: bench.run(spec) for words, spec in self.specs(bench).items()}
        first, other = done.pop("--bus-log"), done.pop("another seed")
        for words, second in done.items():
            for name in TABLES:
                value = _digest(second.bytes_of(name))
                yield equal(f"same seed, {words} against --bus-log: {name}", value, _digest(first.bytes_of(name)))
        if pair := [bench.run(spec) for spec in self.pair(bench)]:
            for name in TABLES:
                one, two = (_digest(run.bytes_of(name)) for run in pair)
                yield equal(f"two specimens, --jobs 2 against --jobs 1: {name}", two, one)
        ours, theirs = (_digest(run.bytes_of("repeats.csv")) for run in (first, other))
        yield holds("another seed: repeats.csv", ours != theirs, theirs, f"not {ours}")
        ours_mu, theirs_mu = ([row["mu_as_measured"] for row in run.rows("repeats.csv")] for run in (first, other))
        yield holds("repeats with a coefficient", all(ours_mu) and bool(ours_mu), " ".join(ours_mu), "all")
        same = sum(a == b for a, b in zip(ours_mu, theirs_mu, strict=False))
        yield equal("another seed: repeats with the same coefficient", same, 0)

    def _recipe(self, bench: Bench) -> str:
        """Return the quickstart, shortened unless the long form is requested."""
        if bench.full:
            return "quickstart"
        if bench not in self._recipes:
            text = (recipes.FOLDER / "quickstart.yaml").read_text(encoding="utf-8")
            for longer, shorter in SHORTER:
                if longer not in text:
                    raise ProductError(f"recipes/quickstart.yaml has no {longer}")
                text = text.replace(longer, shorter)
            self._recipes[bench] = str(bench.write("shorter-quickstart.yaml", text))
        return self._recipes[bench]


def _digest(data: bytes) -> str:
    return f"{len(data)} bytes, {sha256(data).hexdigest()[:16]}"


_TRIALS = Trials()
TITLE = "same seed, same bytes, whatever the options; another seed, other repeats"
TOPIC = Topic("determinism", TITLE, _TRIALS.figures, _TRIALS.runs)
