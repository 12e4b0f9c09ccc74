"""Observers only watch: they are handed rows of (time, values...) from the loop, and change nothing in the run."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from seacrane.cosim.slave import Vector
from seacrane.errors import CosimError
from seacrane.results import Recording, Signal, StreamWriter, convert, csv_file


class Observer(ABC):
    """Calls come in the order open -> write* -> close; `write` at least each 250 ms while the run advances."""

    @abstractmethod
    def open(self, signals: Mapping[str, tuple[str, str]]) -> None:
        """What comes: {name: (SI unit, unit shown)} in the order of the columns after the time."""

    @abstractmethod
    def write(self, table: Vector) -> None:
        """Rows of (time, values...), shape (rows, 1 + signals); the array is reused after the call."""

    def flush(self) -> None:
        """Nothing more may come for a while: what was handed over is to be where others can read it."""
        return

    @abstractmethod
    def forget_after(self, time: float) -> None:
        """The run went back to `time` [s]: what was recorded later did not happen."""

    @abstractmethod
    def close(self) -> None:
        """Nothing more comes."""


class MemoryRecorder(Observer):
    """Keeps rows in memory: all, or those of the last `keep` seconds of simulated time."""

    def __init__(self, keep: float | None = None) -> None:
        self._keep = keep
        self._signals: Mapping[str, tuple[str, str]] = {}
        self._chunks: deque[Vector] = deque()

    def open(self, signals: Mapping[str, tuple[str, str]]) -> None:
        self._signals = dict(signals)

    def write(self, table: Vector) -> None:
        self._chunks.append(table.copy())
        if self._keep is not None:
            oldest = table[-1, 0] - self._keep
            while self._chunks[0][-1, 0] < oldest:
                self._chunks.popleft()

    def forget_after(self, time: float) -> None:
        kept = (chunk[chunk[:, 0] <= time] for chunk in self._chunks)
        self._chunks = deque(chunk for chunk in kept if len(chunk))

    def close(self) -> None:
        """What was recorded stays readable."""

    def recording(self) -> Recording:
        """What has been handed over so far."""
        width = 1 + len(self._signals)
        table = np.concatenate(self._chunks) if self._chunks else np.empty((0, width))
        if self._keep is not None and len(table):
            table = table[table[:, 0] >= table[-1, 0] - self._keep]
        signals = {
            name: Signal(unit, shown, table[:, 1 + i]) for i, (name, (unit, shown)) in enumerate(self._signals.items())
        }
        return Recording(table[:, 0], signals)


class CsvRecorder(Observer):
    """Writes rows to a CSV file (`seacrane.results.csv_file`), unbuffered: what was handed over survives a crash.

    `CosimError` if the file cannot be written. After a run went back in time, the file goes on with the earlier time.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self._descriptor: int | None = None

    def open(self, signals: Mapping[str, tuple[str, str]]) -> None:
        try:
            self._descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        except OSError as error:
            raise CosimError.at(str(self.path), f"cannot be written: {error.strerror}") from error
        self._write(csv_file.header({name: unit for name, (unit, _) in signals.items()}))

    def write(self, table: Vector) -> None:
        self._write(csv_file.rows(table.tolist()))

    def forget_after(self, time: float) -> None:
        """A file is not rewritten."""

    def close(self) -> None:
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def _write(self, text: str) -> None:
        if self._descriptor is None:
            return
        rest = memoryview(text.encode())
        try:
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError as error:
            self.close()
            raise CosimError.at(str(self.path), f"cannot be written: {error.strerror}") from error


class ArrowRecorder(Observer):
    """Writes rows to a crash-safe file in columns: an Arrow stream (`seacrane.results.columnar`).

    What was handed over survives the end of the process once it is older than a quarter of a second, and a loss of
    power once it is older than a second or so. If `path` ends in `.parquet`, the stream is kept beside it as
    `.parquet.arrow` and turned into Parquet when the recorder is closed. `CosimError` if the file cannot be written.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.live = self.path if self.path.suffix == ".arrow" else self.path.with_name(f"{self.path.name}.arrow")
        """The stream: what there is after a crash."""
        self._writer: StreamWriter | None = None

    def open(self, signals: Mapping[str, tuple[str, str]]) -> None:
        with self._told():
            self._writer = StreamWriter(self.live, signals)

    def write(self, table: Vector) -> None:
        if self._writer is not None:
            with self._told():
                self._writer.write(table)

    def flush(self) -> None:
        if self._writer is not None:
            with self._told():
                self._writer.flush()

    def forget_after(self, time: float) -> None:
        if self._writer is not None:
            with self._told():
                self._writer.forget_after(time)

    def close(self) -> None:
        writer, self._writer = self._writer, None
        if writer is None:
            return
        with self._told():
            writer.close()
        if self.path != self.live:
            convert(self.live, self.path)
            self.live.unlink()

    @contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            writer, self._writer = self._writer, None
            if writer is not None:
                # What was written before stays readable; that the end is missing is what the error says.
                with suppress(OSError):
                    writer.close()
            raise CosimError.at(str(self.live), f"cannot be written: {error.strerror}") from error
