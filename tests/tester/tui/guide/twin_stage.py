"""The commissioning screen before the simulated rig, with the rig's true readings typed at its keyboard."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable
from contextlib import suppress
from itertools import count
from pathlib import Path
from typing import Any

from textual.pilot import Pilot

from tester.kinds.wheel_on_belt.commission.twin import TwinPerson
from tester.machine.prompts import Question
from tester.run.commissioning import CommissionOptions
from tester.run.kind_lookup import load_rig
from tester.tui.guide.guide import Guide
from tester.tui.guide.guide_app import GuideApp
from tests.tester.tui.stage import WAIT_S, screen_text

KEYS = {" ": "space", "\n": "enter"}


class TwinStage:
    """Screen, pilot and rig."""

    def __init__(self, folder: Path, lapse: float | None = None, *overrides: str) -> None:
        """``lapse``: rig seconds per second, None as fast as it goes."""
        self.twin = TwinPerson()
        self.loaded = 0
        options = CommissionOptions(out=folder, operator="A. Name", lapse=lapse)
        self.guide = Guide(lambda: load_rig("sim", overrides), options)
        seconds = count(0.0, 1.0)
        self.app = GuideApp(self.guide, theme="dark", now=lambda: next(seconds))
        self.pilot: Pilot[str] | None = None

    def play(self, act: Callable[[TwinStage], Awaitable[None]], size: tuple[int, int] = (80, 24)) -> None:
        """Carry out a test; the engine has ended when this returns."""
        self.guide.person.at = self.twin.at  # type: ignore[method-assign]

        async def main() -> None:
            async with self.app.run_test(size=size, notifications=True) as pilot:
                self.pilot = pilot
                await act(self)

        try:
            asyncio.run(main())
        finally:
            self.guide.close()

    async def press(self, *keys: str) -> None:
        """Press keys, and let the screen take them."""
        assert self.pilot is not None
        await self.pilot.press(*keys)
        await self.pilot.pause()

    async def type(self, text: str) -> None:
        """Type a line."""
        await self.press(*(KEYS.get(sign, sign) for sign in f"{text}\n"))

    async def until(self, true: Callable[[], bool], what: str) -> None:
        """Let the engine work until a condition holds."""
        assert self.pilot is not None
        clock = asyncio.get_running_loop().time
        late = clock() + WAIT_S
        while clock() < late:
            if true():
                return
            await self.pilot.pause(0.01)
        raise AssertionError(f"{what}: never\n{self.text()}")

    async def asked(self, key: str) -> Question:
        """Wait for a question on the screen."""
        found: list[Question] = []

        def there() -> bool:
            with suppress(AttributeError):
                question: Any = self.app._asked
                found[:] = [question] if question.key == key else []
            return bool(found)

        await self.until(there, f"question {key}")
        return found[0]

    async def answer_until(self, key: str) -> None:
        """Answer questions from the twin, up to a given question, which stays open."""
        while True:
            await self.until(lambda: self.app._asked is not None or not self.app.seen.running, "a question")
            question = self.app._asked
            assert question is not None, self.text()
            if question.key == key:
                return
            self.twin.prepare(question)
            await self.type(self.twin.answer(question))
            await self.until(lambda old=question: self.app._asked is not old, "the answer is taken")

    async def ended(self) -> None:
        """Wait until the engine has ended and the screen shows it."""
        await self.until(lambda: not self.app.seen.running, "the engine ends")
        assert self.pilot is not None
        self.app.look()
        await self.pilot.pause()

    def text(self) -> str:
        """Return the screen's text."""
        return screen_text(self.app)  # type: ignore[arg-type]
