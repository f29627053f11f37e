"""Which maximum a rule of Grosch is compared with, and when it holds."""

from __future__ import annotations

from math import isnan

import pytest

from sim.physics.moduli import ConstantModulus, FractionalZener
from tester.analysis.master_curve.peaks import Peak
from tester.analysis.master_curve.rules import Mechanism, Rule, RuleVerdict, rules_of

RUBBER = FractionalZener(relaxed_pa=1e6, glassy_pa=1e9, tau_s=1e-6, exponent=0.6, shift_c=-3.0)
JUMP_M_S, GRIT_M_S = (rule.speed_m_s for rule in rules_of(RUBBER, 20.0, ()))


def at(speed_m_s: float, wide: float = 0.1) -> Peak:
    """Return a maximum whose interval reaches so many decades to both sides."""
    return Peak(speed_m_s, 1.0, (speed_m_s * 10.0**-wide, speed_m_s * 10.0**wide))


def verdicts(*peaks: Peak, only: Mechanism | None = None) -> list[RuleVerdict]:
    return [rule.verdict for rule in rules_of(RUBBER, 20.0, peaks, only)]


def test_of_two_maxima_the_slower_one_is_of_adhesion() -> None:
    slow, fast = at(1e-9), at(1e-7)  # both nearer to the rule of adhesion
    adhesion, deformation = rules_of(RUBBER, 20.0, (slow, fast))
    assert (adhesion.peak, deformation.peak) == (slow, fast)
    assert adhesion.assigned and deformation.assigned


def test_rules_hold_where_the_whole_interval_is_near() -> None:
    assert verdicts(at(JUMP_M_S), at(GRIT_M_S)) == [RuleVerdict.HOLDS] * 2
    assert verdicts(at(JUMP_M_S * 1.5), at(GRIT_M_S / 1.5)) == [RuleVerdict.HOLDS] * 2


@pytest.mark.parametrize("factor", [0.1, 10.0])
def test_a_rule_does_not_hold_where_all_of_the_interval_is_away(factor: float) -> None:
    assert verdicts(at(JUMP_M_S * factor), at(GRIT_M_S * 1e3)) == [RuleVerdict.DOES_NOT] * 2


def test_an_interval_across_the_limit_decides_nothing() -> None:
    assert verdicts(at(JUMP_M_S * 2.0), at(GRIT_M_S, 0.5)) == [RuleVerdict.OPEN] * 2


@pytest.mark.parametrize("place", [0, 1])
def test_an_only_maximum_is_compared_with_the_rule_of_its_mechanism_alone(place: int) -> None:
    only = list(Mechanism)[place]
    rules = rules_of(RUBBER, 20.0, (at((JUMP_M_S, GRIT_M_S)[place]),), only)
    assert [rule.mechanism for rule in rules] == list(Mechanism)
    assert rules[place].verdict is RuleVerdict.HOLDS and rules[place].decades == pytest.approx(0.0, abs=1e-9)
    assert rules[1 - place].peak is None and rules[1 - place].verdict is RuleVerdict.OPEN


@pytest.mark.parametrize("peaks", [(at(JUMP_M_S),), (at(JUMP_M_S), at(GRIT_M_S), at(1.0))])
def test_a_maximum_of_an_unknown_mechanism_is_only_near(peaks: tuple[Peak, ...]) -> None:
    rules = rules_of(RUBBER, 20.0, peaks)
    assert [rule.verdict for rule in rules] == [RuleVerdict.OPEN] * 2
    assert not any(rule.assigned for rule in rules) and rules[0].decades == pytest.approx(0.0, abs=1e-9)


def test_a_maximum_without_an_interval_decides_nothing() -> None:
    assert verdicts(Peak(JUMP_M_S, 1.0), Peak(GRIT_M_S, 1.0)) == [RuleVerdict.OPEN] * 2


def test_without_a_maximum_of_the_moduli_there_is_nothing_to_compare() -> None:
    for rule in rules_of(ConstantModulus(1e6, 0.3), 20.0, (at(1e-3), at(1.0))):
        assert isnan(rule.speed_m_s) and isnan(rule.decades) and rule.verdict is RuleVerdict.OPEN


def test_a_rule_without_a_maximum_has_no_interval() -> None:
    assert all(isnan(end) for end in Rule("", Mechanism.ADHESION, 1.0).interval)
