"""Samples as a Parquet file, written block by block; pyarrow comes with the extra ``parquet``."""

from __future__ import annotations

from importlib import import_module
from itertools import islice
from math import isfinite
from typing import Any, BinaryIO

from tester.base.plugins import MissingExtraError, needs
from tester.base.quantities import Channel
from tester.results.tables import OWNER, RISK_COLUMN
from tester.store.records import StoredRepeat
from tester.store.run_reader import RunReader, SampleBlock

_BLOCKS_PER_GROUP = 128
"""Row groups of up to 65,536 samples: 13 MB in memory."""

_Columns = dict[str, list[float | None]]


def write_parquet(reader: RunReader, file: BinaryIO) -> None:
    """Write every recorded sample to ``file``: float64 columns named as in samples.csv, ids as int64.

    Condition, repeat and attempt are null for samples outside repeats. A run with an accepted risk has a further column
    that names it, as in its other tables. Raises StoreError, OSError, and MissingExtraError without pyarrow.
    """
    pa, pq = _module("pyarrow"), _module("pyarrow.parquet")
    owners = {repeat.key: repeat for repeat in reader.repeats(attempts=True)}
    whole, real = pa.int64(), pa.float64()
    channels = reader.quantities().recorded
    fields = [(channel.name, whole if channel.whole else real) for channel in channels] + [
        (name, whole) for name in OWNER
    ]
    risk = reader.run().info.risk
    if risk:
        fields.append((RISK_COLUMN, pa.string()))
    schema = pa.schema(fields)
    with pq.ParquetWriter(file, schema) as writer:
        blocks = reader.sample_blocks()
        while group := list(islice(blocks, _BLOCKS_PER_GROUP)):
            columns: dict[str, list[float | None] | list[str]] = {**_columns(group, owners, channels)}
            if risk:
                columns[RISK_COLUMN] = [risk] * sum(block.rows for block in group)
            writer.write_table(pa.table(columns, schema=schema))


def _columns(group: list[SampleBlock], owners: dict[int, StoredRepeat], channels: tuple[Channel, ...]) -> _Columns:
    columns: _Columns = {name: [] for name in (*(channel.name for channel in channels), *OWNER)}
    for block in group:
        for channel_ in channels:
            values = block.columns[channel_.name]
            columns[channel_.name].extend(map(_whole, values) if channel_.whole else values)
        owner = owners.get(block.repeat_key)
        for name in OWNER:
            value = None if owner is None else getattr(owner, name)
            columns[name].extend([value] * block.rows)
    return columns


def _whole(value: float) -> int | None:
    return int(value) if isfinite(value) else None


def _module(name: str) -> Any:
    """Return pyarrow or a module of it, which have no types; raises MissingExtraError where it is not installed."""
    try:
        return import_module(name)
    except ModuleNotFoundError as error:
        raise MissingExtraError(needs("the format parquet", "pyarrow", "parquet")) from error
