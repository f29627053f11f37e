"""Whether conditions lie on one curve."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tester.analysis.master_curve.collapse import collapse
from tester.analysis.master_curve.fitted_curve import Master, master_of
from tester.analysis.master_curve.points import MasterPoint, set_of
from tester.analysis.master_curve.verdict import Verdict, judge, signs_of
from tests.campaigns.master.synthetic import FAILING, synthetic


def made(points: list[MasterPoint]) -> Master:
    return master_of(points, 20.0, resamples=40)


@pytest.mark.parametrize(("noise", "floor"), [(0.03, 0.0), (0.002, 0.01)])
def test_each_f_is_fisher_s_with_chance_at_least_a_hundredth(noise: float, floor: float) -> None:
    stats = pytest.importorskip("scipy.stats", reason="needs the extra `report`")
    found = collapse(set_of(synthetic(0, noise)), resamples=2)
    base = np.column_stack([found.design(), found.moved_by_ts()])
    slopes = found.curve.slope(found.x)[:, None] * found.of.in_block
    shape = found.design() * (found.of.celsius - np.mean(found.of.celsius))[:, None]

    def fitted(columns: np.ndarray) -> tuple[float, int]:
        weights, _, rank, _ = np.linalg.lstsq(columns, found.of.log_mu, rcond=1e-9)
        return float(np.sum((found.of.log_mu - columns @ weights) ** 2)), int(rank)

    before, rank = fitted(base)
    for test, further in zip(judge(found, ()).tests, (found.of.in_block, slopes, shape), strict=True):
        after, wide = fitted(np.column_stack([base, further]))
        df = len(found.residual) - wide
        f = (before - after) / (wide - rank) / max(after / df, floor**2)
        assert (test.f, test.critical) == pytest.approx((f, stats.f.isf(1e-4, wide - rank, df)), rel=1e-6)


def test_a_ts_that_may_lie_anywhere_cannot_tell() -> None:
    found = collapse(set_of(synthetic(0, 0.02)), resamples=2)
    assert judge(replace(found, interval=(0.0, 39.0)), ()).verdict is Verdict.COLLAPSES
    judged = judge(replace(found, interval=(0.0, 41.0)), ())
    assert (judged.verdict, judged.reasons) == (Verdict.OPEN, ("Ts is open over 41 K",))
    assert judge(replace(found, at_end=True), ()).verdict is Verdict.OPEN


@pytest.mark.parametrize("noise", [0.0, 0.005, 0.02, 0.05])
def test_a_set_that_is_one_curve_collapses(noise: float) -> None:
    found = [made(synthetic(seed, noise)).judged for seed in range(3)]
    assert {one.verdict for one in found} == {Verdict.COLLAPSES} and found[0].reasons == ()
    assert [test.name for test in found[0].tests] == ["factors", "shifts", "shape"]


@pytest.mark.parametrize(("how", "reason"), [
    (FAILING["factors of 10 % by temperature"], "factors of their own"),
    (FAILING["a shift of a decade for 12 K"], "not those of WLF"),
    (FAILING["a shift after Arrhenius, 100 kJ/mol"], "not those of WLF"),
    (FAILING["an adhesion peak 25 % lower when warm, higher when cold"], "shape changes"),
])  # fmt: skip
def test_a_set_that_is_none_does_not_with_the_reason(how: Mapping[str, object], reason: str) -> None:
    for seed in range(3):
        judged = made(synthetic(seed, 0.02, **how)).judged  # type: ignore[arg-type]
        assert judged.verdict is Verdict.DOES_NOT and any(reason in one for one in judged.reasons), judged


def test_a_power_law_gives_no_verdict_because_it_collapses_at_any_shift() -> None:
    judged = made(synthetic(0, 0.02, power=0.2)).judged
    assert judged.verdict is Verdict.OPEN
    assert "a power law in v collapses at any shift" in judged.reasons[0]


def test_temperatures_that_share_nothing_cannot_tell() -> None:
    apart = [one for one in synthetic(0, 0.02) if one.block_c in (-5.0, 40.0, 85.0) and one.speed_m_s > 5e-4]
    apart += [one for one in synthetic(1, 0.02) if one.block_c in (-5.0, 40.0, 85.0) and one.speed_m_s > 5e-4]
    judged = master_of(apart, 20.0, 30.0).judged
    assert judged.verdict is Verdict.OPEN and "too little overlap" in judged.reasons[0]


def test_two_temperatures_cannot_tell() -> None:
    judged = made([one for one in synthetic(0, 0.02) if one.block_c < 10.0]).judged
    assert judged.verdict is Verdict.OPEN and "2 temperatures (expected at least 3)" in judged.reasons


def test_a_ts_that_is_given_wrongly_does_not_collapse() -> None:
    assert master_of(synthetic(0, 0.02), 20.0, 0.0).judged.verdict is Verdict.DOES_NOT


def test_on_a_master_curve_warming_equals_slowing() -> None:
    found = signs_of(synthetic(0, 0.0))
    assert found.cells > 50 and found.same <= 0.05 * found.cells


def test_a_coefficient_that_rises_with_both_is_none() -> None:
    rising = [replace(one, mu=one.speed_m_s**0.1 * 1.05 ** (one.block_c / 9.0)) for one in synthetic(0, 0.0)]
    found = signs_of(rising)
    assert found.same == found.cells == 80


def test_compounds_and_loads_are_apart() -> None:
    points = synthetic(0, 0.0)
    parted = [replace(one, held={"load": f"{i} N"}) for i, one in enumerate(points)]
    assert signs_of(parted).cells == 0
