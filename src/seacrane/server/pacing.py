"""Simulated time tied to the wall clock, by ticks of whole macro steps.

Policy: at every tick the simulation is stepped to where the wall clock says it should be. A simulation that has
fallen behind catches up at no more than `CATCH_UP` times real time, and a lag beyond `LAG_LIMIT` is given up: simulated
time then goes on from where it is. A tick whose work ends after the next tick is due is an overrun.
"""

from __future__ import annotations

import math
from collections import deque
from typing import Final

TICK: Final = 1 / 60
"""Period of a tick [s]."""
CATCH_UP: Final = 3.0
LAG_LIMIT: Final = 0.25
"""Lag behind the wall clock that is given up [s]."""
_WINDOW: Final = 600
_LOAD_WINDOW: Final = 60


class Pacer:
    """Decides how many macro steps are due, and keeps account of lateness. It reads no clock: `now` is given."""

    def __init__(self, macro_step: float) -> None:
        self._macro_step = macro_step
        self._most = max(1, math.ceil(CATCH_UP * TICK / macro_step))
        self._origin = 0.0
        self._late: deque[float] = deque(maxlen=_WINDOW)
        self._work: deque[tuple[float, float]] = deque(maxlen=_LOAD_WINDOW)
        self.overruns = 0

    def begin(self, now: float, time: float) -> None:
        """From now on, simulated time `time` belongs to wall time `now`."""
        self._origin = now - time

    def due(self, now: float, time: float) -> int:
        """Macro steps to make at wall time `now` with the simulation at `time`."""
        lag = now - self._origin - time
        if lag > LAG_LIMIT:
            self._origin += lag - TICK
            lag = TICK
        # A hair is added so that rounding does not put off a step that is due exactly now.
        return min(self._most, max(0, math.floor(lag / self._macro_step + 1e-6)))

    def worked(self, computing: float, steps: int, late: float) -> None:
        """A tick took `computing` seconds for `steps` and ended `late` seconds after the next was due (or before)."""
        self._late.append(max(0.0, late))
        self._work.append((computing, steps * self._macro_step))
        if late > 0:
            self.overruns += 1

    @property
    def late_p99(self) -> float:
        """99th percentile of lateness over the last ten seconds [s]."""
        if not self._late:
            return 0.0
        return sorted(self._late)[min(len(self._late) - 1, math.ceil(0.99 * len(self._late)) - 1)]

    @property
    def load(self) -> float:
        """Computing time per simulated time over the last second [1]; below one, real time is held."""
        simulated = sum(time for _, time in self._work)
        return sum(computing for computing, _ in self._work) / simulated if simulated > 0 else 0.0
