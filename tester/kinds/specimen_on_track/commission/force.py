"""The friction force by weights that pull the arm over a pulley, in the direction of the track and against it."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig import Rig
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.commission.commission_step import Notes
from tester.machine.commission.hung_channel import HungWay
from tester.machine.commission.hung_weights import CellPlan, HungCell, tell_calibration

STILL_N: Final = 0.02
"""A weight hangs still within this, N [A]: 0.2 % of the least weight."""


def _most_n(rig: Rig) -> float:
    return TrackConfig.of(rig).limits.force_n


def _zero_n(rig: Rig) -> float:
    return TrackConfig.of(rig).arming.unloaded_n


def _conclude(notes: Notes, hung: HungCell) -> None:
    tell_calibration(notes, hung.due)


PLAN: Final = CellPlan(
    ("force",),
    (
        HungWay("forward", "force forward", 0, (10.0, 20.0, 50.0, 100.0, 20.0),
                how=" over a pulley, arm raised, so that it pulls the way in which the track drags the specimen"),
        HungWay("back", "force backward", 0, (20.0, 50.0, 20.0), -1.0,
                how=" over a pulley on the other side, against the track", optional=True),
    ),
    _most_n, _conclude, STILL_N, _zero_n,
)  # fmt: skip
