"""The campaigns of the digital rig's doors, by their commands; real time, and a kernel of its own."""

from __future__ import annotations

import pytest

from tests.campaigns.doors.__main__ import main as doors
from tests.campaigns.vcan.__main__ import main as vcan
from tests.campaigns.vcan.__main__ import missing, prepare


@pytest.mark.campaign
def test_a_rig_behind_its_doors_gives_the_conditions_of_one_process() -> None:
    assert doors(["--sample"]) == 0


@pytest.mark.campaign
def test_a_recipe_runs_on_a_real_vcan_and_a_second_master_trips_it() -> None:
    if absent := missing():
        pytest.skip(f"not installed: {', '.join(absent)}")
    assert vcan([]) == 0


def test_the_job_on_a_vcan_has_its_profiles_with_wider_limits(tmp_path_factory: pytest.TempPathFactory) -> None:
    job = tmp_path_factory.mktemp("job")
    prepare(job)
    assert all("reply_max_ms = 400" in path.read_text(encoding="utf-8") for path in job.glob("*.toml"))
    assert len(list(job.glob("*.toml"))) == 3
