"""Moduli in instruments' formats: recognised, asked for, converted with a notice, doubted by name."""

from __future__ import annotations

from math import pi

import pytest

from tester.base.source import InvalidSource
from tester.inputs.materials.dma import read_dma
from tester.inputs.materials.files import Findings
from tester.inputs.materials.headings import DmaOptions
from tester.inputs.materials.measured_moduli import ModuliTable

TEMPERATURES = range(-60, 60, 8)


def text(
    heads: str = "Temperature [degC];Frequency [Hz];E' [MPa];E'' [MPa]", row: str = "{t};1;{e};{l}", top: str = ""
) -> str:
    """Return a file of 15 points whose E' falls from 1500 MPa and whose tan delta is 0.1."""
    lines = [
        row.format(t=t, e=1500 - 100 * i, l=(1500 - 100 * i) / 10, tan=0.1, k=t + 273.15)
        for i, t in enumerate(TEMPERATURES)
    ]
    return "\n".join([top + heads, *lines]) + "\n"


def read(content: str, options: DmaOptions | None = None) -> tuple[ModuliTable, Findings]:
    found = Findings("dma.csv")
    return read_dma(content, options or DmaOptions(), found), found


def refused(content: str, options: DmaOptions | None = None) -> list[str]:
    with pytest.raises(InvalidSource) as raised:
        read(content, options)
    return [str(problem) for problem in raised.value.problems]


def test_a_plain_file_arrives_in_si_without_a_doubt() -> None:
    table, found = read(text())
    assert len(table.rows) == 15
    assert table.rows[0].temperature_c == -60.0 and table.rows[0].frequency_hz == 1.0
    assert (table.rows[0].storage_pa, table.rows[0].loss_pa) == (1.5e9, 1.5e8)
    assert found.doubts == []


@pytest.mark.parametrize(
    "heads",
    [
        "Temp./°C\tFreq (Hz)\tE' MPa\tE'' MPa",
        "Ts [°C]\tf [Hz]\tM' [N/mm²]\tM'' [N/mm²]",
        "Temperature, °C\tFrequency, Hz\tStorage Modulus, MPa\tLoss Modulus, MPa",
        "TEMPERATURE (C)\tFREQ. (HZ)\tE′ (MPa)\tE″ (MPa)",
        "Sample temperature [Celsius]\tFrequency {Hz}\tTensile storage modulus [MPa]\tTensile loss modulus [MPa]",
    ],
)
def test_headings_of_several_makers_are_recognised(heads: str) -> None:
    table, _ = read(text(heads, "{t}\t1\t{e}\t{l}"))
    assert (table.rows[1].temperature_c, table.rows[1].storage_pa) == (-52.0, 1.4e9)


def test_lines_above_the_headings_are_passed_over() -> None:
    table, _ = read(text(top="Instrument;DMA 1\nOperator;Li\n\nMethod: temperature sweep; 1 Hz\n\n"))
    assert len(table.rows) == 15


def test_units_may_stand_in_a_second_row() -> None:
    heads = "Temperature;Frequency;E';E''\n[°C];[Hz];[kPa];[kPa]"
    table, _ = read(text(heads))
    assert table.rows[0].storage_pa == 1.5e6


def test_a_decimal_comma_is_read_and_noted() -> None:
    table, found = read(text(row="{t},0;1,0;{e},5;10,25"))
    assert table.rows[0].storage_pa == 1500.5e6 and table.rows[0].loss_pa == 10.25e6
    assert "numbers have a decimal comma" in found.notes


def test_commas_and_points_in_one_file_are_refused() -> None:
    (problem,) = refused(text(row="{t},5;1;{e};{l}"))
    assert problem.startswith("dma.csv:2:1:") and "which of them is decimal?" in problem


def test_a_comma_that_may_mean_thousands_is_doubted() -> None:
    _, found = read(text(row="{t};1;1,234;0,123".replace("0,123", "1,001")))
    (doubt,) = [str(one) for one in found.doubts]
    assert '"1,234" is read as 1.234: its comma may mean thousands' in doubt


def test_angular_frequency_is_converted_with_a_notice() -> None:
    table, found = read(text("Temp [degC];omega [rad/s];E' [MPa];E'' [MPa]", f"{{t}};{2 * pi};{{e}};{{l}}"))
    assert table.rows[0].frequency_hz == pytest.approx(1.0, rel=1e-12)
    assert "angular frequency: f = omega / 2 pi" in found.notes


def test_kelvin_is_converted() -> None:
    table, _ = read(text("T [K];f [Hz];E' [GPa];E'' [GPa]", "{k};1;1;0.1"))
    assert table.rows[0].temperature_c == pytest.approx(-60.0, abs=1e-9)
    assert table.rows[0].storage_pa == 1e9


def test_shear_moduli_become_those_of_tension_with_a_notice() -> None:
    heads = "T [degC];f [Hz];G' [MPa];G'' [MPa]"
    table, found = read(text(heads), DmaOptions(poisson=0.45))
    assert table.rows[0].storage_pa == pytest.approx(2.9 * 1.5e9, rel=1e-12)
    assert table.rows[0].loss_pa == pytest.approx(2.9 * 1.5e8, rel=1e-12)
    assert "shear: E = 2 (1 + nu) G = 2.9 G, nu = 0.45" in found.notes


def test_a_missing_loss_modulus_is_made_of_tan_delta_with_a_notice() -> None:
    table, found = read(text("T [degC];f [Hz];E' [MPa];tan delta", "{t};1;{e};{tan}"))
    assert table.rows[0].loss_pa == pytest.approx(1.5e8, rel=1e-12)
    assert any("E'' is E' times tan delta" in note for note in found.notes)


def test_tan_delta_that_agrees_is_noted() -> None:
    _, found = read(text("T [degC];f [Hz];E' [MPa];E'' [MPa];Tan Delta", "{t};1;{e};{l};{tan}"))
    assert any("tan delta agrees" in note for note in found.notes) and found.doubts == []


def test_tan_delta_that_does_not_agree_is_doubted_with_its_worst_line() -> None:
    content = text("T [degC];f [Hz];E' [MPa];E'' [MPa];Tan Delta", "{t};1;{e};{l};{tan}")
    _, found = read(content.replace("-44;1;1300;130.0;0.1", "-44;1;1300;130.0;0.15"))
    (doubt,) = [str(one) for one in found.doubts]
    assert doubt.startswith("dma.csv:4:1: tan delta 0.15 is not E''/E' = 0.1") and "1 of 15 points" in doubt


def test_a_missing_unit_is_asked_for_with_the_expected_ones() -> None:
    problems = refused(text("Temperature;Frequency [Hz];Storage Modulus;E'' [MPa]"))
    assert len(problems) == 2
    assert '"Temperature" has no unit (expected degC or K; --unit "Temperature=degC")' in problems[1]
    assert '"Storage Modulus" has no unit (expected Pa, kPa, MPa or GPa' in problems[0]


def test_a_unit_may_be_given() -> None:
    options = DmaOptions(units={"Storage Modulus": "kPa"})
    table, _ = read(text("T [degC];f [Hz];Storage Modulus;E'' [MPa]", "{t};1;{e}000;{l}"), options)
    assert table.rows[0].storage_pa == 1.5e9


@pytest.mark.parametrize(
    ("heads", "said"),
    [
        ("T [degC];f [Hz];E' [psi];E'' [MPa]", 'the unit "psi" is none of E\' (expected Pa, kPa, MPa or GPa)'),
        ("T [degF];f [Hz];E' [MPa];E'' [MPa]", 'the unit "degF" is none of temperature (expected degC or K)'),
        ("T [degC];f [mPa];E' [MPa];E'' [MPa]", 'the unit "mPa" is none of frequency (expected Hz, kHz or rad/s)'),
        ("T [degC];f [Hz];E' [mPa];E'' [MPa]", 'the unit "mPa" is none of E\''),
    ],
)
def test_a_unit_of_another_kind_is_refused(heads: str, said: str) -> None:
    assert any(said in problem for problem in refused(text(heads)))


def test_a_column_may_be_named() -> None:
    options = DmaOptions(columns={"E'": "Modul 1", 'E"': "Modul 2"})
    table, found = read(text("T [degC];f [Hz];Modul 1 [MPa];Modul 2 [MPa]"), options)
    assert table.rows[0].storage_pa == 1.5e9 and found.doubts == []


def test_a_missing_heading_is_reported_with_the_nearest() -> None:
    problems = refused(text(), DmaOptions(columns={"tan": "E'' [MP]"}))
    assert any('no heading "E\'\' [MP]", did you mean "E\'\' [MPa]"?' in problem for problem in problems)


def test_missing_columns_are_asked_for() -> None:
    problems = refused(text("T [degC];x;E' [MPa];y"))
    assert any("no column is recognised as frequency" in one and '--frequency "1 Hz"' in one for one in problems)
    assert any("loss modulus, or tan delta" in one for one in problems)


def test_a_frequency_may_be_given_for_every_point() -> None:
    table, _ = read(text("T [degC];x;E' [MPa];E'' [MPa]"), DmaOptions(frequency_hz=10.0))
    assert table.frequencies_hz == (10.0,)


def test_two_columns_of_one_quantity_are_asked_about() -> None:
    problems = refused(text("T [degC];Temp [degC];E' [MPa];E'' [MPa]"), DmaOptions(frequency_hz=1.0))
    assert any("which of them is temperature?" in one for one in problems)


def test_tension_and_shear_together_are_asked_about() -> None:
    problems = refused(text("T [degC];f [Hz];E' [MPa];G'' [MPa]"))
    assert any("moduli of tension (E) and of shear (G) are there" in one for one in problems)


def test_a_modulus_without_its_deformation_is_doubted() -> None:
    _, found = read(text("T [degC];f [Hz];Storage Modulus [MPa];Loss Modulus [MPa]"))
    (doubt,) = found.doubts
    assert "does not say of which deformation: taken for tension" in doubt.message
    assert len(found.lasting) == 1


def test_no_headings_at_all_are_refused() -> None:
    (problem,) = refused("1;2;3;4\n5;6;7;8\n")
    assert "no row of headings is recognised" in problem


def test_cells_that_are_no_numbers_are_refused_each_with_its_line() -> None:
    content = text().replace("-52;1;1400;140.0", "-52;1;n/a;140.0").replace("-44;1;1300;130.0", "-44;1;1300")
    problems = refused(content)
    assert [one.split(": ", 1)[1] for one in problems] == [
        'E\' [MPa]: "n/a" is not a number',
        "E'' [MPa]: nothing is there",
    ]
    assert [one.split(":")[1] for one in problems] == ["3", "4"]


def test_letters_are_distinguished_by_case() -> None:
    heads = "t [s];F [N];T [degC];f [Hz];E' [MPa];E'' [MPa]"
    table, found = read(text(heads, "0;9;{t};1;{e};{l}"))
    assert table.rows[0].temperature_c == -60.0 and table.rows[0].frequency_hz == 1.0 and found.doubts == []


def test_a_frequency_with_noise_may_be_given() -> None:
    content = text(row="{t};1.00{e};{e};{l}")
    table, _ = read(content)
    assert len(table.frequencies_hz) > 1
    table, found = read(content, DmaOptions(frequency_hz=1.0))
    assert table.frequencies_hz == (1.0,) and any("frequency: 1 Hz, as set" in note for note in found.notes)
    problems = refused(content, DmaOptions(frequency_hz=2.0))
    assert len(problems) == 15 and "is not the 2 Hz that is set for all" in problems[0]


def test_digits_in_groups_and_zeros_are_refused() -> None:
    assert refused(text().replace("1400;", "1_400;", 1)) == ['dma.csv:3:1: E\' [MPa]: "1_400" is not a number']
    with_tan = text("T [degC];f [Hz];E' [MPa];E'' [MPa];tan", "{t};1;{e};{l};{tan}")
    assert refused(with_tan.replace(";1400;", ";0;", 1)) == ["dma.csv:3:1: E': 0 Pa is not above 0"]


def with_strain(*percent: float, heading: str = "Strain [%]") -> str:
    heads = f"Temperature [degC];Frequency [Hz];E' [MPa];E'' [MPa];{heading}"
    lines = text(heads, "{t};1;{e};{l};STRAIN").splitlines()
    strained = [line.replace("STRAIN", f"{percent[i % len(percent)]:g}") for i, line in enumerate(lines)]
    return "\n".join(strained) + "\n"


@pytest.mark.parametrize(
    ("heading", "cell", "percent"),
    [
        ("Strain [%]", 0.1, 0.1), ("Dynamic strain / %", 0.1, 0.1), ("Oscillation strain (%)", -0.1, 0.1),
        ("Shear strain [-]", 0.001, 0.1), ("Deformation %", 0.1, 0.1),
    ],
)  # fmt: skip
def test_the_strain_of_a_measurement_is_kept(heading: str, cell: float, percent: float) -> None:
    table, found = read(with_strain(cell, heading=heading))
    assert table.strains_percent == pytest.approx((percent, percent))
    assert f'strain: {percent:g} %, from "{heading}"' in found.notes and found.doubts == []
    assert not any(note.startswith("columns not used") for note in found.notes)


@pytest.mark.parametrize("heading", ["Strain", "Strain [um]", "Dynamic deformation [mm]"])
def test_a_strain_without_its_unit_is_not_used_and_it_is_noted(heading: str) -> None:
    table, found = read(with_strain(0.1, heading=heading))
    assert table.strains_percent is None
    assert f'strain: "{heading}" has no unit of a strain and is not used (% or 1)' in found.notes


def test_the_unit_of_a_strain_may_be_stated() -> None:
    table, _ = read(with_strain(0.1, heading="Strain"), DmaOptions(units={"Strain": "%"}))
    assert table.strains_percent == (0.1, 0.1)


def test_moduli_at_several_strains_keep_each() -> None:
    table, found = read(with_strain(0.1, 3.0))
    assert [row.strain_percent for row in table.rows[:3]] == [3.0, 0.1, 3.0]
    assert any(note.startswith("strain: 0.1 to 3 %") for note in found.notes)


def test_a_strain_that_is_missing_in_a_row_stays_unknown() -> None:
    content = with_strain(0.5).replace(";0.5\n", ";-\n", 2).replace(";0.5\n", ";0\n", 1)
    table, _ = read(content)
    assert [row.strain_percent for row in table.rows[:4]] == [None, None, None, 0.5]


def test_a_strain_may_be_stated_where_no_column_has_it() -> None:
    table, found = read(text(), DmaOptions(strain_percent=0.2))
    assert table.strains_percent == (0.2, 0.2) and found.doubts == []
    table, found = read(with_strain(0.1), DmaOptions(strain_percent=1.0))
    assert table.strains_percent == (0.1, 0.1)
    assert [one.message for one in found.doubts] == ["strain: 1 % is stated; the file has 0.1 %, which counts"]


def test_a_unit_row_may_have_a_strain_in_per_cent() -> None:
    content = with_strain(0.1, heading="Strain").replace("\n", "\n[degC];[Hz];[MPa];[MPa];[%]\n", 1)
    content = content.replace("Temperature [degC];Frequency [Hz];E' [MPa];E'' [MPa]", "Temperature;Frequency;E';E''")
    table, found = read(content)
    assert table.strains_percent == (0.1, 0.1) and 'strain: 0.1 %, from "Strain"' in found.notes


def test_a_strain_rate_is_no_strain() -> None:
    table, found = read(with_strain(0.1, heading="Strain rate [%/s]"))
    assert table.strains_percent is None and not any(note.startswith("strain:") for note in found.notes)
