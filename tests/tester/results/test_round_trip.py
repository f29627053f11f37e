"""Exports read back as the original text, for any text in any field, or the text was refused with its place."""

from __future__ import annotations

import csv
import io
import json
import re
import shutil
import subprocess
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

from tester.base.source import InvalidSource
from tester.inputs.recipe.loader import load_checked
from tester.inputs.recipe.plan import Plan
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.kinds.wheel_on_belt.recipe.expand import expand
from tester.kinds.wheel_on_belt.recipe.part import PART
from tester.machine.result_keeping import condition_records
from tester.store.records import SpecimenInfo
from tester.store.run_reader import RunReader
from tester.store.writer import RunWriter
from tests.tester.inputs.recipe.texts import real_rig
from tests.tester.results.made import made, unescaped
from tests.tester.store.build import RUN, Clock, result, row, small_run

SEEDS = (
    "1#", "NR, N234", '=cmd|"/C calc"!A0', "+1", "-1+1", "@SUM(A1)", "\tx", "'quoted", '"', '""', "a\nb", "a\r\nb",
    ",", ";", "\u202e\u2066bidi", "\u0000", "\x1b[2J", "\ufeff", "é", "ﬁ", "𝒳", "＝1", "NaN", "null", "TRUE", "1e5",
    " lead", "trail ", "%s{}", "../..", "<b>", "|", "#", "- x", "{a: b}", "&a", "*a", "!!python/object", "''", "\\",
    "\u2028", "",
)  # fmt: skip
BATCH = 100
"""Texts for one run."""
FIELDS = ("recipe", "compound", "note", "grid", "abrasive", "abrasive_id", "experiment")
REFUSED = re.compile(r"^<text>:\d+:\d+: ")


def mutated(random: Random) -> str:
    """Return a text made of pieces of the seeds: cut, joined, repeated, with a character put in."""
    parts = [random.choice(SEEDS) for _ in range(random.randrange(1, 4))]
    text = "".join(part[random.randrange(len(part) + 1) :] if random.random() < 0.3 else part for part in parts)
    if random.random() < 0.3:
        at = random.randrange(len(text) + 1)
        code = random.choice((0x22, 0x27, 0x2C, 0x0A, 0x0D, 0x3D, random.randrange(0x2FFF)))
        text = text[:at] + chr(code) + text[at:]
    return text


def recipe_text(field: str, text: str) -> str:
    """Return a recipe with a text in one field, written as YAML's double-quoted scalar (JSON's is one)."""
    value = {name: json.dumps("x") for name in FIELDS} | {field: json.dumps(text)}
    return (
        f"recipe: {value['recipe']}\n"
        f"specimens:\n  - compound: {value['compound']}\n    note: {value['note']}\n"
        f"abrasive: {{name: {value['abrasive']}, id: {value['abrasive_id']}}}\n"
        f"experiment: {{batch: {value['experiment']}}}\n"
        "measure:\n  wheel_speed: 0.8 m/s\n  repeats: 3\n"
        f"grids:\n  - name: {value['grid']}\n    slip_velocity: 300 mm/s\n    load: 100 N\n    temperature: 25 degC\n"
    )


def plan_with(field: str, text: str) -> Plan | None:
    """Return the plan of such a recipe, None where it was refused with its place."""
    rig = real_rig()
    try:
        return expand(load_checked(recipe_text(field, text), rig, PART).recipe, rig)
    except InvalidSource as refused:
        assert refused.problems and all(REFUSED.match(str(problem)) for problem in refused.problems), text
        return None


def exported(folder: Path, plans: Sequence[Plan]) -> dict[str, str]:
    """Return the exports of a run that holds the conditions and the metadata of these plans, by name, as texts."""
    folder.mkdir()
    metadata = {f"{key}.{i}": value for i, plan in enumerate(plans) for key, value in plan.metadata.items()}
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=Clock(), synchronous=True)
    records = [replace(one, condition=i, row=i) for i, plan in enumerate(plans) for one in condition_records(plan)]
    writer.begin_run(replace(RUN, metadata=metadata), [SpecimenInfo(1, "x", "")], records)
    for one in records:
        writer.commit_repeat(writer.begin_repeat(one.condition, 1, 1), result())
    writer.close()
    with RunReader(folder) as reader:
        return {kind: made(kind, reader).decode() for kind in ("conditions", "repeats")}


def meant(plans: Sequence[Plan], number: int) -> dict[str, str]:
    """Return the texts expected from an export's row of a plan, by column."""
    (condition,) = condition_records(plans[number])
    own = {"compound": condition.compound, "note": condition.note, "grid": condition.grid}
    return own | {f"{key}.{number}": value for key, value in plans[number].metadata.items()}


def with_csv(text: str) -> list[dict[str, str]]:
    header, *rows = csv.reader(io.StringIO(text, newline=""), strict=True)
    return [dict(zip(header, cells, strict=True)) for cells in rows]


def with_pandas(text: str) -> list[dict[str, str]]:
    import pandas

    frame = pandas.read_csv(io.StringIO(text, newline=""), dtype=str, keep_default_na=False)
    names = [str(name) for name in frame.columns]
    return [dict(zip(names, map(str, cells), strict=True)) for cells in frame.itertuples(index=False, name=None)]


def check_batch(folder: Path, plans: Sequence[Plan]) -> None:
    """Compare every text of these plans with the exports as two readers read them."""
    for name, table in exported(folder, plans).items():
        for read in (with_csv, with_pandas):
            rows = read(table)
            assert len(rows) == len(plans), (name, read.__name__)
            for number, cells in enumerate(rows):
                for column, value in meant(plans, number).items():
                    if name == "conditions" or column in ("compound", "note", "grid"):
                        assert unescaped(cells[column]) == value, (name, read.__name__, column, value)
                        assert not cells[column].startswith(("=", "+", "-", "@", "\t", "\r")), (name, column, value)


def check_texts(folder: Path, count: int, seed: int) -> tuple[int, int]:
    """Put mutated texts into every field in turn; return how many came back and how many were refused."""
    random = Random(seed)
    back = refused = 0
    batch: list[Plan] = []
    for number in range(count):
        field, text = FIELDS[number % len(FIELDS)], mutated(random)
        plan = plan_with(field, text)
        if plan is None:
            refused += 1
        else:
            # Exactly what was written: blanks, quotes and line ends included.
            assert field == "recipe" or text in meant([plan], 0).values(), (field, text)
            batch.append(plan)
        if batch and (len(batch) == BATCH or number == count - 1):
            check_batch(folder / str(number), batch)
            back += len(batch)
            batch = []
    return back, refused


def test_every_text_reads_back_or_is_refused_with_its_place(tmp_path: Path) -> None:
    back, refused = check_texts(tmp_path, 300, seed=1)
    assert back > 50 and refused > 50


@pytest.mark.campaign
def test_ten_thousand_texts_read_back_or_are_refused_with_their_place(tmp_path: Path) -> None:
    back, refused = check_texts(tmp_path, 10_000, seed=2)
    assert back + refused == 10_000 and back > 2000


@pytest.mark.parametrize("text", SEEDS)
def test_every_seed_in_the_note(tmp_path: Path, text: str) -> None:
    plan = plan_with("note", text)
    if plan is not None:
        for table in exported(tmp_path / "run", [plan]).values():
            assert unescaped(with_csv(table)[0]["note"]) == text


def test_numbers_are_numbers_for_pandas(tmp_path: Path) -> None:
    import pandas

    from tester.results.run_files import write_all

    folder = small_run(tmp_path / "run")
    write_all(folder)
    frame = pandas.read_csv(folder / "repeats.csv")
    assert str(frame["mu_as_measured"].dtype) == "float64" and frame["mu_as_measured"].iloc[0] == 0.9
    assert str(frame["load_n"].dtype) == "int64" and next(iter(frame["measured_force_z_n"])) == 200


def test_samples_read_back_bit_by_bit_from_csv_and_parquet(tmp_path: Path) -> None:
    import pandas

    folder = tmp_path
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=Clock(), synchronous=True)
    writer.begin_run(RUN, [], [])
    fed = [row(0.1 * i, 0.0, force_x_n=1.0 / 3.0 * i) for i in range(700)]
    for one in fed:
        writer.sample(one)
    writer.close()
    with RunReader(folder) as reader:
        (folder / "s.csv").write_bytes(made("samples", reader))
        (folder / "s.parquet").write_bytes(made("parquet", reader))
    for frame in (pandas.read_csv(folder / "s.csv"), pandas.read_parquet(folder / "s.parquet")):
        assert list(frame["force_x_n"]) == [one[7] for one in fed]
        assert list(frame["time_s"]) == [one[0] for one in fed]


def test_libreoffice_shows_the_original_text(tmp_path: Path) -> None:
    office = shutil.which("soffice") or shutil.which("libreoffice")
    if office is None:
        pytest.skip("LibreOffice is not installed")
    plan = plan_with("note", "=1+1")
    assert plan is not None
    tables = exported(tmp_path / "run", [plan])
    (tmp_path / "conditions.csv").write_text(tables["conditions"], encoding="utf-8")
    command = [office, "--headless", "--convert-to", "csv:Text - txt - csv (StarCalc):44,34,76", "--outdir", "out"]
    subprocess.run([*command, "conditions.csv"], cwd=tmp_path, check=True, timeout=120, capture_output=True)
    assert unescaped(with_csv((tmp_path / "out" / "conditions.csv").read_text("utf-8"))[0]["note"]) == "=1+1"
