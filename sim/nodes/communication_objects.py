"""Checks of a simulated device's communication objects (0x1000-0x1FFF), and saving of parameters (CiA 301)."""

from __future__ import annotations

from drivers.canopen import objects as o
from drivers.canopen import sdo
from sim.nodes.object_store import ObjectStore, SdoAbortError

_SAVE = int.from_bytes(b"save", "little")
_LOAD = int.from_bytes(b"load", "little")


def install(store: ObjectStore) -> None:
    """Guard the communication objects of ``store``; 0x1010 and 0x1011 save and restore its values."""
    store.guards[o.CONSUMER_HEARTBEAT] = _check_consumer
    store.guards[o.SYNC_COB_ID] = _check_sync
    store.guards[o.SYNC_COUNTER] = _check_sync_counter
    store.guards[o.ERROR_BEHAVIOUR] = _check_error_behaviour
    _Saving(store)


def _check_consumer(sub: int, value: int) -> None:
    if value >> 16 > 127:
        raise SdoAbortError(sdo.VALUE_RANGE)


def _check_sync(sub: int, value: int) -> None:
    """Accept only the usual identifier, without producing the SYNC (bit 30)."""
    if value != o.SYNC_ID:
        raise SdoAbortError(sdo.VALUE_RANGE)


def _check_sync_counter(sub: int, value: int) -> None:
    if value == 1 or value > 240:
        raise SdoAbortError(sdo.VALUE_RANGE)


def _check_error_behaviour(sub: int, value: int) -> None:
    if value > 2:
        raise SdoAbortError(sdo.VALUE_RANGE)


class _Saving:
    """Objects 0x1010 "store parameters" and 0x1011 "restore default parameters"."""

    def __init__(self, store: ObjectStore) -> None:
        self._store = store
        store.guards[o.STORE_PARAMETERS] = self._check_save
        store.hooks[o.STORE_PARAMETERS] = self._save
        store.guards[o.RESTORE_PARAMETERS] = self._check_load
        store.hooks[o.RESTORE_PARAMETERS] = self._load

    def _check_save(self, sub: int, value: int) -> None:
        if value != _SAVE:
            raise SdoAbortError(sdo.NOT_STORED)

    def _save(self, sub: int, value: int) -> None:
        self._store.values[(o.STORE_PARAMETERS, 1)] = 1  # reads as "can be saved on command"
        self._store.save()

    def _check_load(self, sub: int, value: int) -> None:
        if value != _LOAD:
            raise SdoAbortError(sdo.NOT_STORED)

    def _load(self, sub: int, value: int) -> None:
        self._store.values[(o.RESTORE_PARAMETERS, 1)] = 1
        self._store.restore_defaults()
