"""Assembles a service and runs it: lock, address, gateway, loop."""

from __future__ import annotations

import sys
from pathlib import Path

from tester.base.lock import ExclusiveUse, RigInUseError
from tester.base.plugins import allow_only
from tester.base.processes import EXIT_FAILED, EXIT_USAGE
from tester.notices.secrets_file import settings_trouble
from tester.service.address import (
    CARD,
    HAS_UNIX,
    Address,
    AddressError,
    UnixAddress,
    address_of,
    default_address,
    folder,
    new_tcp_address,
)
from tester.service.gateway_link import GatewayLink, LinkConfig
from tester.service.service import Service, ServiceOptions


def host(options: ServiceOptions, url: str, port: int | None, notify: str) -> int:
    """Serve until the process is asked to end; return the exit code. Raises InvalidSource for the rig file."""
    allow_only(options.allowed)
    try:
        where, address = _place(url, port)
    except AddressError as error:
        sys.stderr.write(f"{error}\n")
        return EXIT_USAGE
    with ExclusiveUse() as use:
        try:
            use.lock_file("the service here", where / "service.lock", "", lasting=False)
        except RigInUseError as error:
            sys.stderr.write(f"{error}\n")
            return EXIT_FAILED
        gateway = GatewayLink(LinkConfig(address, where / CARD, options.runs, options.rig, notify, options.accept_risk))
        service = Service(options, gateway)
        try:
            gateway.open()
        except (OSError, AddressError) as error:
            sys.stderr.write(f"the service cannot listen: {error}\n")
            return EXIT_FAILED
        for problem in settings_trouble(notify):
            sys.stderr.write(f"notices: {problem}\n")
            service.desk.tell("notices", f"no notice goes: {problem}", "warning")
        sys.stderr.write(f'rig "{service.rig.name}" is served at {address}\n')
        sys.stderr.flush()
        try:
            service.serve()
        finally:
            gateway.close()
    return 0


def _place(url: str, port: int | None) -> tuple[Path, Address]:
    """Return the service's folder and its address."""
    if url:
        address = address_of(url)
        if not isinstance(address, UnixAddress):
            raise AddressError(f"{url}: listen on TCP with --tcp PORT")
        return address.path.parent, address
    where = folder()
    if port is not None or not HAS_UNIX:
        return where, new_tcp_address(port or 0)
    return where, default_address(where)
