"""Reference conditions: the counterface's drift apart from the pieces', its interval, its term."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import exp, hypot, inf, log, nan, sqrt
from random import Random

import pytest

from tester.analysis.reference import (
    CHANGES,
    COUNTERFACE,
    PIECE_PER_M,
    CounterfaceDrift,
    KnownScatter,
    Reference,
    counterface_drift,
    is_reference,
)

U = 0.01
KNOWN = KnownScatter(60.0, 0.03)
RESERVED = replace(KNOWN, reserved=True)
PER_M = log(0.9) / 2000.0


def on_wheels(
    wheels: int, each: int = 2, *, compounds: Sequence[str] = ("1#",), off: Random | None = None
) -> list[Reference]:
    """Return references over 2 km of a counterface that loses 10 %, on pieces of 3 % scatter where ``off`` draws it."""
    found: list[Reference] = []
    step_m = 2000.0 / (wheels * each - 1)
    for wheel in range(wheels):
        own = off.gauss(0.0, 0.03) if off is not None else 0.0
        for place in range(each):
            number = len(found) + 1
            travel_m = (number - 1) * step_m
            value = log(0.7) + own + PER_M * travel_m + (off.gauss(0.0, U) if off is not None else 0.0)
            compound = compounds[wheel % len(compounds)]
            found.append(
                Reference(number, 10 * number, 600.0 * number, compound, wheel, exp(value), U, travel_m, 40.0 * place)
            )
    return found


def drift_of(references: Sequence[Reference], known: KnownScatter = KNOWN) -> CounterfaceDrift:
    found = counterface_drift(references, known)
    assert found is not None
    return found


def test_the_loss_of_the_counterface_is_found_across_changes_of_the_piece() -> None:
    found = drift_of(on_wheels(CHANGES + 1))
    assert found.apart and found.pieces == 7 and found.over_m == pytest.approx(2000.0)
    assert found.changed_percent(2000.0)[0] == pytest.approx(-10.0, abs=0.01)


def test_six_changes_are_enough_and_five_are_not() -> None:
    assert drift_of(on_wheels(CHANGES + 1, 1)).apart
    found = drift_of(on_wheels(CHANGES, 1))
    assert not found.apart and "cannot be told apart" in found.sentence("wheel")


def test_on_one_piece_the_drift_cannot_be_separated_by_any_number_of_references() -> None:
    found = drift_of(on_wheels(1, 30))
    assert not found.apart and "6 changes of the wheel or a reserved wheel" in found.sentence("wheel")


def test_on_a_reserved_piece_the_drift_is_separated() -> None:
    found = drift_of(on_wheels(1, 7), RESERVED)
    assert found.apart and found.changed_percent(2000.0)[0] == pytest.approx(-10.0, abs=1.0)
    assert "by a reserved wheel" in found.sentence("wheel")
    few = drift_of(on_wheels(1, 2), RESERVED)
    assert not few.apart and few.sentence("wheel").endswith("that takes 3 references")


def test_the_loss_of_the_piece_is_not_attributed_to_the_counterface() -> None:
    slides = [replace(one, mu=one.mu * exp(-5e-4 * one.piece_m)) for one in on_wheels(9, 3)]
    low, high = drift_of(slides).changed_percent(2000.0)[1:]
    assert low < -10.0 < high
    assert drift_of(slides).changed_percent(2000.0)[0] == pytest.approx(-10.0, abs=1.0)


def test_compounds_differ_without_a_drift() -> None:
    two = [
        replace(one, mu=one.mu * (1.5 if one.compound == "3#" else 1.0))
        for one in on_wheels(8, 2, compounds=("1#", "3#"))
    ]
    assert drift_of(two).changed_percent(2000.0)[0] == pytest.approx(-10.0, abs=0.01)


def test_the_interval_of_a_balanced_set_is_that_of_a_line_through_the_pieces() -> None:
    """One reference on each of eight pieces that do not slide: weighted least squares by hand."""
    references = on_wheels(8, 1)
    found = drift_of(references, replace(KNOWN, repeats_df=inf))
    travel = [one.counterface_m for one in references]
    middle = sum(travel) / 8
    spread = sqrt(sum((x - middle) ** 2 for x in travel))
    between = sqrt(8 * 0.03**2 / 14)  # the stated 3 % with 8 degrees of freedom, without the 6 residual ones
    assert found.standard == pytest.approx(hypot(between, U) / spread, rel=1e-6)
    assert found.df == pytest.approx(14.0 * (hypot(between, U) / between) ** 4, rel=1e-6)


def test_the_scatter_of_the_pieces_that_were_measured_widens_the_interval() -> None:
    wild = [replace(one, mu=one.mu * (1.1 if one.piece % 2 else 0.9)) for one in on_wheels(8, 1)]
    assert drift_of(wild).standard > 1.5 * drift_of(on_wheels(8, 1)).standard


def test_the_possible_loss_of_a_reserved_piece_is_in_the_interval() -> None:
    still = [replace(one, piece_m=0.0) for one in on_wheels(1, 7)]
    slid = [replace(one, piece_m=0.05 * one.counterface_m) for one in on_wheels(1, 7)]
    apart = drift_of(slid, RESERVED).standard ** 2 - drift_of(still, RESERVED).standard ** 2
    assert sqrt(apart) == pytest.approx(0.05 * PIECE_PER_M, rel=1e-3)


def test_intervals_contain_the_loss_at_their_stated_rate() -> None:
    held = 0
    for seed in range(200):
        low, high = drift_of(on_wheels(7, 2, off=Random(f"cover {seed}"))).changed_percent(2000.0)[1:]
        held += low <= -10.0 <= high
    assert 0.89 * 200 <= held <= 0.995 * 200


def test_too_few_references_give_no_result() -> None:
    one, *_ = on_wheels(7)
    assert counterface_drift([one], KNOWN) is None
    assert counterface_drift([one, replace(one, number=2)], KNOWN) is None  # without travel between
    assert counterface_drift([], KNOWN) is None


def test_references_without_a_value_are_left_out() -> None:
    full = on_wheels(8, 1)
    assert drift_of([*full, replace(full[-1], number=9, mu=nan)]).references == 8


# -- the term --------------------------------------------------------------------------------------------------------


def test_the_counterface_s_change_since_the_first_reference_is_a_term() -> None:
    found = CounterfaceDrift(-5e-5, 2e-5, 9.0, 100.0, 2100.0, 7, 7, apart=True)
    term = found.contribution(0.7, 1100.0)
    assert (term.name, term.df) == (COUNTERFACE, 9.0)
    assert term.standard == pytest.approx(0.7 * 1000.0 * hypot(5e-5, 2e-5))
    assert found.contribution(0.7, 100.0).standard == 0.0


def test_the_term_states_where_the_piece_contributes() -> None:
    found = CounterfaceDrift(-5e-5, 2e-5, 9.0, 0.0, 2000.0, 7, 1, apart=False)
    assert "the piece's part in it" in found.contribution(0.7, 1000.0).source
    assert "the piece's part in it" not in replace(found, apart=True).contribution(0.7, 1000.0).source


def test_the_sentence_states_when_nothing_is_resolved() -> None:
    found = CounterfaceDrift(-5e-5, 2e-5, 30.0, 0.0, 2000.0, 7, 7, apart=True)
    assert found.sentence("wheel") == (
        "counterface -9.5 % (-16.6 to -1.8 %, 95 %) over 2000 m of travel under load, by 7 wheels"
    )
    assert replace(found, standard=4e-5).sentence("wheel").endswith(", not resolved from 0")


def test_a_grid_is_a_reference_only_in_a_run_that_has_some() -> None:
    assert is_reference("reference", {"reference_every": "20"})
    assert not is_reference("reference", {}) and not is_reference("load", {"reference_every": "20"})
