"""Facts of a sweep: their intervals contain the truth, and facts that its points do not allow are left out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim.physics.moduli import FractionalZener
from tester.inputs.materials.measured_moduli import ModuliRow, ModuliTable
from tester.inputs.materials.sweep_facts import SweepFacts, fact_words, sweep_facts, sweeps_of

RUBBER = FractionalZener(2e6, 7e8, 1e-5, 0.6, 0.0, 20.0)


def table(
    seed: int, noise: float, step_k: float = 2.0, hertz: tuple[float, ...] = (1.0,),
    span_c: tuple[float, float] = (-80.0, 90.0),
) -> ModuliTable:  # fmt: skip
    """Return sweeps of temperature of one rubber; ``noise``: relative, of each modulus."""
    generator = np.random.default_rng(seed)
    rows: list[ModuliRow] = []
    for celsius in np.arange(span_c[0], span_c[1] + 1e-9, step_k):
        moduli = 3.0 * RUBBER.complex_pa(2.0 * np.pi * np.array(hertz), float(celsius))
        scatter = np.exp(noise * generator.normal(size=(2, len(hertz))))
        rows += [
            ModuliRow(float(celsius), f, float(e.real * a), float(e.imag * b))
            for f, e, a, b in zip(hertz, moduli, *scatter, strict=True)
        ]
    return ModuliTable(tuple(rows))


def truth(hertz: float) -> tuple[float, float]:
    """Return place and height of tan delta's peak, from a fine grid."""
    celsius = np.arange(-60.0, 80.0, 0.01)
    tan = [e.imag / e.real for c in celsius for e in RUBBER.complex_pa(np.array([2.0 * np.pi * hertz]), float(c))]
    return float(celsius[np.argmax(tan)]), float(np.max(tan))


TRUTH = {hertz: truth(hertz) for hertz in (1.0, 10.0, 100.0)}


@pytest.mark.parametrize(("noise", "step_k"), [(0.005, 1.0), (0.01, 2.0), (0.03, 2.0), (0.03, 3.0)])
def test_the_intervals_of_the_peak_hold_the_truth_of_95_in_100(noise: float, step_k: float) -> None:
    places: list[bool] = []
    heights: list[bool] = []
    for seed in range(100):
        peaks = sweep_facts(table(seed, noise, step_k, tuple(TRUTH))).peaks
        for peak in peaks:
            celsius, height = TRUTH[round(peak.frequency_hz)]
            places.append(abs(peak.place_c.value - celsius) <= peak.place_c.u)
            heights.append(abs(peak.height.value - height) <= peak.height.u)
    assert len(places) > 270  # of 300; scatter hides some
    assert 0.9 <= np.mean(places) <= 1.0 and 0.9 <= np.mean(heights) <= 1.0


def test_the_intervals_are_not_wider_than_a_laboratory_can_use() -> None:
    found = [sweep_facts(table(seed, 0.01)).peaks[0] for seed in range(20)]
    assert np.median([peak.place_c.u for peak in found]) < 2.0
    assert np.median([peak.height.u for peak in found]) < 0.03


def test_kelvins_a_decade_match_the_shift_of_the_peaks() -> None:
    truly = np.polyfit([0.0, 1.0, 2.0], [place for place, _ in TRUTH.values()], 1)[0]
    found = [sweep_facts(table(seed, 0.01, hertz=tuple(TRUTH))).decade_k for seed in range(60)]
    assert all(one is not None for one in found)
    held = [abs(one.value - truly) <= one.u for one in found if one is not None]
    assert np.mean(held) >= 0.9
    assert np.median([one.u for one in found if one is not None]) < 0.25 * truly


def test_two_frequencies_are_enough_and_close_ones_are_not() -> None:
    assert sweep_facts(table(0, 0.005, hertz=(1.0, 10.0))).decade_k is not None
    close = sweep_facts(table(0, 0.005, hertz=(1.0, 2.0)))
    assert close.decade_k is None and any("peaks over 0.30 decades" in reason for reason in close.silent)


def test_frequencies_that_a_row_of_the_file_swapped_give_no_kelvins_a_decade() -> None:
    right = table(0, 0.005, hertz=(1.0, 100.0))
    swapped = ModuliTable(tuple(replace(row, frequency_hz=100.0 / row.frequency_hz) for row in right.rows))
    found = sweep_facts(swapped)
    assert found.decade_k is None and any("do not move in order" in reason for reason in found.silent)


def ends(facts: SweepFacts) -> tuple[float | None, float | None]:
    return tuple(None if end is None else end.modulus_pa.value for end in (facts.rubber, facts.glass))  # type: ignore[return-value]


def test_the_plateaus_are_the_means_at_the_ends_with_their_range() -> None:
    inside: list[bool] = []
    for seed in range(60):
        facts = sweep_facts(table(seed, 0.02))
        assert facts.rubber is not None and facts.glass is not None and facts.ratio is not None
        for end, span in ((facts.rubber, (80.0, 90.0)), (facts.glass, (-80.0, -70.0))):
            assert (end.low_c, end.high_c) == span
            exact = [3.0 * float(RUBBER.complex_pa(np.array([2.0 * np.pi]), c)[0].real) for c in np.linspace(*span, 6)]
            inside.append(abs(end.modulus_pa.value - np.exp(np.mean(np.log(exact)))) <= end.modulus_pa.u)
        assert facts.ratio.value == pytest.approx(facts.glass.modulus_pa.value / facts.rubber.modulus_pa.value)
    assert np.mean(inside) >= 0.9


def test_a_sweep_that_ends_in_the_transition_has_no_plateau_there() -> None:
    warm = sweep_facts(table(0, 0.005, span_c=(-80.0, 10.0)))
    assert warm.rubber is None and warm.glass is not None
    assert any(reason.startswith("E0: E' still changes by") for reason in warm.silent)
    # All rubber: the cold end is flat, and is not a glass.
    rubber = sweep_facts(table(0, 0.005, span_c=(70.0, 100.0)))
    assert ends(rubber)[0] is not None and ends(rubber)[1] is None
    assert any(reason.startswith("Einf:") for reason in rubber.silent)


def test_a_sweep_beside_the_peak_names_no_peak() -> None:
    for span in ((-80.0, -15.0), (30.0, 90.0)):
        facts = sweep_facts(table(0, 0.005, span_c=span))
        assert facts.peaks == () and any("greatest value" in reason for reason in facts.silent)


def test_few_points_around_the_peak_name_no_peak() -> None:
    facts = sweep_facts(table(0, 0.005, step_k=10.0))
    assert facts.peaks == () and any("points around it are too few" in reason for reason in facts.silent)


def test_noise_in_the_frequency_makes_no_second_sweep() -> None:
    noisy = [replace(row, frequency_hz=1.0 + 0.01 * (i % 3)) for i, row in enumerate(table(0, 0.0).rows)]
    assert len(sweeps_of(noisy)) == 1


def test_facts_are_shown_with_their_units() -> None:
    words = dict(fact_words(sweep_facts(table(0, 0.01, hertz=(1.0, 10.0)))))
    assert " degC, 10 Hz: the Tg of a DMA" in words["tan peak"] and "±" in words["tan peak"]
    assert " MPa, mean of 80 to 90 degC, 1 Hz" in words["E0"] and " MPa, mean of -80 to -70 degC" in words["Einf"]
    assert words["shift"].endswith("K a decade of frequency, 1 to 10 Hz")
