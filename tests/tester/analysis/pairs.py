"""Repeats of both directions with known truth: readings of a cell turned by an angle, with crosstalk."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import cos, radians, sin

from tester.analysis.directions import is_reversed
from tester.analysis.results import RepeatResult, RepeatStatus
from tests.tester.analysis.series import means_of

LOAD_N = 200.0


def shown(mu: float, repeat: int, turned_deg: float = 0.0, seen: tuple[float, float] = (0.0, 0.0)) -> RepeatResult:
    """Return the cell's reading of a repeat; ``seen``: share of the load in x, of the friction in z."""
    friction = -mu * LOAD_N if is_reversed(repeat) else mu * LOAD_N
    c, s = cos(radians(turned_deg)), sin(radians(turned_deg))
    along, normal = friction * c + LOAD_N * s, LOAD_N * c - friction * s
    along, normal = along + seen[0] * normal, normal + seen[1] * along
    belt = 1.1 if is_reversed(repeat) else 0.5
    means = means_of(force_x_n=along, force_y_n=0.0, force_z_n=normal, slip_m_s=0.3, surface_c=25.0,
                     wheel_speed_m_s=0.8, belt_speed_m_s=belt)  # fmt: skip
    return RepeatResult(
        RepeatStatus.VALID, mu_resultant=abs(along) / normal, mu_longitudinal=along / normal, mu_lateral=0.0,
        uncertainty=0.001, fluctuation_percent=0.5, batches=10, drift_percent=0.1, bound_percent=0.5, revolutions=45,
        window_s=15.9, bursts=3, means=means, started_s=100.0 * repeat, ended_s=100.0 * repeat + 16.0,
    )  # fmt: skip


def series(
    values: Sequence[float], turned_deg: float = 0.0, seen: tuple[float, float] = (0.0, 0.0)
) -> list[RepeatResult]:
    """Return repeats with these true coefficients, in the order in which they are made."""
    return [shown(mu, repeat, turned_deg, seen) for repeat, mu in enumerate(values, start=1)]


def refused(one: RepeatResult) -> RepeatResult:
    """Return a repeat refused for its drift."""
    return replace(one, status=RepeatStatus.REFUSED, reason="drifts by +4.0 % a window", drift_percent=4.0)
