"""The observers of a run, each with the rows that the loop fills for it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

from seacrane.cosim.algorithms import nanoseconds
from seacrane.cosim.loops import Loop, append
from seacrane.cosim.observers import ArrowRecorder, CsvRecorder, MemoryRecorder, Observer
from seacrane.cosim.plan import Plan, Rows
from seacrane.errors import CosimError, Problem, SeacraneError

KINDS: Mapping[str, type[CsvRecorder | ArrowRecorder]] = {
    ".csv": CsvRecorder,
    ".arrow": ArrowRecorder,
    ".parquet": ArrowRecorder,
}

Watch = Callable[[], None]
"""Reads the internal variables that are watched into the values of the plan."""


class Recorder:
    """An observer with its rows."""

    def __init__(self, observer: Observer, rows: Rows) -> None:
        self.observer, self.rows = observer, rows

    def drain(self) -> None:
        """Hand over the rows."""
        count, self.rows.count = self.rows.count, 0
        if count:
            self.observer.write(self.rows.table[:count])

    def flush(self) -> None:
        self.drain()
        self.observer.flush()

    def close(self) -> None:
        try:
            self.drain()
        finally:
            self.observer.close()


class Recorders:
    """All recorders of a run. Those that record at present have their rows in the plan."""

    def __init__(self, plan: Plan, loop: Loop) -> None:
        self._plan, self._loop = plan, loop
        self._all: list[Recorder] = []

    @property
    def in_memory(self) -> MemoryRecorder | None:
        """The first one in memory."""
        return next((r.observer for r in self._all if isinstance(r.observer, MemoryRecorder)), None)

    def add(
        self,
        observer: Observer,
        signals: Mapping[str, tuple[str, str]],
        indices: npt.NDArray[np.int64],
        watches: bool,
        every: float | None,
    ) -> Recorder:
        """Open an observer for signals, {name: (unit, unit shown)}, at these places in the values."""
        stride = 1 if every is None else self._stride(every)
        capacity = max(64, min(4096, 262_144 // (1 + len(signals))))
        rows = Rows(stride, indices, watches, np.zeros((capacity, 1 + len(signals))))
        observer.open(signals)
        self._all.append(Recorder(observer, rows))
        return self._all[-1]

    def begin(self, recorder: Recorder) -> bool:
        """From now on the loop fills its rows; whether it did not before."""
        if self._records(recorder):
            return False
        self._plan.rows.append(recorder.rows)
        self._loop.refresh()
        return True

    def end(self, recorder: Recorder) -> None:
        recorder.drain()
        self._plan.rows = [rows for rows in self._plan.rows if rows is not recorder.rows]
        self._loop.refresh()

    def first_rows(self, watch: Watch) -> None:
        for recorder in self._all:
            if self._records(recorder):
                self.first_row(recorder, watch)

    def first_row(self, recorder: Recorder, watch: Watch) -> None:
        """The row of the present time."""
        if self._plan.done % recorder.rows.stride == 0:
            if recorder.rows.watches:
                watch()
            append(recorder.rows, self._plan.time_ns / 1e9, self._plan)

    def drain(self) -> None:
        """Hand all rows over."""
        self._each(Recorder.drain)

    def flush(self) -> None:
        """Hand all rows over, and let the observers bring them to where others can read them."""
        self._each(Recorder.flush)

    def forget_after(self, time: float) -> None:
        for recorder in self._all:
            recorder.observer.forget_after(time)

    def _each(self, do: Callable[[Recorder], None]) -> None:
        """Do something with all recorders, also when one of them cannot."""
        problems: list[Problem] = []
        for recorder in self._all:
            try:
                do(recorder)
            except SeacraneError as error:
                problems += error.problems
        if problems:
            raise CosimError(problems)

    def _records(self, recorder: Recorder) -> bool:
        return any(rows is recorder.rows for rows in self._plan.rows)

    def _stride(self, every: float) -> int:
        """How many macro steps `every` [s] is."""
        wanted, step = nanoseconds(every, "every"), self._plan.schedule.step_ns
        stride = max(1, round(wanted / step))
        if abs(wanted - stride * step) > stride:  # the step itself is rounded to whole nanoseconds
            below = wanted // step
            near = " or ".join(f"{n * step / 1e9:.9g}" for n in (below, below + 1) if n > 0)
            what = f"is no multiple of the macro step of {step / 1e9:.9g} s"
            raise CosimError.at("every", what, value=every, allowed=f"{near} s, for example")
        return stride


def file_recorder(path: str | Path) -> CsvRecorder | ArrowRecorder:
    """The observer that writes a file of the kind that its suffix says."""
    kind = KINDS.get(Path(path).suffix)
    if kind is None:
        allowed = f"a name that ends in {', '.join(KINDS)}"
        raise CosimError.at(str(path), "is of no kind of file to record into", allowed=allowed)
    return kind(path)
