"""``notices.yaml``: where notices go. Read strictly, every problem at once with line and column.

The file holds no password and no token: see ``secrets_file``.
"""

from __future__ import annotations

import re
from datetime import time
from hashlib import sha256
from pathlib import Path
from typing import Annotated, Final, Literal
from urllib.parse import urlsplit

from pydantic import AfterValidator, Field, ValidationError, model_validator

from tester.base.source import InvalidSource, Problem, load_tree
from tester.base.user_folders import config_folder
from tester.base.validation import Section, problems_of
from tester.base.words import plain_text
from tester.notices.notice import NoticeCause

FILE: Final = "notices.yaml"
SMTP_PORTS: Final = {"tls": 465, "starttls": 587, "none": 25}
"""Ports by security (RFC 8314, RFC 6409, RFC 5321)."""
LOOPBACK: Final = ("localhost", "127.0.0.1", "::1")

_ADDRESS = re.compile(r"[A-Za-z0-9.!#$%&'*+/=?^_`{|}~-]{1,64}@[A-Za-z0-9](?:[A-Za-z0-9.-]{0,250}[A-Za-z0-9])?")
"""Dot-string of RFC 5321 without quotes: it can hold neither a blank nor a second address."""
_HOST = re.compile(r"[A-Za-z0-9](?:[A-Za-z0-9.-]{0,250}[A-Za-z0-9])?|[0-9a-fA-F:]{2,45}")
_TOPIC = re.compile(r"[-_A-Za-z0-9]{1,64}")
"""ntfy's own rule for topics."""
_TIME = re.compile(r"([01][0-9]|2[0-3]):[0-5][0-9]")


def settings_path() -> Path:
    """Return the place of the settings, which need not exist."""
    return config_folder() / FILE


def _address(text: str) -> str:
    if not _ADDRESS.fullmatch(text) or ".." in text:
        raise ValueError(f"{plain_text(text)!r} is not accepted (expected one address, such as anna@lab.example)")
    return text


def _host(text: str) -> str:
    if not _HOST.fullmatch(text):
        raise ValueError(f"{plain_text(text)!r} is not accepted (expected a host's name or address)")
    return text


def _topic(text: str) -> str:
    if not _TOPIC.fullmatch(text):
        raise ValueError("not accepted (expected a topic of 1 to 64 letters, digits, - and _, the rule of ntfy)")
    return text


def _server(text: str) -> str:
    parts = urlsplit(text)
    if "@" in text:
        raise ValueError("an address with a password is not accepted here (expected the token in the secrets' file)")
    plain = parts.path in ("", "/") and not parts.query and not parts.fragment
    if parts.scheme not in ("http", "https") or not _HOST.fullmatch(parts.hostname or "") or not plain:
        raise ValueError(f"{plain_text(text)!r} is not accepted (expected https://HOST or http://HOST:PORT)")
    return text.rstrip("/")


def _morning(text: str) -> str:
    if not _TIME.fullmatch(text):
        raise ValueError(f'{plain_text(text)!r} is not accepted (expected a local time in quotes, such as "07:00")')
    return text


Line = Annotated[str, AfterValidator(plain_text), Field(min_length=1, max_length=1000)]
Address = Annotated[str, AfterValidator(_address)]
Topic = Annotated[str, AfterValidator(_topic)]
Chosen = Annotated[list[Literal["trip", "prompt", "hold", "finished", "item", "condition", "disk", "service"]],
                   Field(min_length=1)]  # fmt: skip


class ChannelSection(Section, frozen=True):
    """What every channel has."""

    causes: Chosen | None = None
    """causes that this channel sends; all where it is left out. The morning's message always goes."""

    def takes(self, cause: NoticeCause) -> bool:
        """Return whether the channel sends notices of this cause."""
        always = cause in (NoticeCause.MORNING, NoticeCause.TEST)
        return always or self.causes is None or cause.value in self.causes

    def places(self, *, second: bool) -> tuple[str, ...]:
        """Return the addresses of a notice; with ``second`` those of a question that has waited long, too."""
        raise NotImplementedError


class MailSection(ChannelSection, frozen=True):
    """Mail by SMTP."""

    relay: Annotated[str, AfterValidator(_host)]
    """the relay's name or address, such as mail.lab.example"""
    port: Annotated[int, Field(ge=1, le=65535)] | None = None
    """the relay's port; 465 for tls, 587 for starttls, 25 for none"""
    security: Literal["tls", "starttls", "none"] = "starttls"
    """tls, starttls or none"""
    ca: Line | None = None
    """file with the certificate authority of the relay (PEM); by default the system's"""
    user: Line | None = None
    """user's name at the relay; its password is in the secrets' file or in TESTER_MAIL_PASSWORD"""
    sender: Annotated[str, AfterValidator(_address)] = Field(alias="from")
    """the rig's address"""
    to: Annotated[list[Address], Field(min_length=1, max_length=20)]
    """list of addresses"""
    second: Annotated[list[Address], Field(max_length=20, default_factory=list)]
    """addresses that get a question after 45 minutes, too"""

    @model_validator(mode="after")
    def _keeps_its_password(self) -> MailSection:
        if self.user is not None and self.security == "none" and self.relay not in LOOPBACK:
            raise ValueError("a password would cross the network readably (expected security: tls or starttls)")
        return self

    @property
    def at_port(self) -> int:
        """The port to connect to."""
        return self.port if self.port is not None else SMTP_PORTS[self.security]

    def places(self, *, second: bool) -> tuple[str, ...]:
        """Return mail addresses."""
        return tuple(dict.fromkeys((*self.to, *(self.second if second else ()))))


class NtfySection(ChannelSection, frozen=True):
    """Messages to telephones by ntfy, on a server of one's own or on ntfy.sh."""

    server: Annotated[str, AfterValidator(_server)]
    """the server's address, such as https://ntfy.lab.example"""
    topic: Topic
    """the topic; on a server without accounts whoever knows it reads along"""
    second: Topic | None = None
    """topic that gets a question after 45 minutes, too"""
    ca: Line | None = None
    """file with the certificate authority of the server (PEM); by default the system's"""

    def places(self, *, second: bool) -> tuple[str, ...]:
        """Return topics."""
        return (self.topic, *((self.second,) if second and self.second else ()))


class AppriseSection(ChannelSection, frozen=True):
    """Messages by Apprise (extra ``notify``); its addresses contain tokens, so they are in the secrets' file."""

    def places(self, *, second: bool) -> tuple[str, ...]:
        """Return the one place: all of Apprise's addresses."""
        return ("apprise",)


class CommandSection(ChannelSection, frozen=True):
    """A command, which gets the notice as JSON."""

    run: Line
    """the command; split as a shell would, but no shell runs it"""

    def places(self, *, second: bool) -> tuple[str, ...]:
        """Return the one place: the command."""
        return ("command",)


class NoticeSettings(Section, frozen=True):
    """Where notices go."""

    morning: Annotated[str, AfterValidator(_morning)] = "07:00"
    """local time of the morning's message, in quotes"""
    mail: MailSection | None = None
    """mail by SMTP"""
    ntfy: NtfySection | None = None
    """messages by ntfy"""
    apprise: AppriseSection | None = None
    """messages by Apprise"""
    command: CommandSection | None = None
    """a command"""

    @property
    def channels(self) -> dict[str, ChannelSection]:
        """The channels by their names."""
        every = {"mail": self.mail, "ntfy": self.ntfy, "apprise": self.apprise, "command": self.command}
        return {name: section for name, section in every.items() if section is not None}

    @property
    def morning_at(self) -> time:
        """The local time of the morning's message."""
        return time.fromisoformat(self.morning)

    def lanes(self, cause: NoticeCause, *, second: bool = False) -> dict[str, str]:
        """Return the addresses of a notice by their lanes."""
        return {
            lane_of(name, place): place
            for name, section in self.channels.items()
            if section.takes(cause)
            for place in section.places(second=second)
        }

    @property
    def every_lane(self) -> dict[str, str]:
        """All addresses by their lanes."""
        return self.lanes(NoticeCause.TEST, second=True)


def lane_of(channel: str, place: str) -> str:
    """Return the name of an address on disk, which does not show the address: a topic may be a secret."""
    return f"{channel}:{sha256(place.encode()).hexdigest()[:12]}"


def read_settings(path: Path, command: str = "") -> NoticeSettings:
    """Return the settings of a file; without the file, those of ``command`` alone. Raises InvalidSource.

    ``command`` (of ``tester serve --notify``) replaces the file's.
    """
    settings = NoticeSettings()
    if path.exists():
        tree = load_tree(path)
        try:
            settings = NoticeSettings.model_validate(tree.data)
        except ValidationError as error:
            raise InvalidSource(_pointed(problems_of(error, tree, NoticeSettings))) from error
    if command:
        settings = settings.model_copy(update={"command": CommandSection(run=command)})
    return settings


_SECRET = re.compile(r"unknown key '?\"?(password|token|passwd|secret|apprise_urls?|urls?)\b")


def _pointed(problems: list[Problem]) -> list[Problem]:
    """Return problems, those of a password in this file with the place where it belongs."""
    where = "a password or token goes into notices-secrets.yaml or the environment, never into this file"
    return [
        Problem(one.file, one.line, one.column, where if _SECRET.match(one.message) else one.message)
        for one in problems
    ]
