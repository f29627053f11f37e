"""The terminal of `tester page`: it shows codes, lists what changes, and makes a code for the role that is typed."""

from __future__ import annotations

import asyncio
import sys
from collections.abc import Callable
from threading import Thread

from tester.page.desk import PageDesk
from tester.page.desk_call import DeskView, NewCode
from tester.page.roles import ROLES, Role


class PageTerminal:
    """Prints what has changed since it last looked."""

    def __init__(self, desk: PageDesk, write: Callable[[str], object]) -> None:
        """``write`` prints a line."""
        self._desk = desk
        self._write = write
        self._before: DeskView | None = None
        self._role: Role = "look"

    def open(self) -> None:
        """Print where the page is, and read the terminal in a thread from now on, where there is one."""
        view = self._desk.view()
        self._write(f"page     {view.address}")
        self._write(f"         Enter makes a new code, or type a role: {', '.join(view.roles)}")
        self._write("         Ctrl+C ends the page and its pairings; it touches no run")
        if sys.stdin is not None and sys.stdin.isatty():
            loop = asyncio.get_running_loop()
            Thread(target=self._read, args=(loop,), name="terminal", daemon=True).start()

    def show(self) -> None:
        """Print codes and pairings that are new, and pairings that have ended."""
        view, before = self._desk.view(), self._before
        self._before = view
        if view.code is not None and (before is None or before.code is None or before.code.digits != view.code.digits):
            self._role = next(role for role in ROLES if role == view.code.what)
            self._write(f"code     {view.code.digits}  pairs one page: {view.code.what}; good for "
                        f"{view.code.left_s / 60:.0f} min")  # fmt: skip
        shown = {code.digits for code in before.asked} if before is not None else set[str]()
        for code in view.asked:
            if code.digits not in shown:
                self._write(f"code     {code.digits}  {code.page} asks: {code.what}")
        known = {pairing.number: pairing for pairing in before.pairings} if before is not None else {}
        for pairing in view.pairings:
            if known.pop(pairing.number, None) is None:
                self._write(f"paired   {pairing.number}: {pairing.name}, {pairing.role}, until {pairing.expires_utc}")
        for pairing in known.values():
            self._write(f"ended    {pairing.number}: {pairing.name}")

    def _read(self, loop: asyncio.AbstractEventLoop) -> None:
        for line in sys.stdin:
            loop.call_soon_threadsafe(self.typed, line.strip())

    def typed(self, word: str) -> None:
        """Make a code for a typed role; an empty line: for the role of the last one."""
        wanted = word or self._role
        role: Role | None = next((role for role in self._desk.view().roles if role == wanted), None)
        if role is None:
            self._write(f"         expected {', '.join(self._desk.view().roles)}, or Enter")
        else:
            self._desk.carry_out(NewCode(role))
