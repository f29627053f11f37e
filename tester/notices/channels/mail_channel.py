"""Mail by SMTP, one address in one transaction, so that each address is confirmed by itself."""

from __future__ import annotations

import smtplib
import ssl
from contextlib import suppress
from datetime import UTC, datetime
from email.message import EmailMessage
from email.policy import SMTP

from tester.notices.channels.letter import WITHIN_S, Letter, NotDeliveredError, network_words
from tester.notices.notice_settings import MailSection
from tester.notices.secrets_file import NoticeSecrets

REFUSED_FOR_GOOD = 500
"""Smallest reply code that refuses for good (RFC 5321)."""


class MailChannel:
    """Sends by one relay."""

    def __init__(self, section: MailSection, secrets: NoticeSecrets) -> None:
        """Connect to nothing yet."""
        self.section = section
        self._secrets = secrets

    def send(self, letter: Letter, place: str) -> None:
        """Send a letter; return once the relay has taken it. Raises NotDeliveredError."""
        message = message_of(letter, self.section.sender, place).as_bytes()
        try:
            self._send(message, place)
        except smtplib.SMTPRecipientsRefused as error:
            code, reply = next(iter(error.recipients.values()))
            raise NotDeliveredError(_words(code, reply), final=code >= REFUSED_FOR_GOOD) from error
        except smtplib.SMTPDataError as error:
            raise NotDeliveredError(
                _words(error.smtp_code, error.smtp_error), final=error.smtp_code >= REFUSED_FOR_GOOD
            ) from error
        except smtplib.SMTPResponseException as error:
            raise NotDeliveredError(_words(error.smtp_code, error.smtp_error)) from error
        except (smtplib.SMTPException, OSError, ValueError) as error:
            raise NotDeliveredError(network_words(error)) from error

    def _send(self, message: bytes, place: str) -> None:
        section = self.section
        context = ssl.create_default_context(cafile=section.ca) if section.security != "none" else None
        if section.security == "tls":
            client: smtplib.SMTP = smtplib.SMTP_SSL(section.relay, section.at_port, timeout=WITHIN_S, context=context)
        else:
            client = smtplib.SMTP(section.relay, section.at_port, timeout=WITHIN_S)
        try:
            if section.security == "starttls":
                client.starttls(context=context)  # refused by the client where the relay does not offer it
            if section.user is not None:
                if not self._secrets.mail_password:
                    raise NotDeliveredError("there is no mail_password for mail.user")
                client.login(section.user, self._secrets.mail_password)
            client.sendmail(section.sender, [place], message)
            with suppress(smtplib.SMTPException, OSError):  # the relay has taken it, whatever becomes of QUIT
                client.quit()
        finally:
            client.close()


def message_of(letter: Letter, sender: str, place: str) -> EmailMessage:
    """Return a letter as a mail, byte for byte the same in every attempt."""
    message = EmailMessage(policy=SMTP)
    message["From"] = sender
    message["To"] = place
    message["Subject"] = letter.subject
    message["Date"] = datetime.fromtimestamp(letter.at_s, UTC)
    message["Message-ID"] = f"<{letter.name}@{sender.rpartition('@')[2]}>"
    message["Auto-Submitted"] = "auto-generated"  # RFC 3834: no out-of-office answer comes back
    message.set_content(letter.text, cte="quoted-printable")
    return message


def _words(code: int, reply: bytes | str) -> str:
    text = reply.decode("utf-8", "replace") if isinstance(reply, bytes) else reply
    return f"the relay answers {code} {text}"
