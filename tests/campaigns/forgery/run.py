"""Two short runs on the simulated rig with everything that the forgeries need: a trip, a wear check, two exclusions."""

from __future__ import annotations

from pathlib import Path

from tester.analysis.wear_rate import WearCheck
from tester.base import clock
from tester.cli.console import Console
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results.exclude import Word, record_word
from tester.results.run_files import write_all
from tester.run.session import Session
from tester.run.session_options import SessionOptions
from tester.store.writer import RunWriter
from tests.tester.kinds.wheel_on_belt.bench import QUIET, SHORT


def finished_run(home: Path, seed: int) -> Path:
    """Measure and record; return the run's folder."""
    home.mkdir(parents=True)
    recipe = home / "short.yaml"
    recipe.write_text(SHORT.replace("repeats: 1", "repeats: 3"), encoding="utf-8")
    options = SessionOptions(recipe=str(recipe), out=home / "runs", overrides=QUIET, seed=seed, operator="ada")
    Session(options, Console(as_json=True, answer_yes=True)).run()
    folder = next(path for path in (home / "runs").iterdir() if (path / "run.db").is_file())
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=clock.monotonic, utc=clock.utc_now, synchronous=True)
    writer.trip_acknowledged(writer.trip(50.0, "overload", "460 N", 460.0, 450.0), 60.0, "ada")
    figures = (89.9, 0.01, 25.0, 0.001, 12.0, 50.0, 10.0, 2e3, 18.0, 5.0)  # diameter to rate, in the fields' order
    writer.wear_check(WearCheck(1, "roll", 40.0, 40.0, 0, 1, *figures, 1))
    writer.close()
    write_all(folder)
    record_word(folder, Word(1, 1, True, "dust on the belt", "ada"))
    record_word(folder, Word(1, 1, False, "it was none", "ben"))
    return folder
