"""Real time: macro steps paced by the monotonic clock, with a stated policy for what is late.

The policy. The macro step from t to t + h is due at wall time origin + t / speed, and is never begun before. It is an
overrun when it has not ended by the time the next one is due. Steps that are late are begun at once, one after the
other, until the run has caught up; but when a step is due more than `catch_up` seconds ago, the origin is shifted so
that this step is due now: the lost wall time is not made up for, and the shift is counted.
"""

from __future__ import annotations

import math
import time as wall
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seacrane.cosim.execution import Execution
from seacrane.errors import CosimError

MEMORY = 16_384
"""The statistics of lateness cover so many macro steps, the last ones."""


@dataclass(frozen=True)
class Pace:
    """How well real time was kept.

    `lateness_*` [s]: how long after they were due macro steps began (median, 99th percentile of the last `MEMORY`
    steps, and the greatest of all). `shifts` is how often the origin was shifted, `lost_s` [s] by how much in sum.
    `real_time_factor` is wall time spent in stepping over simulated time.
    """

    macro_steps: int
    overruns: int
    shifts: int
    lost_s: float
    lateness_p50: float
    lateness_p99: float
    lateness_max: float
    real_time_factor: float


class RealTime:
    """Paces a run at `speed` times real time; it may be driven in ticks, paused, and changed in speed.

    `catch_up` [s] is how much lateness is made up for. `clock` and `sleep` [s] are the monotonic ones of the system;
    the wall clock of the day has no influence.
    """

    def __init__(
        self,
        run: Execution,
        *,
        speed: float = 1.0,
        catch_up: float = 0.25,
        clock: Callable[[], float] = wall.monotonic,
        sleep: Callable[[float], None] = wall.sleep,
    ) -> None:
        if not (math.isfinite(catch_up) and catch_up >= 0):
            raise CosimError.at("catch_up", "is not a duration", value=catch_up, allowed="0 s or more")
        self._run, self._clock, self._sleep = run, clock, sleep
        self._catch_up = catch_up
        self._speed = _checked(speed)
        self._origin: float | None = None
        self._lateness = np.zeros(MEMORY)
        self._worst = self._lost = self._busy = 0.0
        self._steps = self._overruns = self._shifts = 0

    @property
    def speed(self) -> float:
        """Simulated over wall time; it may be set while running, from the present on."""
        return self._speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._speed = _checked(speed)
        self._origin = None

    @property
    def running(self) -> bool:
        """Whether wall time counts: not before the first `advance`, nor between `pause` and the next one."""
        return self._origin is not None

    def advance(self, until: float) -> None:
        """Advance the run to the first communication point at or after `until` [s]; starts it, and ends a pause.

        It returns earlier, and pauses, if `Execution.pause` is called.
        """
        run = self._run.start()
        ahead = run.steps_to(until)
        while ahead > 0:
            due, begun = self._wait()
            before = run.time
            reached = run.step()
            if run.time == before:
                break
            ended = self._clock()
            self._lateness[self._steps % MEMORY] = begun - due
            self._worst = max(self._worst, begun - due)
            self._busy += ended - begun
            self._overruns += ended > due + run.macro_step / self._speed
            self._steps += 1
            ahead -= 1
            if not reached:
                break
        if ahead > 0:
            self.pause()

    def pause(self) -> None:
        """Let wall time pass without counting it, until the next `advance`; hands over what was recorded."""
        self._origin = None
        self._run.flush()

    @property
    def pace(self) -> Pace:
        """The statistics since this pacing was made."""
        known = self._lateness[: min(self._steps, MEMORY)]
        p50, p99 = np.percentile(known, (50, 99)).tolist() if known.size else (0.0, 0.0)
        simulated = self._steps * self._run.macro_step
        return Pace(
            macro_steps=self._steps,
            overruns=self._overruns,
            shifts=self._shifts,
            lost_s=self._lost,
            lateness_p50=p50,
            lateness_p99=p99,
            lateness_max=self._worst,
            real_time_factor=self._busy / simulated if simulated else 0.0,
        )

    def _wait(self) -> tuple[float, float]:
        """Wait until the next macro step is due; when it was, and what time it is."""
        elapsed = self._run.time / self._speed
        now = self._clock()
        if self._origin is None:
            self._origin = now - elapsed
        due = self._origin + elapsed
        if now - due > self._catch_up:
            self._shifts += 1
            self._lost += now - due
            self._origin += now - due
            due = now
        while now < due:
            self._sleep(due - now)
            now = self._clock()
        return due, now


def _checked(speed: float) -> float:
    if not (math.isfinite(speed) and speed > 0):
        raise CosimError.at("speed", "must be positive", value=speed)
    return speed
