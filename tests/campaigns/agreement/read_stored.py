"""What the page in a browser is sent of a stored run: its questions `run` and `condition`, through JSON and back."""

from __future__ import annotations

import json
from typing import Any

from tests.campaigns.agreement.facts import Facts
from tests.campaigns.agreement.names import ASKED, MADE, MARK, MU, RIG_SECONDS, STATUS, U_COMPOUND, U_THIS, VALID
from tests.campaigns.agreement.names import MU_MEASURED as MEASURED
from tests.campaigns.agreement.record import Record


def read_stored(record: Record, output: str) -> Facts:
    """Return the facts of the page's answers: numbers in full, and in the digits that people see."""
    # Imported now: a mutant changes its module while that is imported, and the page imports many.
    from tester.page.stored.asked import answer
    from tester.page.stored.run_cache import RunCache

    facts, cache = Facts(output), RunCache(record.folder.parent)

    def asked(query: str, **keys: Any) -> dict[str, Any]:
        found: dict[str, Any] = json.loads(json.dumps(answer(cache, query, {"run": record.folder.name, **keys}, "")))
        return found

    shown = asked("run")
    facts.add(record.run, STATUS, shown["status"])
    facts.add(record.run, RIG_SECONDS, shown["rig_s"])
    for condition in shown["conditions"]:
        at = record.of_condition(condition["n"])
        for key, quantity in (("mu", MU), ("u", U_THIS), ("u_compound", U_COMPOUND)):
            facts.add(at, quantity, condition[key])
            facts.number(at, quantity, condition[f"{key}_text"])
        facts.add(at, MARK, condition["mark"])
        for key, quantity in (("repeats", VALID), ("asked", ASKED), ("made", MADE)):
            facts.count(at, quantity, condition[key])
        for repeat in asked("condition", n=condition["n"])["repeats"]:
            facts.add(record.of_repeat(condition["n"], repeat["n"]), f"repeat {MEASURED}", repeat["mu"])
    return facts
