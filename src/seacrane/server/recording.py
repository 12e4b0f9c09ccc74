"""All variables at 50 Hz: rows of doubles in a file without a name, turned into CSV when it is downloaded.

The simulation process appends, the server reads; both hold the same open file, which has no name in any folder and
so is gone with the last of them. A row is the time and then every variable, little-endian binary64. A row handed to
the kernel survives the end of the process that wrote it.
"""

from __future__ import annotations

import os
import tempfile
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final

import msgspec
import numpy as np

from seacrane.cosim.observers import Observer
from seacrane.cosim.slave import Vector

PERIOD: Final = 0.02
"""Time between rows [s], to the nearest whole macro step."""
LIMIT: Final = 2 * 1024**3
"""Size at which recording stops [bytes]."""
_ROWS_AT_ONCE: Final = 256
_encoder = msgspec.json.Encoder()


def create() -> int:
    """A new recording file; its descriptor, to be inherited by the simulation process."""
    with tempfile.TemporaryFile(prefix="seacrane-recording-") as file:
        return os.dup(file.fileno())


class Tape(Observer):
    """Appends rows to the file. On the first failure it stops for good, with all rows so far intact."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._width = 0
        self.rows = 0
        self.stopped: str | None = None
        """Why it has stopped."""

    def open(self, signals: Mapping[str, tuple[str, str]]) -> None:
        """Begin anew with an empty file."""
        self._width = 8 * (1 + len(signals))
        os.ftruncate(self._descriptor, 0)

    def write(self, table: Vector) -> None:
        """Append rows."""
        if self.stopped is not None:
            return
        data = table.astype("<f8").tobytes()
        end = self.rows * self._width
        if end + len(data) > LIMIT:
            self.stopped = f"it has reached its limit of {LIMIT // 1024**2} MiB"
            return
        try:
            written = os.pwrite(self._descriptor, data, end)
        except OSError as error:
            self.stopped = error.strerror or str(error)
            return
        self.rows += written // self._width
        if written != len(data):
            self.stopped = "no space is left on the disk"

    def forget_after(self, time: float) -> None:
        """Drop rows later than this."""
        self.rows = bisect_right(range(self.rows), time, key=self._time)
        os.ftruncate(self._descriptor, self.rows * self._width)
        self.stopped = None

    def close(self) -> None:
        """The file stays readable."""

    def _time(self, row: int) -> float:
        return float(np.frombuffer(os.pread(self._descriptor, 8, row * self._width), "<f8")[0])


def last_time(descriptor: int, rows: int, count: int) -> float:
    """Time of the last of `rows` rows of `count` variables [s]; 0 if there is none."""
    data = os.pread(descriptor, 8, (rows - 1) * 8 * (count + 1)) if rows else b""
    return float(np.frombuffer(data, "<f8")[0]) if len(data) == 8 else 0.0


def csv_lines(
    descriptor: int,
    rows: int,
    count: int,
    columns: Sequence[int],
    header: str,
    current: Callable[[], bool],
) -> Iterator[bytes]:
    """The CSV of the first `rows` rows with these columns, piece by piece; ends early once `current()` is false.

    Numbers are the shortest text that reads back as the same double; what is no number is `nan`.
    """
    yield header.encode()
    width = count + 1
    chosen = np.array([0, *(column + 1 for column in columns)])
    for first in range(0, rows, _ROWS_AT_ONCE):
        wanted = min(_ROWS_AT_ONCE, rows - first)
        data = os.pread(descriptor, wanted * width * 8, first * width * 8)
        if len(data) < wanted * width * 8 or not current():
            return
        block = np.frombuffer(data, "<f8").reshape(wanted, width)[:, chosen]
        text = b"\n".join(_encoder.encode(row)[1:-1] for row in block.tolist()) + b"\n"
        yield text.replace(b"null", b"nan")
