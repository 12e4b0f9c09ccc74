"""What FMUs log, to Python's logging: under this package's name, with the name of the instance."""

from __future__ import annotations

import ctypes
import itertools
import logging
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from ctypes import CFUNCTYPE, c_char_p, c_int, c_void_p
from functools import cache
from typing import Any, Final

from seacrane.errors import CompileError
from seacrane.fmi.api import address
from seacrane.fmi.foreign import adapter

logger = logging.getLogger(__name__)

STATUS: Final = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
_LEVELS: Final = (logging.INFO, logging.WARNING, logging.WARNING, logging.ERROR, logging.CRITICAL, logging.INFO)

_Receiver = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
_Logger3 = CFUNCTYPE(None, c_void_p, c_int, c_char_p, c_char_p)

_keys = itertools.count(1)
_by_key: weakref.WeakValueDictionary[int, Log] = weakref.WeakValueDictionary()
_by_name: weakref.WeakValueDictionary[str, Log] = weakref.WeakValueDictionary()


@contextmanager
def kept_back() -> Iterator[None]:
    """What FMUs say is not passed on to `logging`: for runs whose failures are told otherwise."""

    def nothing(record: logging.LogRecord) -> bool:
        return False

    logger.addFilter(nothing)
    try:
        yield
    finally:
        logger.removeFilter(nothing)


class Log:
    """The log of one instance. `last` is the last thing said with a warning or worse.

    `key` is the environment to hand to an FMU of FMI 2.0, by which its messages find their way here.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        self.last = ""
        self.key = next(_keys)
        _by_key[self.key] = self
        _by_name[name] = self
        own = weakref.ref(self)

        def receive(_: int | None, status: int, category: bytes | None, message: bytes | None) -> None:
            _pass_on(name, own(), status, category, message)

        self.callback3 = _Logger3(receive)
        """The logMessage callback of FMI 3.0."""


def _pass_on(name: str, log: Log | None, status: int, category: bytes | None, message: bytes | None) -> None:
    text = (message or b"").decode(errors="replace").strip()
    if log is not None and status not in (OK, PENDING):
        log.last = text
    level = _LEVELS[status] if 0 <= status < len(_LEVELS) else logging.ERROR
    logger.log(level, "%s: %s [%s]", name, text, (category or b"").decode(errors="replace"))


def _receive(
    environment: int | None, instance: bytes | None, status: int, category: bytes | None, message: bytes | None
) -> None:
    said = (instance or b"").decode(errors="replace")
    log = _by_key.get(environment or 0) or _by_name.get(said)
    _pass_on(log.name if log is not None else said, log, status, category, message)


_received = _Receiver(_receive)


@cache
def logger2() -> int:
    """The address of the logger callback of FMI 1.0 and 2.0.

    Without a C compiler it gets the text only, as it is: the arguments of a printf format do not reach Python.
    """
    try:
        library: Any = adapter()
    except CompileError:
        return address(_received)
    library.seacrane_logger_receiver(ctypes.cast(_received, c_void_p))
    return address(library.seacrane_logger)
