"""Kept laws made of materials: `persson` and `greta` from a fit to a file, and from the file to every use."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import recipes
from sim.physics import laws
from sim.physics.greta import greta
from sim.physics.materials import Shear
from sim.physics.persson import persson
from tester.cli.main import invoke
from tester.inputs.kept_laws.law_materials import read_law
from tester.inputs.kept_laws.law_value import load_law
from tester.inputs.materials.library import Library
from tester.inputs.rig.profiles import extension_law
from tests.tester.kinds.specimen_on_track.fit.made import made_track_run

pytest.importorskip("scipy", reason="needs the extra `report`")

LIBRARY = Library([recipes.FOLDER])
AREA_MM2 = 50.0
SPEEDS_M_S = tuple(10.0 ** (-4.0 + 0.5 * i) for i in range(8))
MATERIALS = {"persson": ("SBR", "silicon carbide"), "greta": ("tread", "road")}
AT = (20.0, 20.0, 0.01)
POINT = ("--slip", "10 mm/s", "--load", "20 N", "--temperature", "20 degC")


def true_law(form: str) -> laws.FrictionLaw:
    """Return the law that the conditions come from."""
    rubber, surface = (LIBRARY.rubber(MATERIALS[form][0]), LIBRARY.surface(MATERIALS[form][1]))
    if form == "persson":
        return persson(rubber, surface, AREA_MM2, {})
    return greta(rubber, surface, {"area": AREA_MM2})


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a run and a kept law of each form."""
    home = tmp_path_factory.mktemp("kept")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(home)
        patch.delenv("TESTER_MATERIALS", raising=False)
        for form, (compound, surface) in MATERIALS.items():
            law = true_law(form)

            def mu(celsius: float, speed_m_s: float, law: laws.FrictionLaw = law) -> float:
                return law.mu(celsius, 20.0, speed_m_s)

            made_track_run(
                home / "runs" / form, (10.0, 20.0, 30.0, 40.0), SPEEDS_M_S, mu, compounds=(compound,), repeats=3,
                metadata={"abrasive": surface},
            )  # fmt: skip
            assert invoke(["fit", form, "--law", form, "--given", f"area={AREA_MM2:g}", "-o", f"{form}.yaml"]) in (0, 1)
    return home


@pytest.fixture
def home(kept: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of that folder, as the working folder."""
    shutil.copytree(kept, tmp_path / "home")
    monkeypatch.chdir(tmp_path / "home")
    monkeypatch.delenv("TESTER_MATERIALS", raising=False)
    return tmp_path / "home"


def by_hand(form: str, figures: dict[str, float]) -> laws.FrictionLaw:
    """Return the law with a file's figures, put together here."""
    rubber, surface = (LIBRARY.rubber(MATERIALS[form][0]), LIBRARY.surface(MATERIALS[form][1]))
    if form == "persson":
        spectrum = replace(surface.spectrum, q1_1_m=figures["q1"])  # type: ignore[type-var]
        return persson(rubber, replace(surface, spectrum=spectrum), AREA_MM2, {})
    assert rubber.shear is not None
    shear = Shear(figures["tau_s0"], figures["v_c"], figures["n"], rubber.shear.ratio)
    return greta(replace(rubber, shear=shear), surface, {"area": AREA_MM2})


@pytest.mark.parametrize("form", MATERIALS)
def test_a_law_that_is_kept_and_read_again_predicts_like_its_figures(
    form: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = load_law(home / f"{form}.yaml").model
    assert (model.form, model.compound, model.surface, model.area) == (form, *MATERIALS[form], AREA_MM2)
    assert invoke(["predict", "--law", f"{form}.yaml", *POINT, "--json"]) == 0
    mu = json.loads(capsys.readouterr().out)["mu"]
    assert mu == pytest.approx(by_hand(form, model.figures()).mu(*AT), rel=1e-9)
    assert mu == pytest.approx(true_law(form).mu(*AT), rel=0.05)


@pytest.mark.parametrize("form", MATERIALS)
def test_a_simulated_rig_makes_it_of_its_own_materials(form: str, home: Path) -> None:
    maker = extension_law(str(home / f"{form}.yaml"))
    assert isinstance(maker, laws.OfMaterials) and maker.slow
    rubber, surface = (LIBRARY.rubber(MATERIALS[form][0]), LIBRARY.surface(MATERIALS[form][1]))
    made = maker.make(rubber, surface, AREA_MM2, {})
    assert made.mu(*AT) == pytest.approx(read_law(home / f"{form}.yaml").mu(*AT), rel=1e-9)
    with pytest.raises(ValueError, match="is the law on"):
        maker.make(rubber, LIBRARY.surface("S0"), AREA_MM2, {})
    with pytest.raises(ValueError, match="is the law of"):
        maker.make(LIBRARY.rubber("ABR"), surface, AREA_MM2, {})


def test_a_compound_that_has_changed_since_the_fit_is_named(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = LIBRARY.compound("SBR").file.text
    (home / "compounds").mkdir()
    (home / "compounds" / "sbr.yaml").write_text(f"# ours\n{text}", encoding="utf-8")
    assert invoke(["predict", "--law", "persson.yaml", *POINT]) == 0
    assert "compound SBR has changed since the fit of persson.yaml" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (lambda text: text.replace('compound: "SBR"', 'compound: "SBX"'), "SBX"),
        (
            lambda text: "".join(line for line in text.splitlines(True) if "made_of" not in line),
            "persson needs made_of",
        ),
    ],
    ids=["an unknown compound", "no hashes"],
)
def test_a_file_without_its_materials_is_refused(
    change: Callable[[str], str], fault: str, home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = home / "persson.yaml"
    path.write_text(change(path.read_text(encoding="utf-8")), encoding="utf-8")
    assert invoke(["predict", "--law", "persson.yaml", *POINT]) == 3
    assert fault in capsys.readouterr().err


def test_the_area_of_a_law_of_materials_is_that_of_its_fit(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert invoke(["fit", "greta", "--law", "greta", "--area", "50 mm2", "-o", "more.yaml"]) == 1
    assert "--given area=MM2" in capsys.readouterr().err


def test_a_run_is_compared_with_it_and_drawn_beside_it(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("matplotlib", reason="needs the extra `report`")
    assert invoke(["compare", "persson", "persson.yaml"]) == 0
    assert "24 of 24 inside the 95 % interval of persson.yaml" in capsys.readouterr().out
    assert invoke(["figure", "persson", "--law", "persson.yaml"]) == 0


def own_compound(home: Path) -> Path:
    """Put a copy of SBR under another name into a run's folder, as its own run would; return the folder."""
    run = home / "runs" / "own"
    law = true_law("persson")

    def mu(celsius: float, speed_m_s: float) -> float:
        return law.mu(celsius, 20.0, speed_m_s)

    made_track_run(
        run, (10.0, 20.0, 30.0, 40.0), SPEEDS_M_S, mu, compounds=("own",), repeats=3,
        metadata={"abrasive": "silicon carbide"},
    )  # fmt: skip
    (run / "compounds").mkdir(exist_ok=True)
    text = (recipes.FOLDER / "compounds" / "sbr.yaml").read_text(encoding="utf-8")
    assert text.count("name: SBR\n") == 1
    (run / "compounds" / "own.yaml").write_text(text.replace("name: SBR\n", "name: own\n"), encoding="utf-8")
    return run


def test_a_fit_reads_the_materials_that_the_run_used(home: Path) -> None:
    own_compound(home)
    assert invoke(["fit", "own", "--law", "persson", "--given", f"area={AREA_MM2:g}", "-o", "own.yaml"]) in (0, 1)
    ours, theirs = load_law(home / "own.yaml"), load_law(home / "persson.yaml")
    assert ours.model.parameters["q1"].value == pytest.approx(theirs.model.parameters["q1"].value, rel=0.05)


def test_runs_with_different_files_of_one_compound_are_not_fitted_together(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = own_compound(home)
    shutil.copytree(run, home / "runs" / "other")
    changed = home / "runs" / "other" / "compounds" / "own.yaml"
    changed.write_text(changed.read_text(encoding="utf-8") + "# measured again\n", encoding="utf-8")
    assert invoke(["fit", "own", "other", "--law", "persson"]) == 1
    assert "used different files of it" in capsys.readouterr().err
