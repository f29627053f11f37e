"""Texts of people, recipes and devices, made to end a line, add a header or an address, or turn the text."""

from __future__ import annotations

from random import Random

ENDS = ["\r\n", "\n", "\r", "\x0b", "\x0c", "\x85", "\u2028", "\u2029", "\r\n\r\n", "\n\n", "\r\n ", "\r\n\t", "\0"]
HEADERS = ["Bcc: mallory@evil.example", "To: mallory@evil.example", "Subject: x", "Message-ID: <1@evil>",
           "Content-Type: text/html", ".\r\nMAIL FROM:<mallory@evil.example>", "RCPT TO:<mallory@evil.example>",
           "QUIT", "DATA", "From: boss@lab.example", "=?utf-8?b?DQpCY2M6IG1AZQ==?=", "=?utf-8?q?=0D=0ABcc:_m@e?="]
OTHERS = ["\u202e", "\u2066", "\u200b", "\ufeff", "\x1b[2J", "\x7f", "\ud800", "<script>", "%0d%0aBcc: m@e",
          "\\r\\nBcc: m@e", "mallory@evil.example, ", "\U000e0041", "x" * 2000, "\u00e4" * 1500, "a b " * 400,
          "'; rm -rf /; '", "$(id)", "=\x00?utf-8?b?DQpCY2M6IG1AZQ==?="]


def hostile_texts(count: int = 200, seed: int = 32) -> list[str]:
    """Return that many hostile texts, the same for a seed."""
    random = Random(seed)
    texts: list[str] = []
    for _ in range(count):
        pieces = [random.choice(("overload", "wheel 3#", "", "name")), random.choice(ENDS), random.choice(HEADERS)]
        for _ in range(random.randrange(4)):
            pieces.insert(random.randrange(len(pieces) + 1), random.choice((*ENDS, *HEADERS, *OTHERS)))
        texts.append("".join(pieces))
    return texts
