"""How an instance comes into being, in each version of FMI."""

from __future__ import annotations

import ctypes
from ctypes import byref
from functools import cache
from typing import TYPE_CHECKING, Any

from seacrane.fmi.api import FMI1, FMI2, Callbacks1, Callbacks2, address
from seacrane.fmi.logs import Log, logger2

if TYPE_CHECKING:
    from seacrane.fmi.fmu import Fmu


def create(fmu: Fmu, log: Log, debug: bool, event_mode: bool) -> tuple[int | None, Any]:
    """The component, None if the FMU refuses, and what must live as long as it does."""
    make = fmu.library.function(fmu.api.creators[int(fmu.exchange)])
    name, guid, resources = log.name.encode(), fmu.description.guid.encode(), fmu.folder / "resources"
    if fmu.api is FMI1:
        callbacks1 = Callbacks1(logger2(), *_memory(), None)
        location, kind = fmu.folder.as_uri().encode(), b"application/x-fmu-sharedlibrary"
        return make(name, guid, location, kind, 1000.0, 0, 0, callbacks1, int(debug)), callbacks1
    if fmu.api is FMI2:
        callbacks = Callbacks2(logger2(), *_memory(), None, log.key)
        kind2 = 0 if fmu.exchange else 1
        return make(name, kind2, guid, resources.as_uri().encode(), byref(callbacks), 0, int(debug)), callbacks
    folder = f"{resources}/".encode() if resources.is_dir() else None
    if fmu.exchange:
        return make(name, guid, folder, False, debug, None, log.callback3), None
    return make(name, guid, folder, False, debug, event_mode, event_mode, None, 0, None, log.callback3, None), None


@cache
def _memory() -> tuple[int, int]:
    """Addresses of the functions that allocate and free for an FMU."""
    process = ctypes.CDLL(None)
    return address(process.calloc), address(process.free)
