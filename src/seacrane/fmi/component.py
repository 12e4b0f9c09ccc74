"""The component of an FMU: the pointer that its functions take first, and the status that they leave it in."""

from __future__ import annotations

from typing import Any

from seacrane.errors import FmuError
from seacrane.fmi.api import Library
from seacrane.fmi.logs import ERROR, FATAL, OK, STATUS, WARNING, Log


class Component:
    """Calls functions and turns a status that is not good into an `FmuError` with what the FMU said."""

    def __init__(self, library: Library, log: Log) -> None:
        self.library = library
        self.log = log
        self.pointer = 0
        self.status = OK

    @property
    def live(self) -> int:
        """The pointer, of an instance that is not closed."""
        if not self.pointer:
            raise FmuError.at(self.log.name, "the instance is closed")
        return self.pointer

    def call(self, function: str, *arguments: Any) -> None:
        """Calls a function of the FMU; raises `FmuError` if it fails, or if there is none."""
        self.log.last = ""
        name, live = self.library.prefix + function, self.live
        if not self.library.has(function):
            raise FmuError.at(self.log.name, f"the library of the FMU lacks the function {name}")
        self.check(name, self.library.function(function)(live, *arguments))

    def check(self, what: str, status: int, reason: str = "") -> None:
        """Raises `FmuError` with function and status if the status is worse than a warning."""
        if status in (OK, WARNING):
            return
        self.note(status)
        name = STATUS[status] if 0 <= status < len(STATUS) else str(status)
        error = FmuError.at(self.log.name, f"{what} returned {name}{f': {reason}' if reason else ''}{self.said}")
        error.function, error.status = what, status
        raise error

    def note(self, status: int) -> None:
        """Remembers an error, after which the instance may only be freed, or not even that."""
        if status in (ERROR, FATAL):
            self.status = max(self.status, status)

    @property
    def said(self) -> str:
        return f": {self.log.last}" if self.log.last else ""
