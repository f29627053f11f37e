"""Imports as files of ours: what was read of an instrument's file, written down with where it is from.

The numbers stand in the file itself, so that it is whole without what it was made of; the hash says which that was.
"""

from __future__ import annotations

from tester.base.words import harmless
from tester.inputs.materials.files import DataFile, Findings
from tester.inputs.materials.moduli import ModuliTable
from tester.inputs.materials.radial import RadialSpectrum


def compound_text(name: str, table: ModuliTable, data: DataFile, found: Findings) -> str:
    """Return a compound's file with a table of moduli. ``found``: what was converted, and what is doubtful."""
    rows = "".join(
        f"      - [{r.temperature_c!r}, {r.frequency_hz!r}, {r.storage_pa / 1e6!r}, {r.loss_pa / 1e6!r}]\n"
        for r in table.rows
    )
    head = [
        f"# Moduli imported from {_line(data.name)}, SHA-256",
        f"# {data.sha256}.",
        *(f"# {_line(one)}" for one in found.notes),
        "# What else is known belongs here: formulation (phr), batch, cure, density, hardness, Tg, decade_k, shear.",
    ]
    return "\n".join(head) + (
        f"\nname: {_quoted(name)}\n"
        f"source: {_quoted(f'imported from {_line(data.name)}')}\n"
        f"{_doubts(found)}"
        "moduli:\n"
        "  table:\n"
        "    columns: [temperature degC, frequency Hz, E' MPa, E'' MPa]\n"
        f"    rows:\n{rows}"
    )


def surface_text(name: str, spectrum: RadialSpectrum, data: DataFile, found: Findings) -> str:
    """Return a surface's file with a spectrum as a table. ``found``: what was taken off, and what is doubtful."""
    points = zip(spectrum.q_1_m.tolist(), spectrum.power_m4.tolist(), strict=True)
    rows = "".join(f"    - [{q!r}, {power!r}]\n" for q, power in points)
    head = [
        f"# Spectrum of the scan {_line(data.name)}, SHA-256",
        f"# {data.sha256}.",
        *(f"# {_line(one)}" for one in found.notes),
        f"# rms height {spectrum.rms_height_m * 1e6:.4g} um, rms slope {spectrum.rms_slope:.4g}.",
    ]
    return "\n".join(head) + (
        f"\nname: {_quoted(name)}\n"
        f"source: {_quoted(f'scan {_line(data.name)}')}\n"
        f"{_doubts(found)}"
        "radial:\n"
        "  columns: q 1/m, C m4\n"
        f"  rows:\n{rows}"
    )


def _doubts(found: Findings) -> str:
    if not found.lasting:
        return ""
    return "doubts:\n" + "".join(f"  - {_quoted(_line(one))}\n" for one in found.lasting)


def _line(text: str) -> str:
    return " ".join(harmless(text).split())


def _quoted(text: str) -> str:
    """Return a text as YAML takes it for one, whatever is in it."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'
