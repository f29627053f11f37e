"""All topics by name, the quick ones first."""

from __future__ import annotations

from tests.campaigns.acceptance import bus, check, determinism, plan, predict, startup, table2, truth
from tests.campaigns.acceptance.topic import Topic

TOPICS: dict[str, Topic] = {
    module.TOPIC.name: module.TOPIC for module in (predict, plan, check, startup, bus, determinism, truth, table2)
}
"""The topics in the order they are measured."""
