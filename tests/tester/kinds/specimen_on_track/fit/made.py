"""A run's record of a specimen on a track whose conditions are made up: coefficients of its law, with scatter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import exp
from pathlib import Path

import numpy as np

from sim.physics.wlf import WlfBell, WlfBellParameters
from tester.analysis.flags import CARRY_OVER
from tester.analysis.results import ConditionStatus, Judgement, RepeatResult, RepeatStatus
from tester.base.quantities import Means
from tester.inputs.rig import packaged
from tester.kinds.specimen_on_track import KIND
from tester.kinds.specimen_on_track.axes import AXES
from tester.kinds.specimen_on_track.budget import TERMS
from tester.kinds.specimen_on_track.quantities import QUANTITIES
from tester.store.records import ConditionInfo, PieceInfo, RunInfo, SpecimenInfo
from tester.store.sql import Judged
from tester.store.writer import RunWriter

SPEEDS_M_S = tuple(10.0 ** (-6.0 + 0.5 * i) for i in range(9))
TEMPERATURES_C = tuple(-40.0 + 10.0 * i for i in range(11))
WARM_K = 0.3
"""Measured minus requested temperature."""
_SBR = WlfBell(WlfBellParameters())


def law(temperature_c: float, speed_m_s: float) -> float:
    """Return the coefficient of the simulated rig's SBR."""
    return _SBR.mu(temperature_c, 20.0, speed_m_s)


def made_track_run(
    folder: Path,
    temperatures_c: Sequence[float] = TEMPERATURES_C,
    speeds_m_s: Sequence[float] = SPEEDS_M_S,
    mu: Callable[[float, float], float] = law,
    *,
    scatter: float = 0.02,
    seed: int = 0,
    load_n: float = 20.0,
    interfaces: Sequence[str] = ("dry",),
    compounds: Sequence[str] = ("SBR",),
    repeats: int = 1,
    carried: Sequence[int] = (),
    failed: Sequence[int] = (),
    band_k: float = 1.0,
    metadata: Mapping[str, str] | None = None,
    law_name: str = "wlf_bell",
) -> Path:
    """Write a finished run of conditions, numbered from 1 in order of compound, interface, temperature and speed.

    ``scatter``: standard deviation of ln mu of a repeat. By number: ``carried`` have a flag of doubt, ``failed`` no
    value. ``law_name``: name of the law of friction in the rig file. Returns its folder.
    """
    folder.mkdir(parents=True)
    random = np.random.default_rng(seed)
    design = [(c, i, t, v) for c in compounds for i in interfaces for t in temperatures_c for v in speeds_m_s]
    conditions = [
        ConditionInfo(
            condition=n, row=n, specimen=1 + compounds.index(c), replicate=1, grid="master", note="",
            setpoint=AXES.setpoint(c, track_speed=v, load=load_n, temperature=t, interface=i),
            temperature_band_k=band_k, repeats=repeats, min_valid=1, window_revolutions=10.0,
        )
        for n, (c, i, t, v) in enumerate(design, start=1)
    ]  # fmt: skip
    rig = packaged.packaged_text(KIND.rig(), "grosch").replace("law: two_bells", f"law: {law_name}")
    assert f"law: {law_name}" in rig
    info = RunInfo(
        name=folder.name, recipe_name="master", recipe_text="recipe: master\n", rig_text=rig,
        started_utc="2024-02-21T14:05:09.000Z", simulated=True, kind=KIND.name, worn="specimen", terms=TERMS,
        axes=AXES, metadata=metadata or {},
    )  # fmt: skip
    writer = RunWriter(folder / "run.db", QUANTITIES, clock=lambda: 100.0, utc=lambda: "2024-02-21T14:06:00.000Z")
    writer.begin_run(info, [SpecimenInfo(n, c, "") for n, c in enumerate(compounds, start=1)], conditions)
    writer.piece_mounted(PieceInfo(1, 1, 1, compounds[0], 2.0, 0.0, 0.0, 0.0, 0.0))
    for n, (_, _, t, v) in enumerate(design, start=1):
        writer.begin_condition(n, 5.0)
        for repeat in range(1, repeats + 1):
            value = mu(t + WARM_K, v) * exp(scatter * random.standard_normal())
            if n not in failed:
                key = writer.begin_repeat(n, repeat, 1, 9.0, piece=1)
                writer.commit_repeat(key, _result(value, t + WARM_K, v, load_n))
        judged = Judged(n, Judgement(0.1, 0.1, 0.3, 0.0, 1.5, 0.2, CARRY_OVER if n in carried else ""), {})
        writer.end_condition(
            n, ConditionStatus.NOT_REACHED if n in failed else ConditionStatus.OK, t_s=60.0, judged=judged
        )
    writer.finish("done", rig_seconds=2700.5)
    writer.close()
    return folder


def _result(mu: float, temperature_c: float, speed_m_s: float, load_n: float) -> RepeatResult:
    given = {"friction_n": mu * load_n, "load_n": load_n, "sliding_m_s": speed_m_s, "air_c": temperature_c}
    given["contact_c"] = temperature_c
    return RepeatResult(
        status=RepeatStatus.VALID, reason="", flags="", mu_resultant=mu, mu_longitudinal=mu, mu_lateral=0.0,
        uncertainty=0.002, fluctuation_percent=0.9, batches=10, drift_percent=-0.4, bound_percent=1.5, revolutions=15,
        truncated=0, window_s=10.6, bursts=2, started_s=10.0, ended_s=43.5,
        means=Means(QUANTITIES, [given.get(one.name, float("nan")) for one in QUANTITIES.averaged]),
    )  # fmt: skip
