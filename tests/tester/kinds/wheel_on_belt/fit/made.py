"""A run's record whose conditions are made up: coefficients of a law, measured beside their setpoints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from tester.analysis.flags import CARRY_OVER
from tester.analysis.results import ConditionStatus, Judgement
from tester.kinds.wheel_on_belt.fit.laws import V2_LAW
from tester.store.sql import Judged
from tests.campaigns.fit.synthetic import DESIGN
from tests.tester.analysis.series import means_of
from tests.tester.store.build import CONDITION, PIECE, RUN, SPECIMENS, open_writer, result

SPREAD = (0.99, 1.0, 1.01)
"""Of three repeats about their mean."""
LOAD_OFF_N, WARM_K = -3.0, 0.4
"""Measured minus requested load and temperature."""


def made_run(
    folder: Path,
    design: Sequence[tuple[float, float, float]] = DESIGN,
    *,
    compound: str = "1#",
    sideslip: Mapping[int, float] | None = None,
    carried: Sequence[int] = (),
    failed: Sequence[int] = (),
    alone: Sequence[int] = (),
    kind: str = RUN.kind,
    metadata: Mapping[str, str] | None = None,
) -> Path:
    """Write a finished run of conditions (degC, N, m/s), numbered from 1; return its folder.

    By number: ``sideslip`` in degrees, ``carried`` have a flag of doubt, ``failed`` no value, ``alone`` one repeat.
    """
    folder.mkdir(parents=True)
    held = [
        CONDITION.setpoint.but(compound, temperature=t, load=load, slip_velocity=slip,
                               sideslip=(sideslip or {}).get(i, 0.0))
        for i, (t, load, slip) in enumerate(design, start=1)
    ]  # fmt: skip
    conditions = [
        replace(CONDITION, condition=i, row=i, setpoint=one, repeats=1 if i in alone else len(SPREAD), min_valid=1)
        for i, one in enumerate(held, start=1)
    ]
    writer = open_writer(folder)
    writer.begin_run(replace(RUN, kind=kind, metadata=metadata or {}), SPECIMENS, conditions)
    writer.piece_mounted(PIECE)
    for i, (t, load, slip) in enumerate(design, start=1):
        at = np.array([[t + WARM_K, load + LOAD_OFF_N, slip]])
        mu = float(V2_LAW.value(np.array(V2_LAW.published[compound]), at)[0])
        means = means_of(
            force_z_n=load + LOAD_OFF_N, slip_m_s=slip, surface_c=t + WARM_K,
            wheel_speed_m_s=0.8, belt_speed_m_s=0.8 - slip,
        )  # fmt: skip
        writer.begin_condition(i, 5.0)
        for repeat, factor in enumerate((1.0,) if i in alone else SPREAD, start=1):
            if i not in failed:
                key = writer.begin_repeat(i, repeat, 1, 9.0, piece=1)
                writer.commit_repeat(key, replace(result(mu * factor), flags="", means=means))
        judged = Judged(i, Judgement(0.1, 0.1, 0.3, 0.0, 1.5, 0.2, CARRY_OVER if i in carried else ""), {})
        status = ConditionStatus.NOT_REACHED if i in failed else ConditionStatus.OK
        writer.end_condition(i, status, t_s=60.0, judged=judged)
    writer.finish("done", rig_seconds=2700.5)
    writer.close()
    return folder
