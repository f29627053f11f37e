"""Compounds and surfaces in words, for `tester materials show`."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite, pi
from typing import TYPE_CHECKING, cast

if TYPE_CHECKING:
    from tester.inputs.materials.compound import LoadedCompound
    from tester.inputs.materials.material_schema import CompoundModel
    from tester.inputs.materials.surface_file import LoadedSurface
    from tester.report.chart import Chart

    Loaded = LoadedCompound | LoadedSurface

REFERENCE_C = 20.0
"""Temperature of moduli over the frequency: Grosch's, and that of master curves."""
WIDE = 9
"""Characters of a line's label."""


def summary_of(material: Loaded) -> dict[str, object]:
    """Return a material as JSON."""
    file, model = material.file, material.model
    return {
        "role": file.role,
        "name": file.name,
        "file": str(file.path),
        "sha256": file.sha256,
        "data": {data.name: data.sha256 for data in file.data},
        "holds": material.holds(),
        "notes": list(material.notes),
        "doubts": [str(doubt) for doubt in file.doubts],
        "facts": _facts(material),
        "content": model.model_dump(mode="json", by_alias=True, exclude_none=True, exclude={"moduli", "radial"}),
    }


def lines_of(material: Loaded) -> Iterable[str]:
    """Yield a material in words, a line each."""
    from tester.inputs.materials.material_schema import CompoundModel

    file, model = material.file, material.model
    yield f"{file.name}: {file.role}, {file.path}"
    yield f"sha256   {file.sha256}"
    for data in file.data:
        yield f"data     {data.name}, sha256 {data.sha256}"
    yield f"holds    {material.holds()}"
    for label, text in (("note", model.note), ("source", model.source)):
        if text:
            yield f"{label:8} {text}"
    for key, text in model.sources.items():
        yield f"         {key}: {text}"
    if isinstance(model, CompoundModel):
        yield from _of_compound(model)
        yield from _of_moduli(cast("LoadedCompound", material))
    else:
        yield from _of_surface(cast("LoadedSurface", material))
    for note in material.notes:
        yield f"noted    {note}"
    for doubt in file.doubts:
        yield f"doubt    {doubt}"


def _of_compound(model: CompoundModel) -> Iterable[str]:
    if model.formulation:
        yield "made of  " + ", ".join(f"{name} {phr:g} phr" for name, phr in model.formulation.items())
    if model.Tg is not None:
        yield f"Tg       {model.Tg:g} degC"
    if model.shear is not None:
        s = model.shear
        yield f"shear    tau_s0 {s.tau_s0 / 1e3:g} kPa, v_c {s.v_c:g} m/s, n {s.n:g}, ratio {s.ratio:g}"
    if model.over_temperature is not None:
        t = model.over_temperature
        law = f"alpha {t.alpha:g}, beta {t.beta:g} 1/K2, gamma {t.gamma:g}, Tm {t.Tm:g} degC"
        yield f"over temperature  {law}; {t.least:g} to {t.most:g} degC"


def _facts(material: Loaded) -> dict[str, object]:
    """Return what the data of a material give of themselves: the labels and words of ``lines_of``."""
    from tester.inputs.materials.material_schema import CompoundModel

    compound = isinstance(material.model, CompoundModel)
    lines = _of_moduli(cast("LoadedCompound", material)) if compound else _of_surface(cast("LoadedSurface", material))
    facts: dict[str, object] = {}
    for line in lines:
        label, words = line[:WIDE].strip(), line[WIDE:].strip()
        facts[label] = [*cast("list[str]", facts.get(label, [])), words]
    return facts


def _of_moduli(loaded: LoadedCompound) -> Iterable[str]:
    """Yield the facts of moduli, and their maxima over the frequency at 20 degC."""
    from tester.inputs.materials.sweep_facts import fact_words, sweep_facts

    if loaded.table is not None:
        for label, words in fact_words(sweep_facts(loaded.table)):
            yield f"{label:{WIDE}}{words}"
    if loaded.model.moduli is not None and loaded.model.moduli.constant is None:
        yield from _of_formula(loaded)
        yield from _over_frequency(loaded)


def _of_formula(loaded: LoadedCompound) -> Iterable[str]:
    from tester.inputs.materials.formula_facts import formula_facts, formula_words
    from tester.inputs.materials.library import MissingModuliError, rubber_of

    if loaded.table is not None:
        return
    try:
        facts = formula_facts(rubber_of(loaded))
    except (MissingModuliError, ValueError):
        return  # the maxima over the frequency state the reason
    for label, words in formula_words(facts) if facts is not None else ():
        yield f"{label:{WIDE}}{words}"


def _over_frequency(loaded: LoadedCompound) -> Iterable[str]:
    import numpy as np

    from tester.analysis.master_curve.rules import GRIT_M, JUMP_M, rules_of
    from tester.inputs.materials.library import MissingModuliError, rubber_of

    try:
        modulus = rubber_of(loaded).modulus
        jump, grit = (rule.speed_m_s for rule in rules_of(modulus, REFERENCE_C, ()))
    except (MissingModuliError, ValueError) as error:
        yield f"{'unknown':{WIDE}}maxima at {REFERENCE_C:g} degC: {error}"
        return
    if isfinite(grit):
        (at,) = modulus.complex_pa(np.array([2.0 * pi * grit / GRIT_M]), REFERENCE_C)
        yield f"{'at 20 °C':{WIDE}}tan delta has its peak, {at.imag / at.real:.3g}, at {grit / GRIT_M:.3g} Hz"
    else:
        yield f"{'unknown':{WIDE}}frequency of tan delta's peak at {REFERENCE_C:g} degC: outside what the moduli cover"
    if isfinite(jump):
        yield f"{'at 20 °C':{WIDE}}the loss modulus has its peak at {jump / JUMP_M:.3g} Hz"


def _of_surface(loaded: LoadedSurface) -> Iterable[str]:
    """Yield roughness and waves: of the spectrum as a law takes it, and the waves of the file or found in it."""
    from sim.physics.materials import length_text
    from tester.inputs.materials.library import surface_of

    surface = surface_of(loaded)
    if surface.spectrum is not None:
        rms, slope = surface.spectrum.rms_height_m, surface.spectrum.rms_slope
        yield f"rough    rms {length_text(rms)}, rms slope {slope:.3g}"
    if surface.coarse is None or surface.fine is None:
        yield "waves    none: the spectrum is too narrow for two, and greta needs two"
        return
    if surface.split_m is None:
        yield "waves    as the file states them (length, Ra):"
    else:
        yield (
            f"waves    found in the spectrum, divided at {length_text(surface.split_m)}; each has rms height and slope"
            " of its side (length, amplitude, which counts as Ra):"
        )
    for label, wave in (("coarse", surface.coarse), ("fine", surface.fine)):
        yield f"{label:8} {length_text(wave.wavelength_m)}, {length_text(wave.ra_m)}"


def material_chart(material: Loaded, celsius: float) -> Chart:
    """Return the figure of a material. Raises ValueError for one without moduli or spectrum."""
    from tester.cli.material_charts import compound_chart, surface_chart, unshifted_chart
    from tester.inputs.materials.library import MissingModuliError, rubber_of, surface_of
    from tester.inputs.materials.material_schema import CompoundModel

    if not isinstance(material.model, CompoundModel):
        loaded = cast("LoadedSurface", material)
        return surface_chart(surface_of(loaded), loaded.radial)
    compound = cast("LoadedCompound", material)
    rows = compound.table.rows if compound.table is not None else ()
    try:
        return compound_chart(rubber_of(compound), rows, celsius)
    except MissingModuliError as error:
        if not rows:
            raise
        return unshifted_chart(compound.model.name, rows, str(error).rpartition(": ")[2])
