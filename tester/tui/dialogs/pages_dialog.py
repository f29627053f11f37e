"""Pages in browsers: who is paired, codes to pair another one, and the codes that actions of a page need."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable
from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widget import Widget
from textual.widgets import OptionList, Static
from textual.widgets.option_list import Option

from tester.page.desk_call import DeskRequest, DeskView, NewCode, NoPageError, Revoke, ShowDesk, call_desk
from tester.page.roles import Role
from tester.tui.dialogs.dialog import Dialog, line
from tester.tui.formatting import clean
from tester.tui.host import HostApp

LOOK_S = 1.0
"""Period at which the page process is asked, s."""
NO_PAGE = "No page is open: `tester page` in a shell opens one."


class PagesDialog(Dialog):
    """Makes codes, and ends pairings."""

    TITLE = "Pages in browsers"
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("l", "code('look')", "Code to look", show=False),
        Binding("s", "code('stop')", "Code to stop", show=False),
        Binding("c", "code('control')", "Code to control", show=False),
        Binding("delete,backspace", "revoke", "End a pairing", show=False),
    ]

    def __init__(self) -> None:
        """Nothing is known yet."""
        super().__init__()
        self._view: DeskView | None = None

    def content(self) -> Iterable[Widget]:
        """Return codes above, pairings below."""
        yield line("…", id="codes")
        yield OptionList(id="pairings", markup=False)
        yield line("l, s, c  a code to look, to stop as well, to control      Del  ends a pairing")

    def on_mount(self) -> None:
        """Ask now, and again each second."""
        self.set_interval(LOOK_S, self._look)
        self._look()

    def _look(self) -> None:
        self._ask(ShowDesk())

    def _ask(self, request: DeskRequest) -> None:
        self.run_worker(self._asked(request), group="desk", exclusive=True, exit_on_error=False)

    async def _asked(self, request: DeskRequest) -> None:
        try:
            view = await asyncio.to_thread(call_desk, self.host.options.address, request)
        except NoPageError:
            view = None
        self._view = view
        self.query_one("#codes", Static).update(Content(clean_rows(view)))
        self._list(view)

    def _list(self, view: DeskView | None) -> None:
        """List the pairings; keep the marked row."""
        rows = self.query_one(OptionList)
        before = rows.highlighted
        rows.clear_options()
        for pairing in view.pairings if view is not None else ():
            pages = f"{pairing.pages} open" if pairing.pages else "not open"
            until = pairing.expires_utc[11:16]
            text = f"{pairing.number}  {pairing.name}  {pairing.role}  {pages}  until {until} UTC"
            rows.add_option(Option(Content(clean(text))))
        if rows.option_count:
            rows.highlighted = min(before or 0, rows.option_count - 1)

    def action_code(self, role: Role) -> None:
        """Make a new code for a role."""
        if self.host.options.view_only:
            self.host.say("view only: codes are made on the machine's own screen")
        elif self._view is not None and role not in self._view.roles:
            self.host.say(f"{role} needs a certificate (`tester page --certificate`)", problem=True)
        else:
            self._ask(NewCode(role))

    def action_revoke(self) -> None:
        """End the marked pairing: its pages are closed."""
        place = self.query_one(OptionList).highlighted
        if self._view is not None and place is not None and place < len(self._view.pairings):
            self._ask(Revoke(self._view.pairings[place].number))


def clean_rows(view: DeskView | None) -> str:
    """Return address and codes as lines, without characters that steer a terminal."""
    if view is None:
        return NO_PAGE
    lines = [view.address]
    if view.code is not None:
        lines.append(f"code {view.code.digits}  pairs one page: {view.code.what}, for {view.code.left_s:.0f} s more")
    lines += [f"code {code.digits}  {code.page} asks: {code.what}" for code in view.asked]
    if len(lines) == 1:
        lines.append("no code is good at present")
    return "\n".join(map(clean, lines))


async def watch_pages(host: HostApp) -> None:
    """Show the code that an action of a page needs as soon as it is asked for, on whatever screen; never ends."""
    shown: set[str] = set()
    while True:
        try:
            view = await asyncio.to_thread(call_desk, host.options.address, ShowDesk())
        except NoPageError:
            asked = ()
        else:
            asked = view.asked
        for code in asked:
            if code.digits not in shown:
                host.say(f"{code.page} asks: {code.what}. Code {code.digits}", lasting=True)
        shown = {code.digits for code in asked}
        await asyncio.sleep(LOOK_S)
