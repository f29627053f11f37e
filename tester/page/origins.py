"""The names under which the page may be called: every request states one of them (``Host``, ``Origin``).

A page of another origin sends its own ``Origin``; a name that an attacker's server resolves to this machine (DNS
rebinding) arrives in ``Host``. A forwarded port has another name as well: it is refused unless it was given at start.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from urllib.parse import urlsplit

from websockets.datastructures import Headers

from tester.base.trouble import MisuseError

HOST = "127.0.0.1"
NAMES = (HOST, "localhost")
"""Names of this machine that a browser on it may use."""
STANDARD = {"http": 80, "https": 443}
"""Ports that browsers leave out of both headers."""


class OriginError(MisuseError):
    """An origin is not one; the message gives what was expected."""


@dataclass(frozen=True, slots=True)
class Origins:
    """The accepted values of ``Host`` and ``Origin``, in lower case."""

    hosts: frozenset[str]
    origins: frozenset[str]

    def refusal(self, headers: Headers, *, socket: bool) -> str:
        """Return why a request is refused, "" for one that is not.

        ``socket``: whether it opens a WebSocket, with which every browser sends its origin; a page is loaded without.
        """
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        if len(hosts) != 1 or hosts[0].lower() not in self.hosts:
            return "this page was not started for that name; a forwarded port needs `tester page --origin`"
        if len(origins) > 1 or any(origin.lower() not in self.origins for origin in origins):
            return "a page of another origin may not ask here"
        if socket and not origins:
            return "a browser states its origin; a program is a client of the service (docs/protocol.md)"
        return ""


def origins_for(scheme: str, addresses: Iterable[str], port: int, further: Iterable[str] = ()) -> Origins:
    """Return the names of a page at some addresses and a port.

    ``scheme``: http or https. ``further``: origins under which it is reached otherwise, as a browser shows them
    (``http://localhost:9000``). Raises OriginError.
    """
    hosts: set[str] = set()
    origins: set[str] = set()
    for address in addresses:
        name = f"[{address}]" if ":" in address else address
        for place in {f"{name}:{port}", *([name] if port == STANDARD[scheme] else [])}:
            hosts.add(place.lower())
            origins.add(f"{scheme}://{place}".lower())
    for text in further:
        parts = urlsplit(text)
        if parts.scheme not in STANDARD or not parts.netloc or parts.path not in ("", "/") or "@" in parts.netloc:
            raise OriginError(f"--origin {text}: expected http(s)://NAME:PORT, as the browser shows it")
        hosts.add(parts.netloc.lower())
        origins.add(f"{parts.scheme}://{parts.netloc}".lower())
    return Origins(frozenset(hosts), frozenset(origins))
