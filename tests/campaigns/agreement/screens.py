"""The screens of a stored run as text, operated as by a person."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator

from tests.campaigns.agreement.facts import Facts
from tests.campaigns.agreement.read_screens import done_by, moment, read_repeats, read_results, read_steps
from tests.campaigns.agreement.record import Record

_SIZE = (260, 70)
"""Characters of the screen: wide enough for every column and a row of seven flags (a narrower one is scrolled), high
enough for every condition.
"""
_LISTED = 8
"""Repeats that the dialog lists at once, at least."""
_WAIT_S = 60.0
_STEP_S = 0.5
"""Each step of a list is shown in whole seconds."""
_SHARES = (0.1, 0.35, 0.6, 0.85, 1.0)
"""Examined moments of a replay, as shares of the run."""


def screens(record: Record, worn: str) -> Iterator[Facts]:
    """Yield the facts of the Results screen, of each condition's repeats, and of moments of the replay."""
    yield from asyncio.run(_replayed(record, worn))


async def _replayed(record: Record, worn: str) -> list[Facts]:
    from tester.tui.playback import load
    from tester.tui.replay import ReplayApp
    from tester.tui.stored import read
    from tests.tester.tui.stage import screen_text

    folder = record.folder
    app = ReplayApp(load(folder), read(str(folder), folder.parent), theme="dark")
    found: list[Facts] = []
    async with app.run_test(size=_SIZE, notifications=False) as pilot:

        async def until(true: Callable[[str], bool]) -> str:
            late = asyncio.get_running_loop().time() + _WAIT_S
            while not true(screen_text(app)) and asyncio.get_running_loop().time() < late:
                await pilot.pause()
                await asyncio.sleep(0)
            return screen_text(app)

        replay, journal = Facts("replay"), Facts("record")
        for share in _SHARES:
            app.action_seek(-1e9)
            app.action_seek(share * app.playback.length_s)
            await pilot.press("f3")
            await pilot.pause()
            moment(replay, record, f"{share:.2f}", screen_text(app))
            at = ("moment", record.name, f"{share:.2f}")
            journal.count(at, "conditions done", done_by(record, app.at_s))
            journal.add(at, "time left", app.playback.length_s - app.at_s, _STEP_S * len(app.scene.plan.steps) + 1.0)
        journal.count(record.run, "conditions of the plan", len(record.conditions))
        found += [replay, journal, read_steps(record, worn, screen_text(app), "screen Steps")]
        await pilot.press("f5")
        await pilot.pause()
        found.append(read_results(record, worn, screen_text(app), "screen Results"))
        await pilot.press("tab")
        for at, row in enumerate(app.stored.rows):
            if at:
                await pilot.press("down")
            await pilot.press("enter")
            text = await until(lambda text: "repeat 1:" in text or "no repeat is committed" in text)
            found.append(read_repeats(record, worn, row.condition, text, "screen repeats"))
            if sum(condition == row.condition for condition, _ in record.repeats) > _LISTED:
                await pilot.press("end")  # scroll to the rest
                await pilot.pause()
                found.append(read_repeats(record, worn, row.condition, screen_text(app), "screen repeats"))
            await pilot.press("escape")
            await pilot.pause()
    return found
