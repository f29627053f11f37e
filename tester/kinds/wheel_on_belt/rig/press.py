"""The torque limit of the press's drive (0x6072), which follows from the limit of the load.

The drive gets only the least torque that surely produces ``limits.load``. The most that this torque can produce, with
the least friction, must stay clear of harm: that caps the force whatever the load cell shows.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil
from typing import TYPE_CHECKING, Final

from tester.kinds.wheel_on_belt.rig.sections import HARMFUL_N

if TYPE_CHECKING:
    from tester.kinds.wheel_on_belt.rig.config import RigConfig

RIPPLE_N: Final = 10.0
"""Load variation from the tread's runout with the press at rest, peak to peak, N [A]: 7 to 10 N at 200 to 400 N."""


def with_torque_limit(rig: RigConfig) -> RigConfig:
    """Return a rig whose press drive has the torque for ``limits.load``, or less where the file says so.

    A press without ``screw`` keeps what the file says: nothing is known of what its torque does.
    """
    press = rig.axes.press
    if press.screw is None:
        return rig
    needed = ceil(1000.0 * press.screw.torque_nm(rig.limits.load_n) / press.rated_torque_nm)
    limited = replace(press, max_torque_per_mille=min(press.max_torque_per_mille, needed))
    return replace(rig, axes=replace(rig.axes, press=limited))


def torque_problem(rig: RigConfig) -> str:
    """Return why the limit of the press's torque does not do, or ""; the rig is one of ``with_torque_limit``."""
    press = rig.axes.press
    if press.screw is None:
        return ""
    torque_nm = 1e-3 * press.max_torque_per_mille * press.rated_torque_nm
    most_n, least_n = press.screw.pushed_n(torque_nm), press.screw.reached_n(torque_nm)
    if most_n + RIPPLE_N > HARMFUL_N:
        return (
            f"{torque_nm:.3f} N m (0x6072), which {rig.limits.load_n:g} N take with the most friction, press with"
            f" {most_n:.0f} N with the least, and {RIPPLE_N:g} N of runout make that more than {HARMFUL_N:g} N:"
            " lower limits.load, or narrow down efficiency and drag"
        )
    if least_n < rig.limits.load_n:
        return (
            f"{torque_nm:.3f} N m (max_torque_per_mille) surely press with {least_n:.0f} N only, limits.load is"
            f" {rig.limits.load_n:g} N: lower the one or raise the other"
        )
    return ""
