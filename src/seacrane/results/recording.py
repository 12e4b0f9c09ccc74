"""`Recording`: signals over one time axis, in SI, with the units they are shown in."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from seacrane import units
from seacrane.errors import ParameterError, Problem, UnitError, nearest

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Vector = npt.NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Signal:
    """Values of one variable in SI `unit`, shape (times,), and the engineering unit `display` it is shown in."""

    unit: str
    display: str
    values: Vector

    def __post_init__(self) -> None:
        values = np.array(self.values, dtype=np.float64)
        values.flags.writeable = False
        object.__setattr__(self, "values", values)
        object.__setattr__(self, "display", self.display or units.display(self.unit))
        if not units.compatible(self.unit, self.display):
            raise UnitError.at("", f"a signal in {self.unit!r} cannot be shown in {self.display!r}")


@dataclass(frozen=True, eq=False)
class Recording:
    """Signals by name over a common `time` axis [s], shape (times,).

    `ParameterError` if a signal has not one value per time.
    """

    time: Vector
    signals: Mapping[str, Signal] = field(default_factory=dict)

    def __post_init__(self) -> None:
        time = np.array(self.time, dtype=np.float64)
        time.flags.writeable = False
        object.__setattr__(self, "time", time)
        object.__setattr__(self, "signals", MappingProxyType(dict(self.signals)))
        problems = [
            Problem(name, f"has {signal.values.size} values for {time.size} times")
            for name, signal in self.signals.items()
            if signal.values.shape != time.shape
        ]
        if problems:
            raise ParameterError(problems)

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.signals)

    def __getitem__(self, name: str) -> Vector:
        """The values of a signal in SI; `ParameterError` with the nearest names if there is none."""
        return self.signal(name).values

    def __contains__(self, name: object) -> bool:
        return name in self.signals

    def __iter__(self) -> Iterator[str]:
        return iter(self.signals)

    def __len__(self) -> int:
        """The number of times."""
        return int(self.time.size)

    def signal(self, name: str) -> Signal:
        self._require((name,))
        return self.signals[name]

    def select(self, *names: str) -> Recording:
        """Only these signals, in this order."""
        self._require(names)
        return Recording(self.time, {name: self.signals[name] for name in names})

    def between(self, begin: float, end: float) -> Recording:
        """The part with begin <= time <= end [s]."""
        inside = (self.time >= begin) & (self.time <= end)
        return Recording(
            self.time[inside], {n: Signal(s.unit, s.display, s.values[inside]) for n, s in self.signals.items()}
        )

    def at(self, times: npt.ArrayLike) -> Recording:
        """All signals interpolated linearly at `times` [s].

        `ParameterError` if a time lies outside the recorded interval: there is no extrapolation.
        """
        wanted = np.atleast_1d(np.asarray(times, dtype=np.float64))
        if len(self) == 0:
            raise ParameterError.at("time", "the recording is empty")
        first, last = float(self.time[0]), float(self.time[-1])
        outside = wanted[(wanted < first) | (wanted > last)]
        if outside.size:
            raise ParameterError.at(
                "time", "is outside the recording", value=float(outside[0]), allowed=f"{first:g} to {last:g} s"
            )
        return Recording(
            wanted,
            {n: Signal(s.unit, s.display, np.interp(wanted, self.time, s.values)) for n, s in self.signals.items()},
        )

    def resample(self, every: float) -> Recording:
        """All signals interpolated at multiples of `every` [s] from the first time on."""
        if not every > 0:
            raise ParameterError.at("every", "must be positive", value=every)
        if len(self) == 0:
            return self
        count = int(np.floor((self.time[-1] - self.time[0]) / every * (1 + 1e-12)))
        return self.at(np.minimum(self.time[0] + every * np.arange(count + 1), self.time[-1]))

    def rmse(self, other: Recording, name: str, reference: str | None = None) -> float:
        """Root mean square of this signal `name` minus the `other` recording's `reference` (same name by default).

        In SI, at the times of this recording within the other's interval, the other interpolated linearly.
        """
        mine, theirs = self.signal(name), other.signal(reference or name)
        if not units.compatible(mine.unit, theirs.unit):
            raise UnitError.at(name, f"a signal in {mine.unit!r} cannot be compared with one in {theirs.unit!r}")
        if len(self) == 0 or len(other) == 0:
            raise ParameterError.at(name, "an empty recording has nothing to compare")
        common = (self.time >= other.time[0]) & (self.time <= other.time[-1])
        if not common.any():
            raise ParameterError.at(name, "the two recordings have no time in common")
        factor = units.unit(theirs.unit).factor / units.unit(mine.unit).factor
        there = np.interp(self.time[common], other.time, theirs.values) * factor
        return float(np.sqrt(np.mean((mine.values[common] - there) ** 2)))

    def to_csv(self, path: str | Path, names: tuple[str, ...] | list[str] | None = None) -> None:
        """Write the signals (all by default) as CSV; see `seacrane.results.csv_file` for the format."""
        from seacrane.results.csv_file import write

        write(self if names is None else self.select(*names), path)

    @classmethod
    def read_csv(cls, path: str | Path) -> Recording:
        """Read what `to_csv` or a CSV observer has written, also after a crash of the writer."""
        from seacrane.results.csv_file import read

        return read(path)

    def to_parquet(self, path: str | Path, names: tuple[str, ...] | list[str] | None = None) -> None:
        """Write the signals (all by default) as Parquet; see `seacrane.results.columnar` for the format."""
        from seacrane.results.columnar import write

        write(self if names is None else self.select(*names), path)

    @classmethod
    def read(cls, path: str | Path) -> Recording:
        """Read a CSV, Arrow or Parquet file, whichever it is, also after a crash of the writer."""
        from seacrane.results.files import read

        return read(path)

    def plot(self, *names: str, unit: str | float | None = None, title: str = "") -> Figure:
        """Plot signals (all by default) over time: one axes for each unit, the time axis shared.

        `unit` is the unit shown instead of each signal's own, as symbol (`"bar"`) or constant (`units.bar`).
        """
        from seacrane.results.plot import plot

        return plot(self.select(*(names or self.names)), unit, title)

    def _require(self, names: tuple[str, ...] | list[str]) -> None:
        problems = [
            Problem(name, "no such signal in the recording", hint=nearest(name, self.signals))
            for name in names
            if name not in self.signals
        ]
        if problems:
            raise ParameterError(problems)

    def __repr__(self) -> str:
        span = f"{self.time[0]:g} to {self.time[-1]:g} s" if len(self) else "empty"
        return f"{type(self).__name__}({len(self)} times, {span}, {len(self.signals)} signals)"


def signals_of(names: Mapping[str, tuple[str, str]], columns: Any) -> dict[str, Signal]:
    """Signals from {name: (unit, display)} and the columns of an array of shape (times, names)."""
    return {name: Signal(unit, shown, columns[:, i]) for i, (name, (unit, shown)) in enumerate(names.items())}
