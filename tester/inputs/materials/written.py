"""Imports as our own files: the data of an instrument's file, with its origin.

The numbers are in the file itself, so that it is complete without its source; the hash identifies the source.
"""

from __future__ import annotations

from tester.base.words import harmless
from tester.inputs.materials.files import DataFile, Findings
from tester.inputs.materials.measured_moduli import ModuliTable
from tester.inputs.materials.radial import RadialSpectrum


def compound_text(name: str, table: ModuliTable, data: DataFile, findings: Findings) -> str:
    """Return a compound's file with a table of moduli. ``findings``: conversions and doubts."""
    rows = "".join(
        f"      - [{r.temperature_c!r}, {r.frequency_hz!r}, {r.storage_pa / 1e6!r}, {r.loss_pa / 1e6!r}]\n"
        for r in table.rows
    )
    head = [
        f"# Moduli imported from {_line(data.name)}, SHA-256",
        f"# {data.sha256}.",
        *(f"# {_line(note)}" for note in findings.notes),
        "# What else is known belongs here: formulation (phr), batch, cure, density, hardness, Tg, decade_k, shear.",
    ]
    return "\n".join(head) + (
        f"\nname: {_quoted(name)}\n"
        f"source: {_quoted(f'imported from {_line(data.name)}')}\n"
        f"{_doubts(findings)}"
        "moduli:\n"
        "  table:\n"
        "    columns: [temperature degC, frequency Hz, E' MPa, E'' MPa]\n"
        f"    rows:\n{rows}"
    )


def surface_text(name: str, spectrum: RadialSpectrum, data: DataFile, findings: Findings) -> str:
    """Return a surface's file with a spectrum as a table. ``findings``: detrending and doubts."""
    points = zip(spectrum.q_1_m.tolist(), spectrum.power_m4.tolist(), strict=True)
    rows = "".join(f"    - [{q!r}, {power!r}]\n" for q, power in points)
    head = [
        f"# Spectrum of the scan {_line(data.name)}, SHA-256",
        f"# {data.sha256}.",
        *(f"# {_line(note)}" for note in findings.notes),
        f"# rms height {spectrum.rms_height_m * 1e6:.4g} um, rms slope {spectrum.rms_slope:.4g}.",
    ]
    return "\n".join(head) + (
        f"\nname: {_quoted(name)}\n"
        f"source: {_quoted(f'scan {_line(data.name)}')}\n"
        f"{_doubts(findings)}"
        "radial:\n"
        "  columns: q 1/m, C m4\n"
        f"  rows:\n{rows}"
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
