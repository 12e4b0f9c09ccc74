"""Who holds the stick: one driver at a time, for as long as it shows that it is there."""

from __future__ import annotations

from typing import Final

from seacrane.errors import ServerError

LEASE: Final = 5.0
"""Time after its last command for which a driver keeps the stick [s]."""


class ControlLease:
    """The driver, by client number. It reads no clock: `now` is monotonic time [s]."""

    def __init__(self) -> None:
        self._driver: int | None = None
        self._until = 0.0

    @property
    def driver(self) -> int | None:
        """Who drives."""
        return self._driver

    def acquire(self, client: int, now: float, take_over: bool) -> bool:
        """Give the stick to this client; True if it was taken from another. `ServerError` if another holds it."""
        other = self._driver is not None and self._driver != client
        if other and not take_over:
            raise ServerError.at(
                "control",
                f"client {self._driver} is driving",
                hint="Call control.acquire with take_over true to take the stick openly.",
            )
        self._driver, self._until = client, now + LEASE
        return other

    def renew(self, client: int, now: float) -> None:
        """A command came from this client; `ServerError` unless it drives."""
        if self._driver != client:
            who = "nobody" if self._driver is None else f"client {self._driver}"
            raise ServerError.at(
                "control", f"{who} is driving, not you (client {client})", hint="Call control.acquire first."
            )
        self._until = now + LEASE

    def release(self, client: int) -> bool:
        """Give the stick back; False if this client did not hold it."""
        if self._driver != client:
            return False
        self._driver = None
        return True

    def expire(self, now: float) -> bool:
        """Take the stick from a driver that has gone silent; True if this happened now."""
        if self._driver is None or now < self._until:
            return False
        self._driver = None
        return True
