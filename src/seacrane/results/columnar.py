"""Recordings in columns: an Arrow stream that survives a crash while it is written, and Parquet to keep.

A recording is written live as an Arrow IPC stream with zstd: whatever part of it is on the disk can be read up to its
last complete batch. Once complete it is best kept as Parquet, which pandas, xarray, MATLAB and DuckDB read.

The first column is `time` in s; each column has its SI unit and the unit it is shown in as metadata of its field
(`unit`, `display`), and the schema has `format`. Files of others are read too if their columns are numbers, the first
is the time, and each other one has such metadata or a name `name [unit]`. (Apache Arrow columnar format 1.5, section
"Serialization and Interprocess Communication".)
"""

from __future__ import annotations

import io
import os
import threading
import time as wall
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import numpy.typing as npt
import pyarrow as pa
import pyarrow.parquet as pq

from seacrane import documents, units
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.results.csv_file import COLUMN
from seacrane.results.recording import Recording, Signal

Table = npt.NDArray[np.float64]

FORMAT: Final = "seacrane-recording/1"
BATCH_S: Final = 0.05
"""Rows wait at most this wall time [s] for others before they are written together; with the 0.15 s for which a run
collects rows, less than a quarter of a second is lost when the process is killed."""
SYNC_S: Final = 1.0
"""Wall time [s] after which the file is brought to the disk, so that it survives a loss of power too."""
BATCH_VALUES: Final = 1 << 20
"""So many values are written at once, however short the time; no more than four times as many wait."""

_END: Final = b"\xff\xff\xff\xff\x00\x00\x00\x00"


class StreamWriter:
    """Writes rows of (time, values...) to an Arrow stream; `OSError` if the file cannot be written.

    A thread compresses and writes, so that a slow disk does not hold up a simulation. When the disk is full the file
    is cut back to its last complete batch, and the error comes with the next call.
    """

    def __init__(self, path: str | Path, signals: Mapping[str, tuple[str, str]]) -> None:
        self._schema = _schema(signals)
        self._text = io.BytesIO()
        self._stream = pa.ipc.new_stream(
            self._text,
            self._schema,
            options=pa.ipc.IpcWriteOptions(compression=pa.Codec("zstd", compression_level=1), use_threads=False),
        )
        self._descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o644)
        self._ends: list[tuple[float, int]] = []
        self._end = 0
        self._waiting: list[Table] = []
        self._size = 0
        self._closing = False
        self._failure: OSError | None = None
        self._changed = threading.Condition()
        self._file = threading.Lock()
        self._thread = threading.Thread(target=self._work, name="seacrane-recorder", daemon=True)
        try:
            # The stream writes its schema with the first batch: with one without rows, here.
            self._encode(np.empty((0, len(self._schema))))
            self._put(self._encoded())
        except BaseException:
            os.close(self._descriptor)
            raise
        self._begun = self._end
        self._thread.start()

    def write(self, table: Table) -> None:
        """Rows of shape (rows, 1 + signals); they are copied. Waits only if the disk is far behind."""
        with self._changed:
            self._waiting.append(table.copy())
            self._size += table.size
            if self._size >= BATCH_VALUES:
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._size < 4 * BATCH_VALUES or self._failure is not None)
            self._check()

    def flush(self) -> None:
        """Write all rows that wait; they then survive the end of the process."""
        self._drain()
        self._check()

    def forget_after(self, time: float) -> None:
        """Take rows later than `time` [s] out of the file."""
        self.flush()
        with self._file:
            kept = len(self._ends)
            while kept and self._ends[kept - 1][0] > time:
                kept -= 1
            begin = self._ends[kept - 1][1] if kept else self._begun
            rest = os.pread(self._descriptor, self._ends[kept][1] - begin, begin) if kept < len(self._ends) else b""
            os.ftruncate(self._descriptor, begin)
            self._end, self._ends = begin, self._ends[:kept]
        if rest:
            batch = pa.ipc.read_record_batch(pa.ipc.read_message(rest), self._schema)
            table = np.column_stack([column.to_numpy() for column in batch.columns])
            if (table[:, 0] <= time).any():
                self.write(table[table[:, 0] <= time])
                self.flush()

    def close(self) -> None:
        """Write what waits, the end of the stream, and bring it to the disk; closing twice does no harm."""
        if self._closing:
            return
        with self._changed:
            self._closing = True
            self._changed.notify_all()
        self._thread.join()
        try:
            self._drain()
            if self._failure is None:
                self._put(_END)
                os.fsync(self._descriptor)
        except OSError as error:
            self._failure = error
        finally:
            os.close(self._descriptor)
        self._check()

    def _check(self) -> None:
        if self._failure is not None:
            raise self._failure

    def _work(self) -> None:
        synced = wall.monotonic()
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._closing or self._size >= BATCH_VALUES, timeout=BATCH_S)
                if self._closing:
                    return
            self._drain()
            if wall.monotonic() - synced >= SYNC_S:
                synced = wall.monotonic()
                # A file that cannot be synchronised, such as a pipe, is none that could be lost.
                with suppress(OSError):
                    os.fsync(self._descriptor)

    def _drain(self) -> None:
        with self._file:
            with self._changed:
                tables, self._waiting, self._size = self._waiting, [], 0
                self._changed.notify_all()
            if not tables or self._failure is not None:
                return
            table = np.concatenate(tables)
            self._encode(table)
            try:
                self._put(self._encoded())
            except OSError as error:
                with self._changed:
                    self._failure = error
                    self._changed.notify_all()
                return
            self._ends.append((float(table[-1, 0]), self._end))

    def _encode(self, table: Table) -> None:
        columns = np.ascontiguousarray(table.T)
        self._stream.write_batch(pa.record_batch([pa.array(c) for c in columns], schema=self._schema))

    def _encoded(self) -> bytes:
        """What the stream has put into its buffer since the last time."""
        data = self._text.getvalue()
        self._text.seek(0)
        self._text.truncate()
        return data

    def _put(self, data: bytes) -> None:
        """Write at the end; all of it or nothing."""
        rest = memoryview(data)
        try:
            os.lseek(self._descriptor, self._end, os.SEEK_SET)
            while rest:
                rest = rest[os.write(self._descriptor, rest) :]
        except OSError:
            with suppress(OSError):
                os.ftruncate(self._descriptor, self._end)
            raise
        self._end += len(data)


def _schema(signals: Mapping[str, tuple[str, str]]) -> pa.Schema:
    fields = [pa.field("time", pa.float64(), nullable=False, metadata={"unit": "s", "display": "s"})]
    for name, (unit, shown) in signals.items():
        fields.append(pa.field(name, pa.float64(), nullable=False, metadata={"unit": unit, "display": shown}))
    return pa.schema(fields, metadata={"format": FORMAT})


# ---------------------------------------------------------------- reading
class Source:
    """A recording in an Arrow stream, an Arrow file or a Parquet file, batch by batch.

    `ParameterError` if it is none. `complete` is known after the batches have been read: whether the file ends as it
    should, or was cut off, and then `batches` gave what there is.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        self.complete = False
        try:
            with self.path.open("rb") as file:
                magic = file.read(8)
        except OSError as error:
            raise ParameterError.at(str(path), f"cannot be read: {error.strerror}") from error
        try:
            if magic.startswith(b"PAR1"):
                self._file: Any = pq.ParquetFile(self.path)
                self.schema = self._file.schema_arrow
            elif magic.startswith(b"ARROW1"):
                self._file = pa.ipc.open_file(pa.OSFile(str(self.path)))
                self.schema = self._file.schema
            else:
                self._input = pa.OSFile(str(self.path))
                self._file = pa.ipc.open_stream(self._input)
                self.schema = self._file.schema
        except (pa.ArrowException, OSError) as error:
            what = "is not a recording, or was cut off before its first row"
            raise ParameterError.at(str(path), what, hint=_first_line(error)) from None
        self.signals = _columns(self.schema, self.path)

    def batches(self) -> Iterator[pa.RecordBatch]:
        if isinstance(self._file, pq.ParquetFile):
            yield from self._file.iter_batches()
            self.complete = True
        elif isinstance(self._file, pa.ipc.RecordBatchFileReader):
            for i in range(self._file.num_record_batches):
                yield self._file.get_batch(i)
            self.complete = True
        else:
            try:
                yield from self._file
            except (pa.ArrowException, OSError):
                return
            size = self.path.stat().st_size
            with self.path.open("rb") as file:
                file.seek(max(0, size - len(_END)))
                self.complete = file.read() == _END


def read(path: str | Path) -> Recording:
    """The recording in a file; of a stream that was cut off, all complete batches. `ParameterError` if it is none."""
    source = Source(path)
    try:
        table = pa.Table.from_batches(source.batches(), source.schema)
        columns = [column.cast(pa.float64()).to_numpy() for column in table.columns]
    except (pa.ArrowException, OSError) as error:
        raise ParameterError.at(str(path), f"is damaged: {_first_line(error)}") from None
    signals = {
        name: Signal(unit, shown, column)
        for (name, (unit, shown)), column in zip(source.signals.items(), columns[1:], strict=True)
    }
    return Recording(columns[0], signals)


def _columns(schema: pa.Schema, path: Path) -> dict[str, tuple[str, str]]:
    """{name: (unit, display)} of all columns but the time; `ParameterError` with each that is wrong."""
    problems, signals = [], {}
    for i, field in enumerate(schema):
        metadata = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
        match = COLUMN.match(field.name)
        name, unit = field.name, metadata.get("unit")
        if unit is None and match is not None:
            name, unit = match["name"], match["unit"]
        if not (pa.types.is_floating(field.type) or pa.types.is_integer(field.type)):
            problems.append(Problem(str(path), f"column {field.name!r} does not hold numbers", str(field.type)))
        elif i == 0:
            if (name, unit) != ("time", "s"):
                problems.append(Problem(str(path), "the first column is not the time", field.name, "time [s]"))
        elif unit is None:
            problems.append(Problem(str(path), "a column has no unit", field.name, "metadata 'unit', or name [unit]"))
        elif unit not in units.UNITS:
            hint = nearest(unit, units.UNITS)
            problems.append(Problem(str(path), f"column {name!r} has an unknown unit", unit, hint=hint))
        elif name in signals:
            problems.append(Problem(str(path), "a column appears twice", name))
        else:
            signals[name] = (unit, metadata.get("display", ""))
    if not len(schema):
        problems.append(Problem(str(path), "has no columns"))
    if problems:
        raise ParameterError(problems)
    return signals


# ---------------------------------------------------------------- writing what is complete
@dataclass(frozen=True)
class Converted:
    """What was written: `complete` is false if the source had been cut off, and this is what it held."""

    rows: int
    signals: int
    complete: bool


def to_parquet(source: Source, target: str | Path) -> Converted:
    """Write a recording as Parquet with zstd, beside and renamed once it has been read back.

    `OSError` if it cannot be written; a file that was there before is then still there.
    """
    schema = _schema(source.signals)
    with documents.whole(target) as beside:
        rows = 0
        with pq.ParquetWriter(beside, schema, compression="zstd", use_dictionary=False) as writer:
            for table in _gathered(source):
                rows += len(table)
                columns = [column.cast(pa.float64()) for column in table.columns]
                writer.write_table(pa.table(columns, schema=schema))
        # On a full disk, closing raises nothing and leaves what cannot be read.
        try:
            there = pq.ParquetFile(beside).metadata.num_rows
        except (pa.ArrowException, OSError):
            there = -1
        if there != rows:
            raise OSError(5, "what was written cannot be read back; is the disk full?")
    return Converted(rows, len(source.signals), source.complete)


def _gathered(source: Source) -> Iterator[pa.Table]:
    """The batches of a source in tables that are large enough for Parquet to be read fast."""
    waiting: list[pa.RecordBatch] = []
    for batch in source.batches():
        waiting.append(batch)
        if sum(map(len, waiting)) * len(source.schema) >= 4 * BATCH_VALUES:
            yield pa.Table.from_batches(waiting, source.schema)
            waiting = []
    if waiting:
        yield pa.Table.from_batches(waiting, source.schema)


def write(recording: Recording, path: str | Path) -> None:
    """Write a recording as Parquet; `OSError` if it cannot be written."""
    signals = {name: (signal.unit, signal.display) for name, signal in recording.signals.items()}
    columns = [recording.time, *(signal.values for signal in recording.signals.values())]
    with documents.whole(path) as beside:
        pq.write_table(
            pa.table([pa.array(c) for c in columns], schema=_schema(signals)),
            beside,
            compression="zstd",
            use_dictionary=False,
        )


def _first_line(error: BaseException) -> str:
    return str(error).partition("\n")[0]
