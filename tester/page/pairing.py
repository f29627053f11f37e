"""Pairing of browsers: a code on the machine's screen gives a browser a secret for one role. All of it in memory only.

A code is good once, for five minutes and five tries of all clients together; then a person at the machine makes
another one. A flood of wrong codes therefore costs nobody but those who are still to be paired.
"""

from __future__ import annotations

import hmac
import secrets
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256

from tester.base import clock
from tester.base.words import plain_text
from tester.page.roles import Role

CODE_S = 300.0
"""How long a code is good, s."""
TRIES = 5
"""Wrong codes after which a code is void; 5 of 10^6 is the chance to guess it."""
PAIRED_S = 12 * 3600.0
"""How long a pairing is good, s: a shift and a half."""
SECRET_BYTES = 32
MOST_PAIRINGS = 32
"""Greatest number of pairings: as many clients as the service admits."""
LONGEST_NAME = 40
"""Most characters of a page's name, so that it fits the terminal's list."""
WRONG_PER_WINDOW, WINDOW_S = 5, 600.0
"""Wrong codes for actions, of all pages together, in a window of time (s): a page that guesses for 12 hours finds a
code with a chance of 4 in 10,000.
"""


class PairingError(Exception):
    """Pairing, a secret or a code is refused; the message gives the reason, for people."""


@dataclass(slots=True)
class Code:
    """A code on the machine's screen. ``what``: the role that it gives, or the action that it allows, in words."""

    digits: str
    what: str
    until_s: float
    tries: int = 0

    def left_s(self, now_s: float) -> float:
        """Return for how long it is still good, s; 0 for a void one."""
        return max(self.until_s - now_s, 0.0) if self.tries < TRIES else 0.0

    def fits(self, typed: str) -> bool:
        """Compare with a typed code, in constant time; count a wrong one."""
        right = hmac.compare_digest(self.digits.encode(), typed.encode())
        self.tries += not right
        return right


@dataclass(frozen=True, slots=True)
class Pairing:
    """A paired page. The secret itself is not kept, only its hash."""

    number: int
    name: str
    role: Role
    digest: bytes
    until_s: float
    expires_utc: str

    @property
    def recorded(self) -> str:
        """Return its name at the service, and so in the record."""
        return f"page {self.number}: {self.name}"


def new_digits() -> str:
    """Return six random digits."""
    return f"{secrets.randbelow(1_000_000):06d}"


class Pairings:
    """The codes and pairings of one page process; they end with it."""

    def __init__(self, greatest: Role, now: Callable[[], float] = clock.monotonic) -> None:
        """``greatest``: the strongest role that may be given; ``now`` returns seconds."""
        self.greatest: Role = greatest
        self._now = now
        self._code: tuple[Code, Role] | None = None
        self._paired: dict[int, Pairing] = {}
        self._last = 0
        self._asked: dict[int, tuple[Code, str]] = {}
        """The code that each page needs for its action, with that action's identity."""
        self._wrong: deque[float] = deque(maxlen=WRONG_PER_WINDOW)

    # -- for the machine's screen -----------------------------------------------------------------------------

    def new_code(self, role: Role) -> Code:
        """Return a new code for a role; it replaces the one before."""
        code = Code(new_digits(), role, self._now() + CODE_S)
        self._code = code, role
        return code

    def code(self) -> Code | None:
        """Return the code for pairing, None if none is good."""
        return self._code[0] if self._code is not None and self._code[0].left_s(self._now()) else None

    def asked(self) -> list[tuple[Pairing, Code]]:
        """Return the codes for actions that are good now, each with its page."""
        now_s = self._now()
        return [
            (self._paired[number], code)
            for number, (code, _) in self._asked.items()
            if number in self._paired and code.left_s(now_s)
        ]

    def listed(self) -> list[Pairing]:
        """Return the pairings that are good now, oldest first."""
        now_s = self._now()
        return [pairing for pairing in self._paired.values() if pairing.until_s > now_s]

    def revoke(self, number: int) -> bool:
        """End a pairing; return whether there was one."""
        self._asked.pop(number, None)
        return self._paired.pop(number, None) is not None

    def left_s(self, code: Code) -> float:
        """Return for how long a code is still good, s."""
        return code.left_s(self._now())

    # -- for browsers -----------------------------------------------------------------------------------------

    def pair(self, typed: str, name: str) -> tuple[Pairing, str]:
        """Return a new pairing and its secret. Raises PairingError."""
        try:
            name = plain_text(name, "name").strip()[:LONGEST_NAME] or "a page"
        except ValueError as error:
            raise PairingError(str(error)) from None
        code = self.code()
        if self._code is None or code is None:
            raise PairingError("no code is good at present: a person at the machine makes one (`tester page`, or F2)")
        if not code.fits(typed):
            raise PairingError("this is not the code on the machine's screen")
        _, role = self._code
        self._code = None
        if len(self.listed()) >= MOST_PAIRINGS:
            raise PairingError(f"{MOST_PAIRINGS} pages are paired already: revoke one at the machine (F2)")
        self._last += 1
        secret = secrets.token_urlsafe(SECRET_BYTES)
        pairing = Pairing(
            self._last, name, role, _digest(secret), self._now() + PAIRED_S, clock.utc_in(PAIRED_S)
        )
        self._paired[pairing.number] = pairing
        return pairing, secret

    def of(self, secret: str) -> Pairing:
        """Return the pairing of a secret. Raises PairingError. Every stored hash is compared, in constant time."""
        digest = _digest(secret)
        found = [pairing for pairing in self._paired.values() if hmac.compare_digest(pairing.digest, digest)]
        if not found or not self.good(found[0]):
            raise PairingError("this page is not paired, or no longer: pair it again")
        return found[0]

    def good(self, pairing: Pairing) -> bool:
        """Return whether a pairing has neither expired nor been revoked."""
        return self._paired.get(pairing.number) is pairing and pairing.until_s > self._now()

    def confirm(self, pairing: Pairing, action: str, what: str, typed: str) -> None:
        """Use up the code for one action of a page. Raises PairingError, its text beginning with "code:".

        ``action`` identifies the action with all its options: a code shown for one is no good for another. ``what``:
        the action in words, shown beside the code. Without a code (``typed`` ""), make one.
        """
        now_s = self._now()
        while self._wrong and now_s - self._wrong[0] >= WINDOW_S:
            self._wrong.popleft()
        if len(self._wrong) >= WRONG_PER_WINDOW:
            raise PairingError(f"code: {WRONG_PER_WINDOW} wrong codes within {WINDOW_S / 60:g} min: wait, or use the "
                               "terminal at the machine")  # fmt: skip
        code, identity = self._asked.get(pairing.number, (None, ""))
        if code is None or identity != action or not code.left_s(now_s):
            self._asked[pairing.number] = Code(new_digits(), what, now_s + CODE_S), action
            raise PairingError("code: type the code that the machine's screen shows now")
        if not typed:
            raise PairingError("code: type the code that the machine's screen shows")
        if not code.fits(typed):
            self._wrong.append(now_s)
            if not code.left_s(now_s):
                del self._asked[pairing.number]
            raise PairingError("code: this is not the code on the machine's screen")
        del self._asked[pairing.number]


def _digest(secret: str) -> bytes:
    return sha256(secret.encode()).digest()
