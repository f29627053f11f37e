"""Tables of laws: right within half a percent, kept in a folder, recomputed where a file is invalid."""

from __future__ import annotations

import math
import random
from copy import deepcopy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim.physics import laws, tabulated
from sim.physics.lookup import TableSpan, TabulatedLaw
from sim.physics.materials import Components
from sim.physics.moduli import DmaRow, TabulatedModulus
from sim.physics.roughness import TabulatedSpectrum
from tests.sim.physics.materials_example import Shelf

SPAN = TableSpan((1e-6, 1.0), (-20.0, 100.0), (5.0, 100.0))
SETTING = laws.LawSetting(Shelf(), "grit", 100.0)


class Counted:
    """A smooth law in closed form that counts how often it is asked."""

    def __init__(self, sharpness: float = 0.3) -> None:
        self.asked = 0
        self.sharpness = sharpness

    def components(self, temperature_c: float, load_n: float, slip_m_s: float) -> Components:
        self.asked += 1
        x = math.log10(slip_m_s) + 3.0 - 0.05 * temperature_c
        adhesion = 1.2 * math.exp(-self.sharpness * x * x) * load_n**-0.1
        return Components(adhesion, 0.3 + 0.1 * math.tanh(x))

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        return sum(self.components(temperature_c, load_n, slip_m_s))


@pytest.fixture(scope="module")
def counted() -> TabulatedLaw:
    """A table of ``Counted``."""
    return tabulated.build(Counted(), SPAN)[0]


def points(number: int, seed: int = 5) -> list[tuple[float, float, float]]:
    """Return random temperatures, loads and speeds of the span."""
    draw = random.Random(seed)
    return [
        (
            draw.uniform(*SPAN.temperatures_c),
            math.exp(draw.uniform(*map(math.log, SPAN.loads_n))),
            math.exp(draw.uniform(*map(math.log, SPAN.speeds_m_s))),
        )
        for _ in range(number)
    ]


def made(folder: Path | None, span: TableSpan = SPAN, setting: laws.LawSetting = SETTING) -> TabulatedLaw:
    """Return the table of persson for SBR on grit."""
    return tabulated.tabulated("persson", "SBR", {}, replace(setting, tables=folder), span)


def test_a_table_of_persson_is_right_within_half_a_percent() -> None:
    slow, table = laws.make("persson", "SBR", setting=SETTING), made(None)
    errors = [abs(table.mu(*at) / slow.mu(*at) - 1.0) for at in points(500)]
    assert max(errors) < tabulated.ALLOWED
    assert table.error < tabulated.ALLOWED
    assert table.outside == 0


def test_parts_are_right_and_add_up_to_the_coefficient(counted: TabulatedLaw) -> None:
    for at in points(300):
        parts, expected = counted.components(*at), Counted().components(*at)
        assert sum(parts) == pytest.approx(counted.mu(*at), rel=1e-12)
        assert parts == pytest.approx(expected, abs=0.005 * sum(expected))


def test_at_its_points_and_ends_a_table_is_exact() -> None:
    table, slow = tabulated.build_at(Counted(), SPAN, (12, 9, 5))[0], Counted()
    for speed in np.geomspace(1e-6, 1.0, 12):
        for temperature_c in SPAN.temperatures_c:
            for load_n in np.linspace(5.0**0.5, 10.0, 5) ** 2:
                at = temperature_c, min(float(load_n), 100.0), min(float(speed), 1.0)
                assert table.mu(*at) == pytest.approx(slow.mu(*at), rel=1e-9)


def test_a_table_states_its_own_error() -> None:
    rough = tabulated.build_at(Counted(sharpness=3.0), SPAN, (12, 9, 5))[0]
    errors = [abs(rough.mu(*at) / Counted(sharpness=3.0).mu(*at) - 1.0) for at in points(1000)]
    assert rough.error > tabulated.ALLOWED
    assert 0.3 * max(errors) < rough.error < 3.0 * max(errors)


def test_a_table_that_is_not_right_enough_is_given_more_points() -> None:
    table = tabulated.build(Counted(sharpness=2.0), SPAN)[0]
    assert tabulated.build_at(Counted(sharpness=2.0), SPAN, tabulated.POINTS)[0].error > tabulated.ALLOWED
    assert table.points > tabulated.POINTS and table.error < tabulated.ALLOWED


def test_rounds_of_refinement_have_an_end() -> None:
    table = tabulated.build(Counted(sharpness=2.0), SPAN, rounds=0)[0]
    assert table.points == tabulated.POINTS and table.error > tabulated.ALLOWED


def test_slower_and_lighter_than_the_table_is_as_its_end(counted: TabulatedLaw) -> None:
    assert counted.mu(20.0, 1.0, 1e-9) == counted.mu(20.0, 5.0, 1e-6)
    assert counted.components(20.0, 50.0, 0.0) == counted.components(20.0, 50.0, 1e-6)
    assert counted.outside == 0


@pytest.mark.parametrize("at", [(-21.0, 50.0, 0.1), (101.0, 50.0, 0.1), (20.0, 101.0, 0.1), (20.0, 50.0, 1.1)])
def test_beyond_the_table_the_law_itself_is_asked_and_counted(at: tuple[float, float, float]) -> None:
    table = tabulated.build_at(Counted(), SPAN, (6, 6, 5))[0]
    assert table.mu(*at) == Counted().mu(*at) and table.outside == 1
    assert table.components(*at) == Counted().components(*at) and table.outside == 2


def test_a_table_in_its_folder_is_not_made_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    first = made(tmp_path / "tables")
    monkeypatch.setattr(tabulated, "build", None)
    again = made(tmp_path / "tables")
    assert [again.mu(*at) for at in points(20)] == [first.mu(*at) for at in points(20)]
    assert (again.error, again.points) == (first.error, first.points)
    assert [path.suffix for path in (tmp_path / "tables").iterdir()] == [".table"]


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables are made of another law, with few points."""

    def build(slow: laws.LawOfParts, span: TableSpan) -> tuple[TabulatedLaw, np.ndarray, np.ndarray]:
        return tabulated.build_at(Counted(), span, (5, 5, 5))

    monkeypatch.setattr(tabulated, "build", build)


@pytest.mark.usefixtures("quick")
@pytest.mark.parametrize("harm", ["cut short", "a bit turned", "empty", "a folder"])
def test_a_damaged_table_is_made_again(tmp_path: Path, harm: str) -> None:
    first = made(tmp_path)
    (file,) = tmp_path.iterdir()
    content = file.read_bytes()
    if harm == "a folder":
        file.unlink()
        file.mkdir()
    else:
        turned = bytearray(content)
        turned[len(content) // 2] ^= 0x10
        file.write_bytes({"cut short": content[:-8], "a bit turned": bytes(turned), "empty": b""}[harm])
    again = made(tmp_path)
    assert [again.mu(*at) for at in points(20)] == [first.mu(*at) for at in points(20)]
    if harm != "a folder":
        assert file.read_bytes() == content
    assert [path.name for path in tmp_path.iterdir()] == [file.name]


@pytest.mark.usefixtures("quick")
def test_a_folder_that_cannot_be_written_costs_the_file_alone(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way", encoding="utf-8")
    assert made(tmp_path / "file" / "tables").points == (5, 5, 5)


@pytest.mark.usefixtures("quick")
def test_all_that_enters_makes_another_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def files() -> int:
        return len(list(tmp_path.iterdir()))

    made(tmp_path)
    made(tmp_path)
    assert files() == 1
    made(tmp_path, replace(SPAN, loads_n=(5.0, 120.0)))
    assert files() == 2
    made(tmp_path, setting=replace(SETTING, area_mm2=120.0))
    assert files() == 3
    made(tmp_path, setting=replace(SETTING, surface="track"))
    assert files() == 4
    tabulated.tabulated("persson", "plain", {}, replace(SETTING, tables=tmp_path), SPAN)
    assert files() == 5
    monkeypatch.setitem(laws._LAWS, "persson", replace(laws._LAWS["persson"], version=2))  # type: ignore[type-var]
    made(tmp_path)
    assert files() == 6


def test_measured_materials_are_identified_by_their_content() -> None:
    rows = [DmaRow(-t, 1.0, 1e7 * 1.1**t, 1e6 * 1.2**t) for t in range(5)]
    changed = [*rows[:4], rows[4]._replace(loss_pa=1.0)]
    of = TabulatedModulus.of_sweep
    assert repr(of(rows)) == repr(of(rows)) != repr(of(changed))
    assert len({repr(one) for one in (of(rows), of(rows, decade_k=7.0), of(rows, 0.4), of(rows, hold_ends=True))}) == 4
    q = np.array([1e4, 1e5])
    assert repr(TabulatedSpectrum(q, q)) == repr(TabulatedSpectrum(q, q)) != repr(TabulatedSpectrum(q, 2.0 * q))


@pytest.mark.usefixtures("quick")
def test_materials_without_a_content_hash_are_not_kept(tmp_path: Path) -> None:
    class Unnamed(Shelf):
        def rubber(self, name: str):  # type: ignore[no-untyped-def]
            class Own:
                complex_pa = Shelf.rubber(self, name).modulus.complex_pa

            return replace(super().rubber(name), modulus=Own())

    assert made(tmp_path, setting=replace(SETTING, materials=Unnamed())).points == (5, 5, 5)
    assert list(tmp_path.iterdir()) == []


def test_a_law_without_parts_has_no_table() -> None:
    with pytest.raises(laws.NoPartsError):
        tabulated.tabulated("paper", "1#", {}, SETTING, SPAN)


def test_a_value_does_not_depend_on_those_asked_before(counted: TabulatedLaw) -> None:
    at = (20.0, 30.0, 1e-3)
    others = [(20.0, 31.0, 1e-3), at, (25.0, 30.0, 1e-2), at, at, (20.0, 99.0, 1e-3)]
    fresh = tabulated.build(Counted(), SPAN)[0].mu(*at)
    for other in others:
        counted.mu(*other)
        assert counted.mu(*at) == counted.mu(*at) == fresh


def test_a_span_that_does_not_ascend_is_refused() -> None:
    with pytest.raises(ValueError, match="speeds_m_s ascends from above 0"):
        TableSpan((0.0, 1.0), (0.0, 1.0), (1.0, 2.0))
    with pytest.raises(ValueError, match="temperatures_c ascends from above -150"):
        TableSpan((1e-6, 1.0), (-160.0, 1.0), (1.0, 2.0))


def test_copies_of_a_rig_share_a_table(counted: TabulatedLaw) -> None:
    assert deepcopy(counted) is counted
