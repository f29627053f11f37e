"""Conditions as JSON, one a line: what a program reads that wants no table."""

import json
from typing import BinaryIO

from tester.base.axes import condition_words
from tester.results.formats import Format, Record


def write(record: Record, file: BinaryIO) -> None:
    """Write a line for every condition that has a value."""
    for row in record.results.rows:
        if row.result.ok:
            found = {"condition": condition_words(row.info.setpoint), "compound": row.info.compound,
                     "mu": round(row.result.mu, 4)}
            file.write(json.dumps(found).encode() + b"\n")


JSON = Format("json", "conditions.jsonl", "conditions for programs, a line each", write)
