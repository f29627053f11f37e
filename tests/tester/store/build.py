"""Records of runs, small and made up."""

from __future__ import annotations

from dataclasses import replace
from math import isfinite
from pathlib import Path

from tester.analysis.results import Burst, ConditionStatus, Judgement, RepeatResult, RepeatStatus
from tester.kinds.wheel_on_belt.budget import TERMS
from tester.kinds.wheel_on_belt.image.axes import AXES, KIND
from tester.kinds.wheel_on_belt.image.quantities import QUANTITIES
from tester.store.recorder import Recorder
from tester.store.records import ConditionInfo, PieceInfo, RunInfo, SpecimenInfo
from tester.store.sql import Judged
from tester.store.writer import RunWriter
from tests.tester.analysis.series import means_of

RUN = RunInfo(
    name="2024-02-21T14-05-09-small",
    recipe_name="Small, two loads",
    recipe_text="recipe: Small, two loads\n",
    rig_text="wheel: {diameter: 90 mm}\n",
    started_utc="2024-02-21T14:05:09.000Z",
    simulated=True,
    kind=KIND,
    worn="wheel",
    terms=TERMS,
    axes=AXES,
    seed=1,
    software_version="0.1.0",
    operator="ada",
    metadata={"abrasive_name": "zirconia corundum", "ambient": "23 degC"},
    versions={"numpy": "1.26.0"},
)

CONDITION = ConditionInfo(
    condition=1,
    row=1,
    specimen=1,
    replicate=1,
    grid="load",
    note="NR, N234",
    setpoint=AXES.setpoint("1#", slip_velocity=0.3, load=100.0, temperature=25.0),
    temperature_band_k=2.0,
    repeats=3,
    min_valid=3,
    window_revolutions=30.0,
)

CONDITIONS = [CONDITION, replace(CONDITION, condition=2, row=2, setpoint=CONDITION.setpoint.but(load=200.0))]
SPECIMENS = [SpecimenInfo(1, "1#", "NR, N234")]
PIECE = PieceInfo(1, 1, 1, "1#", 2.0, 90.0, 89.8, 55.0, 20.0)
"""The piece of ``record``."""
BURSTS = [Burst(1, 20, 10.0, 17.0, 24.0, 26.0), Burst(2, 10, 40.0, 43.5, 24.0, 25.5)]


class Clock:
    """A wall clock that moves only on command; seconds."""

    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def utc() -> str:
    return "2024-02-21T14:06:00.000Z"


def result(mu: float = 0.73, status: RepeatStatus = RepeatStatus.VALID, reason: str = "") -> RepeatResult:
    """Return a repeat's result with figures in every field."""
    return RepeatResult(
        status=status,
        reason=reason,
        flags="extended",
        mu_resultant=mu,
        mu_longitudinal=mu,
        mu_lateral=0.0,
        uncertainty=0.002,
        fluctuation_percent=0.9,
        batches=10,
        drift_percent=-0.4,
        bound_percent=1.5,
        change_percent=0.7,
        swing_percent=6.5,
        swing_hz=4.1,
        swing_skewness=-1.8,
        revolutions=30,
        truncated=2,
        window_s=10.6,
        bursts=2,
        means=means_of(
            force_x_n=146.0,
            force_y_n=0.1,
            force_z_n=200.0,
            moment_z_nm=0.01,
            drive_torque_nm=6.5,
            wheel_speed_m_s=0.8,
            belt_speed_m_s=0.5,
            slip_m_s=0.3001,
            sideslip_deg=0.0,
            camber_deg=0.0,
            surface_c=25.1,
            hub_c=30.0,
        ),
        started_s=10.0,
        ended_s=43.5,
    )


def row(t: float, key: float = 0.0, **values: float) -> tuple[float, ...]:
    """Return a sample whose columns are all different."""
    usual = {name: 10.0 * i + 0.1 for i, name in enumerate(QUANTITIES.names)}
    usual |= {"time_s": t, "repeat_key": key, "gate": 0.0, "burst": 1.0}
    return tuple((usual | values)[name] for name in QUANTITIES.names)


def record(
    recorder: Recorder,
    condition: int,
    values: list[float],
    rows: int = 5,
    status: RepeatStatus = RepeatStatus.VALID,
    flags: str = "",
) -> None:
    """Record a condition with one repeat for each coefficient, a refused one for NaN; ``flags``: of its judgement."""
    recorder.begin_condition(condition, 5.0)
    for repeat, mu in enumerate(values, start=1):
        key = recorder.begin_repeat(condition, repeat, 1, 9.0, piece=1)
        for i in range(rows):
            recorder.sample(row(1000.0 * condition + 100.0 * repeat + 0.01 * i, float(key)))
        recorder.commit_repeat(key, result(mu, status if isfinite(mu) else RepeatStatus.REFUSED), BURSTS)
    judged = Judged(condition, Judgement(0.1, 0.1, 0.3, 0.0, 3.0, 0.2, flags), {}) if flags else None
    recorder.end_condition(condition, ConditionStatus.OK, t_s=60.0, judged=judged)


def open_writer(folder: Path, **options: bool | int) -> RunWriter:
    """Return a writer without a thread on the folder's run.db."""
    return RunWriter(
        folder / "run.db",
        QUANTITIES,
        clock=Clock(),
        utc=utc,
        synchronous=bool(options.get("synchronous", True)),
        lossless=bool(options.get("lossless", False)),
        limit=int(options["limit"]) if "limit" in options else None,
    )


_MADE: dict[str, bytes] = {}
"""Records of ``small_run``, by what is in them."""


def small_run(
    folder: Path, values: tuple[list[float], ...] = ([0.90, 0.91, 0.89], [0.73, 0.74, 0.72]), rows: int = 5
) -> Path:
    """Write a finished run of conditions 1, 2, ... with these repeats, made-up samples each; return its folder.

    Every commit waits for the disk, so an earlier folder is copied.
    """
    folder.mkdir(parents=True, exist_ok=True)
    before = _MADE.get(key := f"{values} {rows}")
    if before is not None:
        (folder / "run.db").write_bytes(before)
        return folder
    writer = open_writer(folder)
    held = CONDITION.setpoint
    conditions = [
        replace(CONDITION, condition=i, row=i, setpoint=held.but(load=100.0 * i)) for i in range(1, len(values) + 1)
    ]
    writer.begin_run(RUN, SPECIMENS, conditions)
    writer.piece_mounted(PIECE)
    for condition, repeats in zip(conditions, values, strict=True):
        record(writer, condition.condition, repeats, rows)
    writer.finish("done", rig_seconds=2700.5)
    writer.close()
    _MADE[key] = (folder / "run.db").read_bytes()
    return folder


def lacking_run(folder: Path) -> Path:
    """Write a finished run of 100 and 200 N whose first condition has one repeat, which did not fill its window."""
    folder.mkdir(parents=True, exist_ok=True)
    writer = open_writer(folder)
    writer.begin_run(RUN, SPECIMENS, CONDITIONS)
    writer.piece_mounted(PIECE)
    record(writer, 1, [0.9], status=RepeatStatus.TOO_FEW)
    record(writer, 2, [0.73, 0.74, 0.72])
    writer.finish("done", rig_seconds=2700.5)
    writer.close()
    return folder
