"""Laws made of the recipe's compound and abrasive: checked before a run, shown in an estimate, used by the twin."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from sim.physics import laws
from sim.physics.laws import LawSetting, make
from sim.physics.materials import Surface
from tester.base.source import InvalidSource
from tester.base.user_folders import CACHE
from tester.inputs.materials.library import Library
from tester.inputs.recipe.loader import load_checked
from tester.kinds import load_rig
from tester.kinds.specimen_on_track.axes import held_by
from tester.kinds.specimen_on_track.recipe.estimate import LIKELY_MU
from tester.kinds.specimen_on_track.recipe.part import PART
from tester.kinds.specimen_on_track.rig import TrackConfig
from tester.machine.run import Outcome
from tests.tester.kinds.specimen_on_track.bench import GROSCH, TrackBench

ON = GROSCH.replace("specimens:", "abrasive: {name: S0}\nspecimens:")


@pytest.fixture(autouse=True, scope="module")
def tables(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Tables of this module lie in a folder of its own."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(CACHE, str(tmp_path_factory.mktemp("cache")))
        yield


def problems(tmp_path: Path, text: str, *overrides: str) -> list[str]:
    """Return the problems of a recipe, with the lines."""
    path = tmp_path / "recipe.yaml"
    path.write_text(text, encoding="utf-8")
    try:
        load_checked(path, load_rig("grosch", overrides), PART)
    except InvalidSource as error:
        return [f"{one.line}: {one.message}" for one in error.problems]
    return []


def test_a_run_measures_the_values_of_the_law() -> None:
    bench = TrackBench("grosch", GROSCH, ("sim.scatter=0", "sim.law=persson", "sim.surface=S0")).to_the_end()
    assert bench.run.outcome is Outcome.DONE and not bench.kept.trips
    law = make("persson", "SBR", setting=LawSetting(Library.beside(), "S0", 100.0))
    steps = {step.condition: held_by(step.setpoint) for step in bench.plan.conditions()}
    assert len(bench.kept.results) == 2
    for condition, result in bench.kept.results:
        held = steps[condition]
        expected = law.mu(result.means["contact_c"], held.load_n, held.track_m_s)
        assert result.valid and result.mu_resultant == pytest.approx(expected, rel=0.01)


class BySurface:
    """A law of materials without tables: a coefficient for each surface."""

    def __init__(self, surface: Surface) -> None:
        self.coefficient = {"S0": 0.9, "glass": 0.6}[surface.name]

    def mu(self, temperature_c: float, load_n: float, slip_m_s: float) -> float:
        return self.coefficient


def test_a_run_measures_every_surface_by_its_own_law(monkeypatch: pytest.MonkeyPatch) -> None:
    known = laws._LAWS  # pyright: ignore[reportPrivateUsage]
    monkeypatch.setitem(known, "by_surface", laws.OfMaterials(lambda rubber, on, area, figures: BySurface(on)))
    text = GROSCH.replace("{name: one,", "{name: one, surface: [S0, glass],")
    bench = TrackBench("grosch", text, ("sim.scatter=0", "sim.law=by_surface")).to_the_end()
    assert bench.run.outcome is Outcome.DONE and not bench.kept.trips
    surfaces = {step.condition: held_by(step.setpoint).surface for step in bench.plan.conditions()}
    measured = [(surfaces[condition], result.mu_resultant) for condition, result in bench.kept.results]
    assert measured == [(name, pytest.approx(mu, rel=0.01)) for name, mu in
                        (("S0", 0.9), ("S0", 0.9), ("glass", 0.6), ("glass", 0.6))]  # fmt: skip


def test_a_bare_track_is_not_prepared(monkeypatch: pytest.MonkeyPatch) -> None:
    known = laws._LAWS  # pyright: ignore[reportPrivateUsage]
    monkeypatch.setitem(known, "by_surface", laws.OfMaterials(lambda rubber, on, area, figures: BySurface(on)))
    world = TrackBench("grosch", GROSCH, ("sim.law=by_surface",)).world
    world.install(1, "SBR")
    with pytest.raises(ValueError, match="needs a surface: cover the track first"):
        world.prepare("dry")
    world.cover("glass")
    world.prepare("wet")
    assert world.plant.interface == "wet"


def test_a_rig_that_states_its_surface_is_not_covered_with_another(tmp_path: Path) -> None:
    text = GROSCH.replace("{name: one,", "{name: one, surface: [S0, glass],")
    (said,) = problems(tmp_path, text, "sim.law=persson", "sim.surface=S0")
    assert 'surface: the simulated track is covered with "S0" throughout' in said
    (said,) = problems(tmp_path, text.replace("glass", "slate"), "sim.law=persson")
    assert 'no file of a surface has the name "slate"' in said


def test_the_table_is_kept_for_the_next_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(CACHE, str(tmp_path))
    config = TrackConfig.of(load_rig("grosch", ("sim.law=persson", "sim.surface=S0")))
    for _ in range(2):
        bench = TrackBench("grosch", GROSCH, ("sim.law=persson", "sim.surface=S0"))
        bench.world.plant.install(0, "SBR")
    assert len(list((tmp_path / "laws").glob("*.table"))) == 1 and config.sim.of_materials


def test_a_recipe_of_known_materials_is_valid(tmp_path: Path) -> None:
    assert problems(tmp_path, ON, "sim.law=persson") == []


@pytest.mark.parametrize(
    ("change", "law", "said"),
    [
        (("SBR", "XY"), "persson", '4: compound: sim.law persson: no file of a compound has the name "XY"'),
        (("S0", "slate"), "persson", '4: compound: sim.law persson: no file of a surface has the name "slate"'),
        (("S0", "road"), "persson", "4: compound: sim.law persson: surface 'road' has no spectrum"),
        (("SBR", "1#"), "persson", "holds no moduli"),
        (("abrasive: {name: S0}\n", ""), "persson", "needs a surface (expected the recipe's abrasive, or sim.surface)"),
        (("S0", "road"), "greta", "4: compound: sim.law greta: compound 'SBR': greta needs its shear"),
        (("SBR", "XY"), "wlf_bell", "4: compound: sim.law wlf_bell: no rubber 'XY' among sim.rubbers"),
    ],
)
def test_materials_unfit_for_the_law_are_reported_at_their_line(
    tmp_path: Path, change: tuple[str, str], law: str, said: str
) -> None:
    found = problems(tmp_path, ON.replace(*change), f"sim.law={law}")
    assert any(said in one for one in found), found


def test_moduli_that_end_too_early_for_a_track_are_reported(tmp_path: Path) -> None:
    (tmp_path / "compounds").mkdir()
    rows = "".join(f"      - [{t}, 1, 1e8, 1e7]\n" for t in range(0, 41, 10))
    text = "name: short\nsource: made up\ndecade_k: 8\nmoduli:\n"
    text += "  table:\n    columns: [temperature degC, frequency Hz, E' Pa, E'' Pa]\n    rows:\n" + rows
    file = tmp_path / "compounds" / "short.yaml"
    file.write_text(text, encoding="utf-8")
    recipe = ON.replace("SBR", "short")
    (found,) = problems(tmp_path, recipe, "sim.law=persson")
    assert "is known from" in found and "expected moduli with beyond: hold" in found
    file.write_text(text.replace("moduli:\n", "moduli:\n  beyond: hold\n"), encoding="utf-8")
    assert problems(tmp_path, recipe, "sim.law=persson") == []


def test_an_estimate_asks_the_law_on_the_recipes_surface() -> None:
    config = TrackConfig.of(load_rig("grosch", ("sim.law=persson",)))
    from tests.tester.inputs.recipe.texts import load_recipe

    plan = PART.expand(load_recipe(ON, PART, "bench.yaml").recipe, config)
    estimator = PART.estimator(config)
    held = held_by(next(iter(plan.conditions())).setpoint)
    assert estimator.mu_of("SBR", held) == LIKELY_MU
    estimator.walk(plan)
    law = make("persson", "SBR", setting=LawSetting(Library.beside(), "S0", 100.0))
    assert estimator.mu_of("SBR", held) == pytest.approx(law.mu(held.temperature_c, held.load_n, held.track_m_s))
