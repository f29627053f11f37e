"""The channels of some settings."""

from __future__ import annotations

from tester.notices.channels.apprise_channel import AppriseChannel
from tester.notices.channels.command_channel import CommandChannel
from tester.notices.channels.letter import NoticeChannel
from tester.notices.channels.mail_channel import MailChannel
from tester.notices.channels.ntfy_channel import NtfyChannel
from tester.notices.notice_settings import NoticeSettings
from tester.notices.secrets_file import NoticeSecrets


def channels_of(settings: NoticeSettings, secrets: NoticeSecrets) -> dict[str, NoticeChannel]:
    """Return the channels by their names."""
    made: dict[str, NoticeChannel] = {}
    if settings.mail is not None:
        made["mail"] = MailChannel(settings.mail, secrets)
    if settings.ntfy is not None:
        made["ntfy"] = NtfyChannel(settings.ntfy, secrets)
    if settings.apprise is not None:
        made["apprise"] = AppriseChannel(secrets)
    if settings.command is not None:
        made["command"] = CommandChannel(settings.command)
    return made
