"""PyYAML's pure-Python reader, scanner and parser, with expressions where they go character by character.

The same events as PyYAML's own (a test holds them against each other), at a third of their time for what recipes are
made of: blanks, comments, keys, plain numbers with units, long lists of them on one line. It holds for texts whose
only line break is ``\\n`` and that have no byte order mark, which ``tester.base.source`` sees to.
"""

from __future__ import annotations

import re
from typing import cast

import yaml.events as ev
from yaml.error import Mark
from yaml.parser import Parser
from yaml.reader import Reader
from yaml.scanner import Scanner, ScannerError, SimpleKey
from yaml.tokens import FlowEntryToken, ScalarToken, Token

_BLANKS = re.compile(r"(?: *(?:#[^\n\0]*)?\n)* *(?:#[^\n\0]*)?")
_FLOW_WORD = r"[^\0\s:,?\[\]{}#]+"
_IN_FLOW = re.compile(rf"{_FLOW_WORD}(?: +{_FLOW_WORD})*(?=[,\]}}]|:[ \n])")
_IN_BLOCK = re.compile(r"[^\0\s:#]+(?: +[^\0\s:#]+)*(?=:[ \n])")
"""A plain scalar on one line that ends where nothing is left to ask."""
_ITEM = re.compile(rf" *((?:[0-9A-Za-z]|-[0-9])(?:{_FLOW_WORD})?(?: +{_FLOW_WORD})*),")
"""A plain scalar with the comma that ends it: no key, no continuation."""
_NAME = "<unicode string>"
"""What PyYAML calls a text."""
_BATCH = 64
"""Items of a list scanned in one go."""


class Events(Reader, Scanner, Parser):
    """A text to events, bounded in depth while scanning."""

    # What PyYAML's classes keep; they have no annotations of their own.
    buffer: str
    pointer: int
    index: int
    line: int
    column: int
    done: bool
    flow_level: int
    allow_simple_key: bool
    tokens: list[Token]
    tokens_taken: int
    possible_simple_keys: dict[int, SimpleKey]

    def __init__(self, text: str, max_depth: int) -> None:
        """Take a text; flow collections nested deeper than ``max_depth`` are refused (ScannerError)."""
        Reader.__init__(self, text)
        Scanner.__init__(self)
        Parser.__init__(self)
        self.max_depth = max_depth

    def following(self) -> ev.Event:
        """Take the next event; raises MarkedYAMLError, and ValueError for an escape out of range."""
        return cast("ev.Event", self.get_event())  # pyright: ignore[reportUnknownMemberType]

    def place(self, event: ev.Event) -> tuple[int, int]:
        """Return the line and column at which an event begins, from 1."""
        mark = cast("Mark", event.start_mark)
        return mark.line + 1, mark.column + 1

    # -- reader -----------------------------------------------------------------------------------------------

    def forward(self, length: int = 1) -> None:
        """Go on by some characters."""
        begin = self.pointer
        end = begin + length
        last = self.buffer.rfind("\n", begin, end)
        if last < 0:
            self.column += length
        else:
            self.line += self.buffer.count("\n", begin, end)
            self.column = end - last - 1
        self.pointer = end
        self.index += length

    def get_mark(self) -> Mark:
        """Return the place reached."""
        return Mark(_NAME, self.index, self.line, self.column, self.buffer, self.pointer)

    # -- scanner ----------------------------------------------------------------------------------------------

    def need_more_tokens(self) -> bool:
        """Tell whether the next token is not there yet, or may turn out to be a key."""
        if self.done or (self.tokens and not self.possible_simple_keys):
            return False
        return bool(super().need_more_tokens())  # pyright: ignore[reportUnknownMemberType, reportUnknownArgumentType]

    def check_token(self, *choices: type[Token]) -> bool:  # pyright: ignore[reportIncompatibleMethodOverride]
        """Tell whether the next token is one of some types (of any type if none is named)."""
        while self.need_more_tokens():
            self.fetch_more_tokens()
        return bool(self.tokens) and (not choices or isinstance(self.tokens[0], choices))

    def scan_to_next_token(self) -> None:
        """Skip blanks, comments and line breaks."""
        blanks = _BLANKS.match(self.buffer, self.pointer)
        if blanks is not None and blanks.end() > self.pointer:
            line = self.line
            self.forward(blanks.end() - self.pointer)
            if self.line > line and not self.flow_level:
                self.allow_simple_key = True

    def fetch_more_tokens(self) -> None:
        """Scan at least one token; of a list on one line many at once."""
        if self.flow_level and not self.possible_simple_keys and self._items():
            return
        super().fetch_more_tokens()  # pyright: ignore[reportUnknownMemberType]

    def _items(self) -> bool:
        """Scan plain scalars that end with a comma, up to a batch of them; tell whether there was one."""
        for count in range(_BATCH):
            item = _ITEM.match(self.buffer, self.pointer)
            if item is None:
                return count > 0
            self.forward(item.start(1) - self.pointer)
            begin = self.get_mark()
            self.forward(item.end(1) - self.pointer)
            comma = self.get_mark()
            self.forward()
            self.tokens += [ScalarToken(item[1], True, begin, comma), FlowEntryToken(comma, self.get_mark())]
            self.allow_simple_key = True
        return True

    def fetch_flow_collection_start(self, TokenClass: type) -> None:
        """Refuse open brackets before the scanner looks ahead over thousands of them."""
        if self.flow_level >= self.max_depth:
            raise ScannerError(None, None, f"nested deeper than {self.max_depth} levels", self.get_mark())
        super().fetch_flow_collection_start(TokenClass)  # pyright: ignore[reportUnknownMemberType]

    def scan_plain(self) -> ScalarToken:
        """Scan a plain scalar."""
        plain = (_IN_FLOW if self.flow_level else _IN_BLOCK).match(self.buffer, self.pointer)
        if plain is None:
            return super().scan_plain()  # pyright: ignore[reportUnknownMemberType, reportUnknownVariableType]
        begin = self.get_mark()
        self.forward(plain.end() - self.pointer)
        self.allow_simple_key = False
        return ScalarToken(plain[0], True, begin, self.get_mark())

    # -- parser -----------------------------------------------------------------------------------------------

    def parse_flow_sequence_entry(self, first: bool = False) -> ev.Event:
        """Give a list's next item; a scalar between commas, already scanned, goes the short way."""
        tokens = self.tokens
        if len(tokens) > 2 and not first and not self.possible_simple_keys:
            comma, item = tokens[:2]
            if isinstance(comma, FlowEntryToken) and isinstance(item, ScalarToken):
                del tokens[:2]
                self.tokens_taken += 2
                implicit = (True, False) if item.plain else (False, True)
                begin, end = item.start_mark, item.end_mark
                return ev.ScalarEvent(None, None, implicit, item.value, begin, end, style=item.style)
        return cast("ev.Event", super().parse_flow_sequence_entry(first))  # pyright: ignore[reportUnknownMemberType]
