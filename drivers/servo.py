"""A CiA 402 servo drive for the rig: its readings and commands, and the conversations that connect it."""

from __future__ import annotations

from drivers import servo_service, servo_setup
from drivers.canopen.conversation import Conversation
from drivers.servo_axis import ServoAxis


class ServoDrive(ServoAxis):
    """One drive, with its conversations for ``CanMaster.start``."""

    __slots__ = ()

    def connect(self, pc_node_id: int = 127) -> Conversation:
        """Return the conversation that resets, checks, configures and starts the drive, with all commands zero."""
        return servo_setup.connect(self, pc_node_id)

    def home(self) -> Conversation:
        """Return the conversation that finds the axis' reference; it enables the drive for this."""
        return servo_service.home(self)

    def diagnose(self) -> Conversation:
        """Return the conversation that reads the fault objects into ``diagnosis``; it changes nothing."""
        return servo_service.diagnose(self)

    def ask(self) -> Conversation:
        """Return the conversation that reads the statusword of a drive that sends no process data."""
        return servo_service.ask(self)

    def start_again(self) -> Conversation:
        """Return the conversation that brings back a drive that has left OPERATIONAL; set another goal first."""
        return servo_service.start_again(self)

    def release(self) -> Conversation:
        """Return the conversation that leaves the drive disabled, unwatched and PRE-OPERATIONAL."""
        return servo_service.release(self)
