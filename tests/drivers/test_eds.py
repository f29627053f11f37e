"""The packaged data sheet matches the dictionary, and other programs can read it."""

from __future__ import annotations

import canopen
import pytest

from drivers.canopen.dictionary import DICTIONARY
from drivers.canopen.eds import EDS_PATH, write_eds


@pytest.fixture(scope="module")
def imported() -> canopen.ObjectDictionary:
    return canopen.import_od(str(EDS_PATH), node_id=5)


def test_the_file_matches_the_dictionary() -> None:
    assert EDS_PATH.read_text(encoding="ascii") == write_eds(DICTIONARY)


def test_canopen_finds_every_object_with_its_type_and_default(imported: canopen.ObjectDictionary) -> None:
    for (index, sub), entry in DICTIONARY.items():
        found = imported[index]
        variable = found if isinstance(found, canopen.objectdictionary.ODVariable) else found[sub]
        assert (variable.data_type, variable.default) == (entry.type, entry.initial(5)), f"0x{index:04X}:{sub}"


def test_canopen_finds_nothing_more(imported: canopen.ObjectDictionary) -> None:
    assert set(imported) == {index for index, _ in DICTIONARY}
