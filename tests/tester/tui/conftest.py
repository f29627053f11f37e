from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.tester.tui.stage import House


@pytest.fixture(scope="package")
def house(tmp_path_factory: pytest.TempPathFactory) -> Iterator[House]:
    """Return a stage that stays open for all tests that restore it."""
    with House(tmp_path_factory.mktemp("house")) as made:
        yield made
