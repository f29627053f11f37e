"""The figures as one table for people, in a terminal or in Markdown, and as JSON for programs."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from bench.figures import Figure, Verdict, number

Results = Mapping[str, Sequence[Figure]]
"""Figures by topic."""

HEADER = ("topic", "figure", "median", "min", "max", "unit", "limit", "")
_LEFT = (True, True, False, False, False, True, True, True)


def table(results: Results, machine: Mapping[str, str | int]) -> str:
    """Return machine, figures and a last line with the misses."""
    rows = [_row(topic, figure) for topic, figures in results.items() for figure in figures]
    widths = [max(len(row[i]) for row in (HEADER, *rows)) for i in range(len(HEADER))]
    lines = [", ".join(f"{key}: {value}" for key, value in machine.items()), ""]
    lines += [_line(row, widths) for row in (HEADER, tuple("-" * width for width in widths), *rows)]
    lines += ["", *_summary(results)]
    return "\n".join(lines)


def as_markdown(results: Results, machine: Mapping[str, str | int]) -> str:
    """Return machine and figures as Markdown, for docs/performance.md."""
    rows = [_row(topic, figure) for topic, figures in results.items() for figure in figures]
    lines = [", ".join(f"{key}: {value}" for key, value in machine.items()), ""]
    lines.append(_cells(HEADER))
    lines.append("|" + "".join("---|" if left else "---:|" for left in _LEFT))
    lines += [_cells(row) for row in rows]
    lines += ["", *(line.replace("  ", "- ", 1) for line in _summary(results))]
    return "\n".join(lines)


def as_json(results: Results, machine: Mapping[str, str | int]) -> str:
    """Return everything as one JSON object; a figure that is not available has null for its numbers."""
    figures = [_record(topic, figure) for topic, found in results.items() for figure in found]
    record = {"machine": dict(machine), "figures": figures, "missed": missed(results)}
    return json.dumps(record, indent=2, ensure_ascii=False)


def missed(results: Results) -> list[str]:
    """Return ``topic: figure`` of all misses."""
    return [f"{topic}: {figure.name}" for topic, found in results.items() for figure in found if figure.missed]


def _row(topic: str, figure: Figure) -> tuple[str, ...]:
    middle = ("-", "-", "-")
    if figure.runs:
        middle = number(figure.median), number(figure.least), number(figure.greatest)
    limit = "" if figure.limit is None else str(figure.limit)
    end = figure.verdict.value
    if figure.note:
        end = f"{end}: {figure.note}" if end else figure.note
    return topic, figure.name, *middle, figure.unit, limit, end


def _line(row: Sequence[str], widths: Sequence[int]) -> str:
    cells = (
        cell.ljust(width) if left else cell.rjust(width)
        for cell, width, left in zip(row, widths, _LEFT, strict=True)
    )  # fmt: skip
    return "  ".join(cells).rstrip()


def _cells(row: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |"


def _summary(results: Results) -> list[str]:
    asked = [figure for found in results.values() for figure in found if figure.limit is not None or figure.failed]
    bad = missed(results)
    if not bad:
        return [f"all {len(asked)} figures with a limit hold" if asked else "no figure has a limit"]
    return [f"missed, {len(bad)} of {len(asked)}:", *(f"  {name}" for name in bad)]


def _record(topic: str, figure: Figure) -> dict[str, object]:
    known = bool(figure.runs)
    limit = figure.limit
    return {
        "topic": topic,
        "name": figure.name,
        "unit": figure.unit,
        "median": figure.median if known else None,
        "min": figure.least if known else None,
        "max": figure.greatest if known else None,
        "runs": list(figure.runs),
        "limit": None if limit is None else {"kind": limit.kind, "value": limit.value, "worst": limit.worst},
        "verdict": "shown" if figure.verdict is Verdict.SHOWN else figure.verdict.name.lower(),
        "note": figure.note,
    }
