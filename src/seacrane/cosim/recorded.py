"""Recorded data as a slave: measurements, or what another simulation gave."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from seacrane.cosim.algorithms import NANOSECONDS
from seacrane.cosim.function import FunctionInstance
from seacrane.cosim.slave import Instance, Interface, Slave, Vector
from seacrane.errors import CosimError, Problem, nearest
from seacrane.model.dae import Variable
from seacrane.results import Recording


class RecordedSlave(Slave):
    """Signals of a recording as outputs, each in the unit it has there.

    `source` is a `Recording`, or the path of a CSV, Arrow or Parquet file; `signals` names those that are taken (all by
    default). Between two rows, values are those of the earlier one (`interpolation="hold"`) or on the line between both
    (`"linear"`). Where several rows have the same time, the last counts from there on.

    Time in the recording is time of the run plus `shift` [s]. A time that lies before the first row or after the last
    ends the run with an error (`outside="error"`), or gives the values of that row (`"hold"`).

    `CosimError` if a signal does not exist, is not finite, or if time goes back in the recording.
    """

    def __init__(
        self,
        source: Recording | str | Path,
        signals: Sequence[str] | None = None,
        *,
        interpolation: Literal["linear", "hold"] = "linear",
        outside: Literal["error", "hold"] = "error",
        shift: float = 0.0,
    ) -> None:
        recording = source if isinstance(source, Recording) else Recording.read(source)
        self.name = "recording" if isinstance(source, Recording) else str(source)
        self.signals = tuple(recording.names if signals is None else signals)
        self.interpolation, self.outside, self.shift = interpolation, outside, shift
        _refuse_what_is_wrong(self, recording)
        # Whole nanoseconds, like the time of a run: a row is met exactly, whatever the step.
        self._times = np.round(recording.time * NANOSECONDS).astype(np.int64)
        self._rows = np.column_stack([recording[name] for name in self.signals])
        self._shift_ns = round(shift * NANOSECONDS)
        self._outputs = tuple(
            Variable(n, recording.signal(n).unit, float(v), shown=recording.signal(n).display)
            for n, v in zip(self.signals, self._rows[0], strict=True)
        )

    @property
    def interface(self) -> Interface:
        return Interface(outputs=self._outputs)

    @property
    def about(self) -> str:
        first, last = self._times[[0, -1]] / NANOSECONDS
        return f"{self.name}: {len(self._outputs)} signals from {first:g} to {last:g} s"

    @property
    def fingerprint(self) -> str:
        content = hashlib.sha256(self._times.tobytes() + self._rows.tobytes()).hexdigest()
        return repr((content, self.signals, self.interpolation, self.outside, self.shift))

    def instantiate(self, name: str) -> Instance:
        return FunctionInstance(name, lambda t, h, u: self.at(t + h), None)

    def at(self, time: float) -> Vector:
        """The values at a time [s] of the run, shape (signals,)."""
        t, times = round(time * NANOSECONDS) + self._shift_ns, self._times
        if not times[0] <= t <= times[-1]:
            if self.outside == "error":
                first, last = times[[0, -1]] / NANOSECONDS
                raise CosimError.at(
                    "", f"{t / NANOSECONDS:.9g} s lies outside the recording", allowed=f"{first:.9g} to {last:.9g} s"
                )
            t = min(max(t, int(times[0])), int(times[-1]))
        i = int(np.searchsorted(times, t, side="right")) - 1
        before: Vector = self._rows[i]
        if self.interpolation == "hold" or times[i] == t:
            return before
        after: Vector = self._rows[i + 1]
        share = float((t - times[i]) / (times[i + 1] - times[i]))
        return before + share * (after - before)


def _refuse_what_is_wrong(slave: RecordedSlave, recording: Recording) -> None:
    problems = []
    for value, known, what in (
        (slave.interpolation, ("linear", "hold"), "interpolation"),
        (slave.outside, ("error", "hold"), "outside"),
    ):
        if value not in known:
            problems.append(Problem(what, "is none of these", value, ", ".join(known)))
    if not np.isfinite(slave.shift):
        problems.append(Problem("shift", "is not a finite number", slave.shift))
    if not len(recording):
        problems.append(Problem(slave.name, "the recording is empty"))
    elif not np.isfinite(recording.time).all():
        problems.append(Problem(slave.name, "a time is not a finite number"))
    else:
        back = np.flatnonzero(np.diff(recording.time) < 0)
        if back.size:
            before, after = recording.time[back[0] : back[0] + 2]
            problems.append(Problem(slave.name, f"time goes back from {before:.9g} to {after:.9g} s"))
    if not slave.signals:
        problems.append(Problem(slave.name, "has no signals"))
    for name in slave.signals:
        if name not in recording:
            problems.append(Problem(name, "no such signal in the recording", hint=nearest(name, recording.names)))
            continue
        wrong = np.flatnonzero(~np.isfinite(recording[name]))
        if wrong.size:
            at = recording.time[wrong[0]]
            problems.append(Problem(name, f"is not finite at {at:.9g} s", float(recording[name][wrong[0]])))
    if problems:
        raise CosimError(problems)
