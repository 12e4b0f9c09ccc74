"""Notices slaves that take too long.

A slave in the same process cannot be interrupted: its code runs in the process that would have to do it. What can be
done is to say which one it is and since when while it hangs, and to end the run once it has come back.
"""

from __future__ import annotations

import logging
import threading
import time as wall
from dataclasses import dataclass
from typing import Final

import numpy as np
import numpy.typing as npt

_log = logging.getLogger("seacrane.cosim")

_LOOKS: Final = 5
"""How often the watchdog looks within the limit: so a call is noticed after 1 to 1.2 times the limit."""


@dataclass(frozen=True)
class Late:
    """A call of `slave` that had taken `seconds` of wall time when last looked at, in a macro step after `time` [s]."""

    slave: str
    seconds: float
    time: float


class Watchdog:
    """A thread that looks at which slaves are at work.

    `calls` counts begun and ended calls of each slave, so that it is odd while one is at work; `stop` is set to 1 when
    the run is to end. What is late is logged as a warning of the logger `seacrane.cosim`, and again each time it has
    taken twice as long.
    """

    def __init__(
        self, slaves: list[str], calls: npt.NDArray[np.int64], stop: npt.NDArray[np.int64], limit: float, end: bool
    ) -> None:
        self.limit, self.end = limit, end
        self.late: list[Late] = []
        self.time = 0.0
        """The last communication point that is known [s]."""
        self._slaves, self._calls, self._stop = slaves, calls, stop
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._work, name="seacrane-watchdog", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        self._thread.join()

    def _work(self) -> None:
        before = self._calls.copy()
        since = np.full(before.size, wall.monotonic())
        told = np.full(before.size, self.limit)
        while not self._over.wait(self.limit / _LOOKS):
            now, calls = wall.monotonic(), self._calls.copy()
            moved = (calls != before) | (calls % 2 == 0)
            since[moved], told[moved] = now, self.limit
            before = calls
            for i in np.flatnonzero(now - since > self.limit):
                late = Late(self._slaves[i], float(now - since[i]), self.time)
                self.late = [*(known for known in self.late if known.slave != late.slave), late]
                if self.end:
                    self._stop[0] = 1
                if late.seconds > told[i]:
                    told[i] = 2 * late.seconds
                    self._tell(late)

    def _tell(self, late: Late) -> None:
        _log.warning(
            "%s: has been at work for %.3g s in a macro step after t = %.9g s; the limit is %.3g s",
            late.slave,
            late.seconds,
            late.time,
            self.limit,
        )
