"""ntfy: a POST with JSON to the server's root, so that no text becomes a header.

A server of version 2.16 or later replaces a message of the same ``sequence_id`` instead of showing it twice.
"""

from __future__ import annotations

import http.client
import ssl
import urllib.error
import urllib.request
from email.message import Message
from hashlib import sha256
from typing import IO
from urllib.parse import urlsplit

from pydantic_core import to_json

from tester.notices.channels.letter import WITHIN_S, Letter, NotDeliveredError, network_words
from tester.notices.notice_settings import LOOPBACK, NtfySection
from tester.notices.secrets_file import NoticeSecrets

NOT_FINAL = frozenset({401, 403, 408, 425, 429})
"""Refusals that a corrected token or time mends."""


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """A redirection is an error: urllib would take the token along to wherever it leads."""

    def redirect_request(
        self, req: urllib.request.Request, fp: IO[bytes], code: int, msg: str, headers: Message, newurl: str
    ) -> None:
        return None


class NtfyChannel:
    """Sends by one server."""

    def __init__(self, section: NtfySection, secrets: NoticeSecrets) -> None:
        """Connect to nothing yet."""
        self.section = section
        self._secrets = secrets

    def send(self, letter: Letter, place: str) -> None:
        """Send a letter to a topic; return once the server has taken it. Raises NotDeliveredError."""
        section, token = self.section, self._secrets.ntfy_token
        parts = urlsplit(section.server)
        if token and parts.scheme == "http" and parts.hostname not in LOOPBACK:
            raise NotDeliveredError("the token would cross the network readably: ntfy.server must begin with https")
        content = {
            "topic": place,
            "title": letter.subject,
            "message": letter.text,
            "priority": letter.priority,
            "sequence_id": sha256(letter.name.encode()).hexdigest()[:32],
        }
        headers = {"Content-Type": "application/json"} | ({"Authorization": f"Bearer {token}"} if token else {})
        request = urllib.request.Request(f"{section.server}/", to_json(content), headers, method="POST")
        try:
            context = ssl.create_default_context(cafile=section.ca) if parts.scheme == "https" else None
            handlers = [urllib.request.HTTPSHandler(context=context)] if context else []
            opener = urllib.request.build_opener(_NoRedirect, *handlers)
            with opener.open(request, timeout=WITHIN_S) as reply:
                reply.read(65_536)
        except urllib.error.HTTPError as error:
            with error:
                final = 400 <= error.code < 500 and error.code not in NOT_FINAL
                raise NotDeliveredError(f"the server answers {error.code} {error.reason}", final=final) from error
        except (OSError, http.client.HTTPException, ValueError) as error:  # URLError is an OSError
            reason = getattr(error, "reason", error)
            words = network_words(reason) if isinstance(reason, BaseException) else str(reason)
            raise NotDeliveredError(words) from error
