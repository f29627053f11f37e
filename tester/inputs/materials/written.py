"""Writes an instrument's data as a file of our own, with its origin.

The numbers are in the file itself, so that it is complete without its source; the hash identifies the source.
"""

from __future__ import annotations

from tester.base.words import harmless
from tester.inputs.materials.files import DataFile, Findings
from tester.inputs.materials.measured_moduli import ModuliTable
from tester.inputs.materials.radial import RadialSpectrum


def compound_text(name: str, table: ModuliTable, data: DataFile, findings: Findings) -> str:
    """Return a compound's file with a table of moduli. ``findings``: conversions and doubts."""
    strains = table.strains_percent
    whole = all(row.strain_percent is not None for row in table.rows)
    each = whole and strains is not None and strains[0] < strains[1]
    rows = "".join(
        f"      - [{r.temperature_c!r}, {r.frequency_hz!r}, {r.storage_pa / 1e6!r}, {r.loss_pa / 1e6!r}"
        f"{f', {r.strain_percent!r}' if each else ''}]\n"
        for r in table.rows
    )
    strain = f"  strain: {strains[0]!r} %\n" if whole and strains is not None and strains[0] == strains[1] else ""
    closing = "What else is known belongs here: formulation (phr), batch, cure, density, hardness, Tg, decade_k, shear."
    return _head("Moduli imported from", "imported from", name, data, findings, closing) + (
        f"moduli:\n{strain}"
        "  table:\n"
        f"    columns: [temperature degC, frequency Hz, E' MPa, E'' MPa{', strain %' if each else ''}]\n"
        f"    rows:\n{rows}"
    )


def surface_text(name: str, spectrum: RadialSpectrum, data: DataFile, findings: Findings) -> str:
    """Return a surface's file with a spectrum as a table. ``findings``: detrending and doubts."""
    points = zip(spectrum.q_1_m.tolist(), spectrum.power_m4.tolist(), strict=True)
    rows = "".join(f"    - [{q!r}, {power!r}]\n" for q, power in points)
    closing = f"rms height {spectrum.rms_height_m * 1e6:.4g} um, rms slope {spectrum.rms_slope:.4g}."
    return _head("Spectrum of the scan", "scan", name, data, findings, closing) + (
        "radial:\n"
        "  columns: q 1/m, C m4\n"
        f"  rows:\n{rows}"
    )


def _head(title: str, source: str, name: str, data: DataFile, findings: Findings, closing: str) -> str:
    """Return a file's comments and its keys down to the doubts."""
    origin = _line(data.name)
    comments = [f"{title} {origin}, SHA-256", f"{data.sha256}.", *map(_line, findings.notes), closing]
    return "".join(f"# {comment}\n" for comment in comments) + (
        f"name: {_quoted(name)}\n"
        f"source: {_quoted(f'{source} {origin}')}\n"
        f"{_doubts(findings)}"
    )


def _doubts(findings: Findings) -> str:
    if not findings.lasting:
        return ""
    return "doubts:\n" + "".join(f"  - {_quoted(_line(doubt))}\n" for doubt in findings.lasting)


def _line(text: str) -> str:
    return " ".join(harmless(text).split())


def _quoted(text: str) -> str:
    """Return a text quoted for YAML, whatever its content."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
