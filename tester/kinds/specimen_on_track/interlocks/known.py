"""What is known to stand: what is old or unknown does not. Several rows ask for it, and for these parameters."""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import SHARE, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs

STANDING_SHARE: Final = Parameter(
    "standing_share", "1", "0.0005", "a track slower than this share of axes.track.max_speed stands [A]", SHARE,
    hardest="0.001", because="a thousandth of the greatest speed counts as motion where everything must stand",
)  # fmt: skip
SPEEDS_OLD_S: Final = Parameter(
    "speeds_old_s", "s", "500 ms", "a stop does not end on a speed older than this [A]",
    hardest="1 s",
    because="the next step of a stop that does not work begins half a second after it: by then it must be known",
)  # fmt: skip


def standing_m_s(v: TrackInputs) -> float:
    """Return the speed below which the track stands, m/s."""
    return v.parameters[STANDING_SHARE] * v.limits.fastest_m_s


def standing(v: TrackInputs) -> bool:
    """Tell whether the track is known to stand."""
    r, slow = v.readings, standing_m_s(v)
    return r.track_at_s >= r.now_s - v.parameters[SPEEDS_OLD_S] and -slow < r.track_now_m_s < slow
