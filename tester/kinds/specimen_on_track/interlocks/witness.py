"""What shows that the specimen touches: friction, and where friction is too low for that, the height of the arm.

The recipe states the least coefficient that it expects (``least_friction``). Half of it may tighten ``lost_share``. A
contact whose friction may be below ``lost_share`` is not known by friction alone: the arm's height has to show it, and
friction has to be more than a deaf cell may show.
"""

from __future__ import annotations

from typing import Final

from tester.inputs.rig.parameter import NOT_NEGATIVE, SHARE, Direction, Parameter
from tester.kinds.specimen_on_track.interlocks.inputs import TrackInputs
from tester.machine.wires import answered_s

LOST_SHARE: Final = Parameter(
    "lost_share", "1", "0.05", "friction below this share of the load while it slides ... [A]", SHARE,
    direction=Direction.HIGHER, hardest="0.02",
    because="rubber on a powdered track has a tenth; a specimen holder that slides on ice has a fiftieth",
)  # fmt: skip
DEAF_N: Final = Parameter(
    "deaf_n", "N", "0.1 N", "... or below this, where the height shows contact [A]: zero 0.05 N, noise 0.02 N ...",
    direction=Direction.HIGHER, hardest="0.08 N",
    because="a deaf cell shows its zero, 0.05 N, and noise, 0.02 N",
)  # fmt: skip
HALF: Final = 0.5
"""Share of the stated least friction below which contact counts as lost [A]: friction scatters by a tenth, a track that
starts has less."""
LOW: Final = 0.9
"""Least friction of a specimen, as a share of the expected [A]: three times the scatter of specimens, 3 %, and
repeats, 2 %."""
WEAR_MM: Final = Parameter(
    "wear_mm", "mm", "0.8 mm", "the arm lower than with a new specimen by this, which wear may take ... [A]",
    NOT_NEGATIVE, hardest="1 mm",
    because="with thickness it leaves 1 mm of arm.protrusion to a lost specimen",
)  # fmt: skip
THICKNESS_MM: Final = Parameter(
    "thickness_mm", "mm", "0.5 mm",
    "... and by this, or higher by it [A]: load 0.25 mm, heat 0.1 mm, specimen, sensor ...",
    hardest="1 mm", because="with wear it leaves 1 mm of arm.protrusion to a lost specimen",
)  # fmt: skip
STALE_HEIGHT_S: Final = Parameter(
    "stale_height_s", "s", "200 ms", "age of the arm's height: four polls [A]",
    hardest="500 ms", because="at 2 m/s a bare holder grinds along 1 m",
)  # fmt: skip


def is_low(least_mu: float, lost_share: float) -> bool:
    """Return whether friction may be below ``lost_share`` by the stated least coefficient; 0: none is stated."""
    return 0.0 < LOW * least_mu < lost_share


def least_low_n(deaf_n: float, least_mu: float, load_n: float) -> float:
    """Return the least friction that counts as contact where the height shows it, N."""
    return max(deaf_n, HALF * least_mu * load_n)


def least_stated(stated: float, interface: str, lost_share: float) -> float:
    """Return the least coefficient to demand of a contact: a dry one has no film that may lower it.

    ``stated``: by the recipe, 0: nothing.
    """
    return 0.0 if interface == "dry" and is_low(stated, lost_share) else stated


def height_s(v: TrackInputs) -> float:
    """Return the age of the arm's height, s; infinite for a sensor that is silent."""
    r = v.readings
    return answered_s(r.height_silent, r.now_s, r.height_at_s)


def height_span(v: TrackInputs) -> tuple[float, float, float]:
    """Return the lowest height with a specimen on the track, the height, and the greatest, mm."""
    thick_mm = v.parameters[THICKNESS_MM]
    return -(v.parameters[WEAR_MM] + thick_mm), v.readings.height_mm, thick_mm


def shows_contact(v: TrackInputs) -> bool:
    """Return whether the arm's height is known and that of an arm whose specimen rests on the track."""
    low_mm, height_mm, high_mm = height_span(v)
    return v.limits.height and height_s(v) <= v.parameters[STALE_HEIGHT_S] and low_mm <= height_mm <= high_mm
