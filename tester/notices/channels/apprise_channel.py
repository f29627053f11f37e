"""Apprise, which knows some hundred services; only this module imports it (extra ``notify``)."""

from __future__ import annotations

import logging
from typing import Protocol, cast

from tester.base.plugins import needs
from tester.notices.channels.letter import Letter, NotDeliveredError
from tester.notices.secrets_file import NoticeSecrets


class AppriseSender(Protocol):
    """The used part of ``apprise.Apprise``, whose own types are open."""

    def add(self, services: str) -> bool:
        """Add an address; return whether it is known."""
        ...

    def notify(self, *, title: str, body: str) -> object:
        """Send to all addresses; return what is true if every service took it."""
        ...


class AppriseChannel:
    """Sends to all of Apprise's addresses at once."""

    def __init__(self, secrets: NoticeSecrets) -> None:
        """Load nothing yet."""
        self._secrets = secrets

    def send(self, letter: Letter, place: str) -> None:
        """Send a letter; return once every service has taken it. Raises NotDeliveredError."""
        try:
            import apprise
        except ImportError:
            raise NotDeliveredError(needs("apprise", "Apprise", "notify")) from None
        logging.getLogger("apprise").disabled = True  # its messages may show an address, which holds a token
        addresses = self._secrets.apprise.split()
        if not addresses:
            raise NotDeliveredError("there is no address for Apprise among the secrets")
        sender = cast("AppriseSender", apprise.Apprise())
        for number, address in enumerate(addresses, 1):
            if not sender.add(address):
                raise NotDeliveredError(f"Apprise does not know address {number} among the secrets")
        if not sender.notify(title=letter.subject, body=letter.text):
            raise NotDeliveredError("a service that Apprise called did not take it")
