"""The layout of sample blocks."""

from __future__ import annotations

import struct
import zlib
from math import inf, nan
from random import Random

import numpy as np
import pytest

from tester.store.sample_blocks import BLOCK_ROWS, pack, unpack, unpack_array


def test_a_blob_is_little_endian_columns_one_after_the_other() -> None:
    data = zlib.decompress(pack([(1.0, 2.0), (3.0, 4.0)], 2))
    assert data == struct.pack("<4d", 1.0, 3.0, 2.0, 4.0)


def test_values_come_back_bit_by_bit() -> None:
    rows = [(0.1, -0.0), (nan, inf), (5e-324, 1.7976931348623157e308)]
    columns = unpack(pack(rows, 2), 3, 2)
    assert [struct.pack("<d", x) for c in columns for x in c] == [struct.pack("<d", r[i]) for i in (0, 1) for r in rows]


def test_arrays_hold_the_same_values() -> None:
    rows = [(float(i), 2.0 * i) for i in range(7)]
    np.testing.assert_array_equal(unpack_array(pack(rows, 2), 7, 2), np.array(rows).T)


def test_a_row_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="2 values"):
        pack([(1.0, 2.0), (1.0,)], 2)


def test_a_block_of_another_length_is_refused() -> None:
    with pytest.raises(ValueError, match="not 3 rows"):
        unpack(pack([(1.0, 2.0)], 2), 3, 2)


def test_bytes_that_are_no_block_are_refused() -> None:
    with pytest.raises(ValueError, match="cannot be read"):
        unpack(b"no block", 1, 1)


def test_quantised_noise_takes_about_forty_bytes_a_row() -> None:
    random = Random(1)
    rows = [
        tuple([0.01 * i, 200.0, 0.0, 25.0, 31.0, 0.0] + [round(random.gauss(200, 0.25), 2) for _ in range(11)])
        for i in range(BLOCK_ROWS)
    ]
    assert len(pack(rows, 17)) / BLOCK_ROWS < 40
