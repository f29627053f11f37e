"""Names are looked up beside the recipe, in the laboratory's folder, in the package; and become inputs of laws."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import recipes
from sim.physics.materials import OutsideError, UnknownMaterialError
from sim.physics.moduli import ConstantModulus, FractionalZener, TabulatedModulus
from sim.physics.roughness import SelfAffine, TabulatedSpectrum
from tester.base.source import InvalidSource
from tester.inputs.materials.library import VARIABLE, Library, MissingModuliError, nameless


def compound(folder: Path, file: str, name: str, rest: str = "") -> Path:
    """Write a compound's file beside a recipe in ``folder``."""
    path = folder / "compounds" / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'name: "{name}"\n{rest}', encoding="utf-8")
    return path


def test_the_nearer_file_of_a_name_counts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own, shared = tmp_path / "own", tmp_path / "shared"
    shared.mkdir()
    monkeypatch.setenv(VARIABLE, str(shared))
    library = Library.beside(own / "r.yaml")
    assert library.path("compound", "SBR") == recipes.FOLDER / "compounds" / "sbr.yaml"
    there = compound(shared, "a.yaml", "SBR")
    assert library.path("compound", "SBR") == there
    here = compound(own, "b.yaml", "SBR")
    assert library.path("compound", "SBR") == here
    hidden = {one.path: one.hidden for one in library.entries("compound") if one.name == "SBR"}
    assert hidden == {here: False, there: True, recipes.FOLDER / "compounds" / "sbr.yaml": True}


def test_without_a_laboratory_there_are_two_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv(VARIABLE, raising=False)
    assert Library.beside(tmp_path / "r.yaml").folders == (tmp_path, recipes.FOLDER)
    assert Library.beside().folders == (recipes.FOLDER,)


def test_names_are_those_in_files(tmp_path: Path) -> None:
    compound(tmp_path, "anything.yaml", "7# (a: b)")
    assert Library([tmp_path]).compound("7# (a: b)").file.path.name == "anything.yaml"


def test_a_name_twice_in_a_folder_is_refused_with_both_files(tmp_path: Path) -> None:
    compound(tmp_path, "a.yaml", "X")
    compound(tmp_path, "b.yaml", "X")
    library = Library([tmp_path, recipes.FOLDER])
    for look in (lambda: library.path("compound", "X"), lambda: library.entries("compound")):
        with pytest.raises(InvalidSource, match=r'b\.yaml:1:1: name: "X" is already the name of a\.yaml in this'):
            look()
    assert library.path("compound", "SBR") is not None


def test_an_unknown_name_is_reported_with_the_searched_folders_and_near_names(tmp_path: Path) -> None:
    with pytest.raises(UnknownMaterialError, match=r'"SBB", did you mean "SBR"\? \(looked in .*compounds'):
        Library([tmp_path, recipes.FOLDER]).rubber("SBB")
    with pytest.raises(UnknownMaterialError, match='no file of a surface has the name "moon"'):
        Library([recipes.FOLDER]).surface("moon")


def test_a_file_without_a_name_is_reported(tmp_path: Path) -> None:
    path = compound(tmp_path, "a.yaml", "x")
    path.write_text("note: no name\n", encoding="utf-8")
    assert [*nameless(Library([tmp_path]))] == [path]


def test_a_compound_without_moduli_has_no_rubber() -> None:
    with pytest.raises(MissingModuliError, match=r'compound "1#": .* holds no moduli'):
        Library([recipes.FOLDER]).rubber("1#")


def test_moduli_arrive_as_classes_of_the_physics(tmp_path: Path) -> None:
    library = Library([tmp_path])
    compound(tmp_path, "c.yaml", "C", "moduli: {constant: {G: 1 MPa, loss_factor: 0.3}}\n")
    assert library.rubber("C").modulus == ConstantModulus(1e6, 0.3)
    zener = "{Gr: 1 MPa, Gg: 1 GPa, tau: 1e-6 s, at: 20 degC, b: 0.6, Ts: -3 degC}"
    compound(tmp_path, "z.yaml", "Z", f"Tg: -53 degC\nmoduli: {{fractional_zener: {zener}}}\n")
    rubber = library.rubber("Z")
    assert rubber.modulus == FractionalZener(1e6, 1e9, 1e-6, 0.6, shift_c=-3.0, t_ref_c=20.0)
    assert (rubber.glass_c, rubber.poisson, rubber.decade_k, rubber.shear) == (-53.0, 0.5, 8.0, None)


def table(frequencies: tuple[float, ...]) -> str:
    rows = [[-40 + 10 * i, f, 2000 / (i + 1) * f**0.1, 200 / (i + 1)] for i in range(10) for f in frequencies]
    listed = "".join(f"      - {row}\n" for row in rows)
    return f"moduli:\n  table:\n    columns: [temperature degC, frequency Hz, E' MPa, E'' MPa]\n    rows:\n{listed}"


def test_a_sweep_of_temperature_goes_by_its_decade(tmp_path: Path) -> None:
    compound(tmp_path, "t.yaml", "T", f"decade_k: 10\npoisson: 0.45\n{table((1.0,))}")
    rubber = Library([tmp_path]).rubber("T")
    assert isinstance(rubber.modulus, TabulatedModulus) and rubber.decade_k == 10.0
    # E(0 degC, 10 Hz) = E(-10 degC, 1 Hz), the fourth row: E' = 500 MPa, G' = E' / 2.9.
    (modulus,) = rubber.modulus.complex_pa(np.array([2.0 * np.pi * 10.0]), 0.0)
    assert modulus.real == pytest.approx(500e6 / 2.9, rel=1e-9)
    with pytest.raises(OutsideError):
        rubber.modulus.complex_pa(np.array([1e9]), 0.0)


def test_several_frequencies_go_by_the_glass_transition(tmp_path: Path) -> None:
    compound(tmp_path, "t.yaml", "T", f"Tg: -53 degC\n{table((1.0, 10.0))}")
    assert isinstance(Library([tmp_path]).rubber("T").modulus, TabulatedModulus)
    compound(tmp_path, "t.yaml", "T", table((1.0, 10.0)))
    with pytest.raises(MissingModuliError, match="Tg is missing"):
        Library([tmp_path]).rubber("T")


def test_beyond_its_points_a_table_holds_where_its_file_states_it(tmp_path: Path) -> None:
    text = table((1.0,)).replace("moduli:\n", "moduli:\n  beyond: hold\n")
    compound(tmp_path, "t.yaml", "T", text)
    (modulus,) = Library([tmp_path]).rubber("T").modulus.complex_pa(np.array([1e30]), 0.0)
    assert modulus.real == pytest.approx(2000e6 / 3.0)


def test_surfaces_arrive_as_classes_of_the_physics(tmp_path: Path) -> None:
    packaged = Library([recipes.FOLDER])
    s0 = packaged.surface("S0").spectrum
    assert isinstance(s0, SelfAffine)
    assert (s0.rms_height_m, s0.rms_slope) == (pytest.approx(20e-6, rel=1e-3), pytest.approx(1.0272, rel=1e-4))
    road = packaged.surface("road")
    assert road.spectrum is None and road.coarse is not None and road.fine is not None
    assert (road.coarse.wavelength_m, road.coarse.ra_m) == (pytest.approx(9.9e-3), pytest.approx(0.8e-3))
    folder = tmp_path / "surfaces"
    folder.mkdir()
    (folder / "r.yaml").write_text("name: R\nradial: {rows: [[1e4, 1e-18], [1e5, 1e-21]]}\n", encoding="utf-8")
    spectrum = Library([tmp_path]).surface("R").spectrum
    assert isinstance(spectrum, TabulatedSpectrum) and spectrum.band_1_m == (1e4, 1e5)


def test_files_of_a_folder_below_are_found(tmp_path: Path) -> None:
    compound(tmp_path, "2/a.yaml", "deep")
    assert Library([tmp_path]).compound("deep").model.name == "deep"


def test_a_laboratory_s_folder_that_is_not_there_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "absent"))
    with pytest.raises(InvalidSource, match=r"TESTER_MATERIALS:1:1: .* is no folder"):
        Library.beside(tmp_path / "r.yaml")
