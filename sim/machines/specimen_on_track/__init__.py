"""A rubber specimen on a moving track: a block on a slow linear track in a chamber, or a pin on a disc."""

from __future__ import annotations

from typing import TYPE_CHECKING

from sim.hands import REPEAT, SPECIMEN, TEXT, Argument, Verb
from sim.machines import SimulatedMachine
from sim.machines.specimen_on_track.rig import TrackRig

if TYPE_CHECKING:
    from sim.faults.language import FaultLanguage
    from sim.rig import RigSpec

LOG_COLUMNS = ("track_m_s", "lift_mm", "load_n", "force_n", "slip_m_s", "slid_m", "specimen_c", "air_c")
"""The plant's true values."""
LOG_DECIMALS = (9, 4, 3, 4, 9, 9, 3, 3)


def log_row(rig: TrackRig) -> tuple[float, ...]:
    """Return a value for each of LOG_COLUMNS."""
    p = rig.plant
    return rig.track_m_s, rig.lift_mm, p.load_n, p.force_n, p.slip_m_s, p.slid_m, p.specimen_c, p.air_c


def _language(spec: RigSpec) -> FaultLanguage:
    from sim.faults.common import with_sensors
    from sim.machines.specimen_on_track.faults import LANGUAGE

    return with_sensors(LANGUAGE, spec)


VERBS = (
    SPECIMEN,
    Verb("same", "keep", "put it back, unless it is on the arm already", SPECIMEN.arguments),
    Verb("hang", "put_on", "hang weights on the arm, in place of those on it", (Argument("weights_n", "N"),)),
    Verb("cover", "cover", "cover the track with a surface, clean and dry", (Argument("surface", TEXT),)),
    Verb("track", "prepare", "dry, wet or powder the track", (Argument("interface", "dry|wet|talc"),)),
    Verb("raise", "raise_arm", "raise an arm that has no drive"),
    Verb("lower", "lower_arm", "lower an arm that has no drive"),
    REPEAT,
)

MACHINE = SimulatedMachine(TrackRig, _language, LOG_COLUMNS, log_row, LOG_DECIMALS, VERBS)
