"""Both directions of sliding as a table: what each shows, and by what angle the load cell's axes seem to be off."""

from __future__ import annotations

from collections.abc import Iterator

from tester.analysis.directions import BothWays, SlidingWay
from tester.analysis.misalignment import Misalignment, misalignment
from tester.results.cells import Cell
from tester.results.run_results import RunResults
from tester.results.tables import setpoint_header, setpoints

_WAY = ("n", "mu", "s", "mu_longitudinal", "drift_percent", "load_n", "sliding_m_s", "surface_c")
_SIDES = ("as_asked", "reversed")
_ANGLE = ("misalignment_deg", "misalignment_u_standard_deg", "misalignment_u_expanded_deg", "degrees_of_freedom")


def direction_rows(results: RunResults) -> Iterator[tuple[Cell, ...]]:
    """Yield one row for each condition that was measured in both directions, and last one for the whole run.

    ``mu_difference_percent``: by how much the direction that was asked for shows more. The angle is that of the cell's
    axes with crosstalk of load and friction in it (``tester.analysis.misalignment``); the row ``run`` has it pooled
    over all conditions.
    """
    sides = (f"{name}_{side}" for side in _SIDES for name in _WAY)
    yield ("level", "condition", *setpoint_header(results), "pairs", *sides, "mu_difference_percent", *_ANGLE)
    empty: tuple[Cell, ...] = (None,) * (2 * len(_WAY) + 1)
    for measured in results.conditions():
        ways = measured.result.both_ways
        if ways is not None:
            own = ("condition", measured.info.condition, *setpoints(measured.info, measured.info.replicate))
            yield (*own, *_ways(ways), *_angle(misalignment([measured.result])))
    found = results.misalignment()
    yield ("run", None, *(None for _ in setpoint_header(results)), found.pairs, *empty, *_angle(found))


def _ways(ways: BothWays) -> tuple[Cell, ...]:
    return (ways.pairs, *_way(ways.forward), *_way(ways.backward), ways.difference_percent)


def _way(one: SlidingWay) -> tuple[Cell, ...]:
    means = one.means
    return one.n, one.mu, one.s, one.along, one.drift_percent, means.normal, means.sliding, means.temperature


def _angle(found: Misalignment) -> tuple[Cell, ...]:
    return found.deg, found.standard_deg, found.expanded_deg, found.df
