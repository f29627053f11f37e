"""The paper's way of fitting Eq 6: one factor after the other, each from the few conditions that vary it alone.

Load by a power law (Eq 1 with the load alone), speed by c v^b2 + a2, both at 25 degC; then the temperature's factor
from the coefficient over that at 25 degC. This reproduces Table 3's b2 and a2 of 3# and b1 of 2# to the last digit; its
results for 1# and 2# over speed depend on two illegible rows. The load's power applies to the whole coefficient, but
Eq 6 applies it to the speed term alone: this causes its errors at 100 and 400 N.
"""

from __future__ import annotations

from collections.abc import Sequence

from sim.physics.friction import V2_LOAD_N, V2_SLIP_M_S, V2_TEMPERATURE_C, PaperParameters
from tester.analysis.fit.fit_law import FitPoint, by_group
from tester.analysis.fit.solve import least_squares_of
from tester.base.arrays import Array
from tester.kinds.wheel_on_belt.fit.laws import LOAD, SLIP, TEMPERATURE, joint_of

_REFERENCE = (V2_TEMPERATURE_C, V2_LOAD_N, V2_SLIP_M_S)


def staged(points: Sequence[FitPoint]) -> dict[str, tuple[float, ...]]:
    """Return the parameters of each compound in the normalised form; raises MissingExtraError."""
    return {compound: joint_of(parameters) for compound, parameters in staged_table_3(points).items()}


def staged_table_3(points: Sequence[FitPoint]) -> dict[str, PaperParameters]:
    """Return the parameters of each compound in Table 3's form; raises MissingExtraError."""
    return {compound: _staged(compound_points) for compound, compound_points in by_group(points).items()}


def _staged(points: Sequence[FitPoint]) -> PaperParameters:
    import numpy as np

    loads, mu_of_load = _varied(points, LOAD)
    slips, mu_of_slip = _varied(points, SLIP)
    temperatures, mu_of_temperature = _varied(points, TEMPERATURE)
    reference = next(point.value for point in points if point.nominal == _REFERENCE)

    def load(p: Array) -> Array:
        return p[0] * (loads / V2_LOAD_N) ** p[1] - mu_of_load

    def speed(p: Array) -> Array:
        return p[0] * (slips / V2_SLIP_M_S) ** p[1] + p[2] - mu_of_slip

    def heat(p: Array) -> Array:
        factor = p[0] * np.exp(-1e-3 * p[1] * (temperatures - p[2]) ** 2) + p[3]
        return factor - mu_of_temperature / reference

    _, b1 = map(float, least_squares_of(load, (0.7, -0.4)))
    c, b2, a2 = map(float, least_squares_of(speed, (0.3, 1.3, 0.4)))
    alpha, beta, tm, gamma = map(float, least_squares_of(heat, (0.4, 2.0, 70.0, 1.0)))
    a1 = c * V2_LOAD_N**-b1 * V2_SLIP_M_S**-b2
    return PaperParameters(alpha, 1e-3 * beta, gamma, a1, a2, b1, b2, tm)


def _varied(points: Sequence[FitPoint], variable: int) -> tuple[Array, Array]:
    """Return values of one variable, and coefficients, for conditions with all other variables at the reference."""
    import numpy as np

    varied = [
        point
        for point in points
        if all(i == variable or point.nominal[i] == at for i, at in enumerate(_REFERENCE))
    ]  # fmt: skip
    return np.array([point.nominal[variable] for point in varied]), np.array([point.value for point in varied])
