"""What the service sends to the page in a browser about a stored run (its requests `run` and `condition`), and to every
screen during a run: through JSON and back.
"""

from __future__ import annotations

import json
from typing import Any

from tests.campaigns.agreement.facts import Facts, Subject
from tests.campaigns.agreement.names import ASKED, MADE, MARK, MU, RIG_SECONDS, STATUS, U_COMPOUND, U_THIS, VALID
from tests.campaigns.agreement.names import MU_MEASURED as MEASURED
from tests.campaigns.agreement.record import Record
from tests.campaigns.agreement.table import TableReader


def read_stored(record: Record, output: str) -> Facts:
    """Return the facts of the page's answers: numbers in full, and in the displayed digits."""
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


def read_live(record: Record, worn: str, output: str) -> Facts:
    """Return the facts of the service's message ``results``: the result of each condition, and its state at its end."""
    from tester.results.conditions_table import conditions_table
    from tester.results.run_results import results_of
    from tester.service.present_results import PresentResults, grown_view
    from tester.store.run_reader import RunReader

    facts = Facts(output)
    reader = TableReader(facts, record, worn)
    shown: Any = json.loads(json.dumps(PresentResults(record.folder.parent).answer(record.folder.name)))
    for condition in shown["conditions"]:
        at = record.of_condition(condition["condition"])
        facts.add(at, MU, condition["mu"])
        facts.add(at, U_THIS, condition["u"])
        _text(facts, reader, at, condition["text"])
    with RunReader(record.folder) as stored:
        results = results_of(stored)
        table = conditions_table(results)
        for row in table.rows:
            if row.measured is not None:
                for last in grown_view(stored, results, table, row).grown[-1:]:
                    at = record.of_condition(row.info.condition)
                    facts.add(at, MU, last.mu)
                    facts.add(at, U_THIS, last.u)
                    _text(facts, reader, at, last.text)
    return facts


def _text(facts: Facts, reader: TableReader, at: Subject, text: str) -> None:
    """Read mu with its mark, and U, as displayed."""
    mu, sign, u = text.partition(" ± ")
    if sign:
        reader.cell(at, MU, mu)
        facts.number(at, U_THIS, u)
