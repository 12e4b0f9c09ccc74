"""What one client may ask of the server; a client beyond a limit is cut off, the others notice nothing."""

from __future__ import annotations

from typing import Final

MESSAGE_BYTES: Final = 256 * 1024
"""Largest request."""
CALL_RATE: Final = 1000.0
"""Sustained requests per second of one client; one of `CALL_BYTES` more counts as two."""
CALL_BURST: Final = 2000.0
"""Requests at once of one client."""
CALL_BYTES: Final = 256
QUEUE_BYTES: Final = 1024 * 1024
"""Answers waiting for one client."""
STALL: Final = 5.0
"""Time for which a client may take nothing [s]."""
CLIENTS: Final = 200
"""Clients at once."""
SUBSCRIPTIONS: Final = 16
"""Subscriptions of one client."""


class CallRate:
    """A bucket of `CALL_BURST` requests that refills at `CALL_RATE`."""

    def __init__(self, now: float) -> None:
        self._left, self._last = CALL_BURST, now

    def allows(self, now: float, size: int) -> bool:
        """Whether a request of so many bytes may be served at monotonic time `now` [s]."""
        self._left = min(CALL_BURST, self._left + (now - self._last) * CALL_RATE)
        self._last = now
        self._left -= 1.0 + size / CALL_BYTES
        return self._left >= 0.0
