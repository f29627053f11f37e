"""The tables as files."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable
from dataclasses import replace
from hashlib import sha256
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from tester.analysis.results import RepeatStatus
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.results.measured_tables import checks_table, pieces_table, repeats_table
from tester.results.repeated_tables import settings_table
from tester.results.run_files import manifest_problems, write_all, write_file
from tester.results.run_results import results_of
from tester.store.records import PieceInfo
from tester.store.run_reader import RunReader
from tests.tester.results.made import made
from tests.tester.store.build import CONDITION, RUN, SPECIMENS, Clock, open_writer, record, result, row, small_run

HEADER = "Formula,Slip Velocity /mm·s⁻¹,Load /N,Sideslip Angle /°,Temperature /°C,Friction Coefficient"


def table(data: bytes) -> list[dict[str, str]]:
    text = data.decode("utf-8-sig")
    return list(csv.DictReader(io.StringIO(text, newline="")))


def tables(folder: Path) -> tuple[list[dict[str, str]], list[dict[str, str]], list[dict[str, str]]]:
    with RunReader(folder) as reader:
        return table(made("appendix", reader)), table(made("conditions", reader)), table(made("repeats", reader))


def test_the_appendix_is_the_papers_table(tmp_path: Path) -> None:
    write_all(small_run(tmp_path))
    data = (tmp_path / "appendix.csv").read_bytes()
    assert data.startswith(b"\xef\xbb\xbf")
    assert data.decode("utf-8-sig") == f"{HEADER}\n1#,300,100,0,25,0.90\n1#,300,200,0,25,0.73\n"


def test_the_appendix_has_as_many_decimals_as_asked(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        lines = table(made("appendix", reader, 4))
    assert [line["Friction Coefficient"] for line in lines] == ["0.9000", "0.7300"]


def test_a_condition_without_a_value_is_not_in_the_appendix_but_returned(tmp_path: Path) -> None:
    missing = write_all(small_run(tmp_path, ([], [0.73, 0.74, 0.72])))
    appendix, conditions, _ = tables(tmp_path)
    assert [line["Load /N"] for line in appendix] == ["200"]
    assert [missed.info.setpoint.value("load") for missed in missing] == [100.0]
    assert [line["status"] for line in conditions] == ["insufficient", "ok"]
    assert conditions[0]["reason"] == "none of 0 repeats is valid"


def test_conditions_carry_setpoints_means_scatter_and_metadata(tmp_path: Path) -> None:
    line = tables(small_run(tmp_path))[1][1]
    assert (line["compound"], line["slip_velocity_mm_s"], line["load_n"], line["wheel_speed_m_s"]) == (
        "1#",
        "300",
        "200",
        "0.8",
    )
    assert float(line["mu"]) == pytest.approx(0.73)
    assert float(line["s"]) == pytest.approx(0.01)
    assert (line["valid"], line["asked"]) == ("3", "3")
    assert float(line["u_expanded"]) > float(line["u_standard"]) > float(line["u_type_a"]) > 0
    assert float(line["measured_slip_mm_s"]) == pytest.approx(300.1)
    assert float(line["measured_surface_c"]) == pytest.approx(25.1)
    assert (line["abrasive_name"], line["ambient"]) == ("zirconia corundum", "23 degC")


def test_repeats_carry_forces_window_and_drift(tmp_path: Path) -> None:
    lines = tables(small_run(tmp_path))[2]
    assert [(line["condition"], line["repeat"], line["attempt"]) for line in lines[:4]] == [
        ("1", "1", "1"),
        ("1", "2", "1"),
        ("1", "3", "1"),
        ("2", "1", "1"),
    ]
    line = lines[3]
    assert (line["measured_force_z_n"], line["measured_drive_torque_nm"], line["measured_moment_z_nm"]) == (
        "200",
        "6.5",
        "0.01",
    )
    assert (line["revolutions"], line["bursts"], line["drift_percent"]) == ("30", "2", "-0.4")
    assert line["flags"] == "extended"
    assert (line["in_mean"], line["exclusion"]) == ("1", "")


def test_a_repeat_that_is_left_out_shows_it(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    record(writer, 1, [0.7, 0.7])
    writer.commit_repeat(writer.begin_repeat(1, 3, 1), result(0.9, RepeatStatus.REFUSED, "drift +4 %"))
    writer.close()
    line = tables(tmp_path)[2][2]
    assert (line["in_mean"], line["exclusion"]) == ("0", "refused: drift +4 %")


def test_replicates_have_a_row_each_and_a_combined_one(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    conditions = [replace(CONDITION, condition=i, replicate=i) for i in (1, 2)]
    writer.begin_run(RUN, SPECIMENS, conditions)
    for condition, mu in zip(conditions, (0.70, 0.72), strict=True):
        record(writer, condition.condition, [mu] * 3)
    writer.close()
    appendix, lines, _ = tables(tmp_path)
    assert [(line["level"], line["replicate"], line["mu"]) for line in lines] == [
        ("condition", "1", "0.7"),
        ("condition", "2", "0.72"),
        ("combined", "", "0.71"),
    ]
    assert [line["Friction Coefficient"] for line in appendix] == ["0.71"]


def test_text_of_the_recipe_reaches_no_formula(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    held = CONDITION.setpoint.but("=cmd|' /C calc'!A0")
    evil = replace(CONDITION, setpoint=held, note='+1, "two"\nthree', grid="@x")
    run = replace(RUN, metadata={"=key": "-2+3", "load_n": "mine"})
    writer.begin_run(run, SPECIMENS, [evil])
    record(writer, 1, [0.7] * 3)
    writer.close()
    appendix, (line,), _ = tables(tmp_path)
    assert appendix[0]["Formula"] == "'=cmd|' /C calc'!A0"
    assert (line["note"], line["grid"]) == ('\'+1, "two"\nthree', "'@x")
    assert (line["'=key"], line["recipe_load_n"], line["load_n"]) == ("'-2+3", "mine", "100")


def test_the_same_data_gives_the_same_bytes_whenever_and_wherever(tmp_path: Path) -> None:
    names = ("appendix.csv", "budget.csv", "conditions.csv", "repeats.csv")
    for folder, started in (("a", "2024-02-21T14:05:09.000Z"), ("b", "2031-01-01T00:00:00.000Z")):
        (tmp_path / folder).mkdir()
        writer = open_writer(tmp_path / folder)
        run = replace(RUN, name=folder, started_utc=started, software_version=folder, operator=folder)
        writer.begin_run(run, SPECIMENS, [CONDITION])
        record(writer, 1, [0.7, 0.71, 0.72])
        writer.finish("finished", ended_utc=started)
        writer.close()
        write_all(tmp_path / folder)
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_the_conditions_of_a_real_rig_end_with_the_head_of_the_record(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(replace(RUN, simulated=False), SPECIMENS, [CONDITION])
    record(writer, 1, [0.7, 0.71, 0.72])
    writer.close()
    with RunReader(tmp_path) as reader:
        head = reader.record_head()
    _, (line,), _ = tables(tmp_path)
    assert len(head) == 64 and list(line.items())[-1] == ("record_head", head)


def test_those_of_a_simulated_rig_leave_it_empty_for_the_same_seed_gives_the_same_bytes(tmp_path: Path) -> None:
    _, (line, _), _ = tables(small_run(tmp_path))
    assert line["record_head"] == ""


def test_an_accepted_risk_is_in_every_row_of_every_table(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    risk = {"accepted_risk": "trial of a new cell", "loose_safety_keys": "limits.load 480 N is looser than 450 N"}
    writer.begin_run(replace(RUN, metadata=risk), SPECIMENS, [CONDITION])
    writer.piece_mounted(PieceInfo(1, 1, 1, "1#", 60.0, 90.0, 85.0, 812.0))
    record(writer, 1, [0.7, 0.71, 0.72])
    writer.close()
    with RunReader(tmp_path) as reader:
        said = reader.run().info.risk
        found = [table(made(kind, reader)) for kind in ("appendix", "repeats", "wheel", "samples")]
        (condition,) = table(made("conditions", reader))
    assert "trial of a new cell" in said and "480 N" in said
    assert all(lines and all(line["accepted_risk"] == said for line in lines) for lines in found)
    assert (condition["accepted_risk"], condition["loose_safety_keys"]) == tuple(risk.values())
    with RunReader(tmp_path) as reader:
        (tmp_path / "samples.parquet").write_bytes(made("parquet", reader))
    assert set(pq.read_table(tmp_path / "samples.parquet")["accepted_risk"].to_pylist()) == {said}


def test_samples_have_every_column_and_their_repeat(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        lines = table(made("samples", reader))
    assert tuple(lines[0]) == (*QUANTITIES.names, "condition", "repeat", "attempt")
    assert len(lines) == 30
    assert [lines[0][name] for name in ("time_s", "gate", "burst", "repeat_key")] == ["1100.0", "0", "1", "1"]
    assert (lines[-1]["condition"], lines[-1]["repeat"], lines[-1]["attempt"]) == ("2", "3", "1")


def test_samples_of_no_repeat_have_no_condition_and_missing_values_are_empty(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    writer.sample(row(1.0, 0.0, surface_c=float("nan")))
    writer.close()
    with RunReader(tmp_path) as reader:
        (line,) = table(made("samples", reader))
    assert (line["condition"], line["surface_c"], line["repeat_key"]) == ("", "", "0")


def test_parquet_holds_the_same_samples(tmp_path: Path) -> None:
    path = tmp_path / "samples.parquet"
    with RunReader(small_run(tmp_path / "run")) as reader:
        path.write_bytes(made("parquet", reader))
        lines = table(made("samples", reader))
    read = pq.read_table(path)
    assert read.column_names == list(lines[0])
    assert read["force_x_n"].to_pylist() == [float(line["force_x_n"]) for line in lines]
    assert read["repeat"].to_pylist() == [int(line["repeat"]) for line in lines]
    assert str(read.schema.field("gate").type) == "int64"


def test_parquet_of_many_samples_comes_in_row_groups(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    for i in range(70_000):
        writer.sample(row(0.01 * i))
    writer.close()
    with RunReader(tmp_path) as reader:
        (tmp_path / "s.parquet").write_bytes(made("parquet", reader))
    file = pq.ParquetFile(tmp_path / "s.parquet")
    assert (file.num_row_groups, file.metadata.num_rows) == (2, 70_000)
    assert file.read(columns=["condition"])["condition"].null_count == 70_000


def test_a_run_without_samples_exports_an_empty_parquet_file(tmp_path: Path) -> None:
    writer = open_writer(tmp_path)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    writer.close()
    with RunReader(tmp_path) as reader:
        (tmp_path / "s.parquet").write_bytes(made("parquet", reader))
    assert pq.read_table(tmp_path / "s.parquet").num_rows == 0


def test_the_manifest_lists_every_file_with_its_hash(tmp_path: Path) -> None:
    small_run(tmp_path)
    (tmp_path / "recipe.yaml").write_text("recipe: x\n", "utf-8")
    write_all(tmp_path)
    files = json.loads((tmp_path / "manifest.json").read_text("utf-8"))["files"]
    tables = ["appendix.csv", "budget.csv", "conditions.csv"]
    assert sorted(files) == [*tables, "recipe.yaml", "repeats.csv", "run.db", "wheel.csv"]
    assert files["recipe.yaml"] == {"bytes": 10, "sha256": sha256(b"recipe: x\n").hexdigest()}
    assert manifest_problems(tmp_path) == []


def test_a_changed_missing_or_added_file_shows(tmp_path: Path) -> None:
    write_all(small_run(tmp_path))
    (tmp_path / "appendix.csv").write_text("0.99", "utf-8")
    (tmp_path / "repeats.csv").unlink()
    (tmp_path / "extra").touch()
    assert manifest_problems(tmp_path) == [
        "repeats.csv: missing",
        "appendix.csv: changed",
        "extra: not in the manifest",
    ]


def test_a_file_is_written_whole_or_not_at_all(tmp_path: Path) -> None:
    def chunks() -> Iterable[bytes]:
        yield b"half"
        raise OSError("disk full")

    target = tmp_path / "t.csv"
    target.write_bytes(b"old")
    with pytest.raises(OSError, match="full"):
        write_file(target, chunks())
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["t.csv"]


def test_an_unfinished_run_can_be_exported_while_it_is_written(tmp_path: Path) -> None:
    from tester.store.writer import RunWriter

    writer = RunWriter(tmp_path / "run.db", QUANTITIES, clock=Clock(), synchronous=True)
    writer.begin_run(RUN, SPECIMENS, [CONDITION])
    record(writer, 1, [0.7, 0.7, 0.7])
    assert len(tables(tmp_path)[0]) == 1
    writer.close()


def test_no_table_has_two_columns_of_one_key_where_specimens_wear(tmp_path: Path) -> None:
    with RunReader(small_run(tmp_path)) as reader:
        found = results_of(reader)
    results = replace(found, run=replace(found.run, info=replace(found.run.info, worn="specimen")))
    tables = (pieces_table, checks_table, repeats_table, settings_table)
    keys = [[column.key for column in table_of(results).columns] for table_of in tables]
    assert [len(listed) for listed in keys] == [len(set(listed)) for listed in keys]
    assert "piece" in keys[0] and "specimen" in keys[0]
