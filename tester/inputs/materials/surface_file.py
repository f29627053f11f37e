"""A surface's file: read with every problem at its line, and every doubt."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from sim.physics.materials import length_text
from tester.base.plugins import MissingExtraError
from tester.base.source import InvalidSource, Tree
from tester.inputs.materials.files import DataFile, Findings, MaterialFile, OpenedMaterial
from tester.inputs.materials.material_schema import RadialModel, ScanModel, SurfaceModel
from tester.inputs.materials.radial import RadialSpectrum
from tester.inputs.materials.surface_scan import MAX_BYTES, ScanOptions, read_scan, spectrum_of

EXPECTED = "a surface is a list of keys: name, and one of spectrum, radial, scan, waves"


@dataclass(frozen=True, slots=True)
class LoadedSurface:
    """A surface with its file; ``radial`` where its spectrum is a table or a scan's."""

    model: SurfaceModel
    file: MaterialFile
    radial: RadialSpectrum | None = None
    notes: tuple[str, ...] = ()
    """Notes on the reading of a scan."""

    def holds(self) -> str:
        """Return the source of the surface's heights, in words."""
        parts: list[str] = []
        if self.model.spectrum is not None:
            s = self.model.spectrum
            parts.append(f"self-affine, H {s.H:g}, waves of {_length(s.q1)} to {_length(s.q0)}")
        if self.radial is not None:
            q, origin = self.radial.q_1_m, "of a scan" if self.model.scan is not None else "as a table"
            parts.append(f"spectrum {origin}, {len(q)} points, waves of {_length(q[-1])} to {_length(q[0])}")
        if self.model.waves is not None:
            w = self.model.waves.coarse
            parts.append(f"waves, coarse {length_text(w.wavelength)}, Ra {length_text(w.Ra)}")
        return "; ".join(parts)


def _length(q_1_m: float) -> str:
    return length_text(2.0 * np.pi / q_1_m)


def load_surface(path: Path, name: str | None = None) -> LoadedSurface:
    """Read a surface's file; ``name`` names it in messages. Raises InvalidSource, MissingExtraError."""
    opened = OpenedMaterial(path, name, SurfaceModel, EXPECTED)
    model, findings = opened.model, opened.findings
    data: DataFile | None = None
    radial: RadialSpectrum | None = None
    if model is not None and model.radial is not None:
        radial = _table(model.radial, opened.tree, findings)
    elif model is not None and model.scan is not None:
        data = opened.data_file(path, ("scan", "file"), model.scan.file, MAX_BYTES)
        radial = _scanned(model.scan, data, path, opened.tree, findings) if data is not None else None
    file = opened.kept("surface", path, (data,) if data is not None else ())
    return LoadedSurface(opened.content(), file, radial, tuple(findings.notes))


def surface_model(text: str, name: str) -> SurfaceModel:
    """Return the content of a surface's file, without the files that it refers to. Raises InvalidSource."""
    return OpenedMaterial(text, name, SurfaceModel, EXPECTED).content()


def _table(model: RadialModel, tree: Tree, findings: Findings) -> RadialSpectrum | None:
    at = ("radial", "rows")
    for number, (q, power) in enumerate(model.rows):
        if not q > 0.0 or not power > 0.0:
            findings.refuse(tree.position((*at, number)), f"q {q:g} 1/m, C {power:g} m4: both are to be above 0")
    for number, (before, after) in enumerate(pairwise(model.rows), start=1):
        if not after[0] > before[0]:
            disorder = f"q {after[0]:g} 1/m does not rise above {before[0]:g} 1/m: a point twice, or out of order"
            findings.refuse(tree.position((*at, number)), disorder)
    if len(model.rows) < 2:
        findings.refuse(tree.position(at), f"{len(model.rows)} points are too few (expected 2 or more)")
    if findings.problems:
        return None
    q, power = np.array(model.rows, dtype=np.float64).T
    return RadialSpectrum(q, power)


def _scanned(
    model: ScanModel, data: DataFile, path: Path, tree: Tree, findings: Findings
) -> RadialSpectrum | None:
    options = ScanOptions(model.pixel, model.unit, model.detrend, "pixel: 1 um", "unit: um")
    inner = Findings(str(path.parent / data.name))
    try:
        scan = read_scan(path.parent / data.name, data.content, options, inner)
        radial = spectrum_of(scan, model.detrend, inner)
    except InvalidSource as error:
        findings.problems += error.problems
        return None
    except MissingExtraError as error:
        findings.refuse(tree.position(("scan", "file")), str(error))
        return None
    findings.take(inner)
    return radial
