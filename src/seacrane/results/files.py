"""Files of recordings of whatever kind: read, and turned into another kind."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from seacrane import documents
from seacrane.errors import ParameterError
from seacrane.results import columnar, csv_file
from seacrane.results.columnar import Converted
from seacrane.results.recording import Recording

_MAGIC = (b"PAR1", b"ARROW1", b"\xff\xff\xff\xff")
"""How Parquet files, Arrow files and Arrow streams begin; everything else is text."""


def read(path: str | Path) -> Recording:
    """The recording in a file: CSV, Arrow or Parquet, told apart by their content; `ParameterError` if it is none.

    What a crash has left of a CSV file or an Arrow stream is read up to its last complete row or batch.
    """
    return columnar.read(path) if _columnar(path) else csv_file.read(path)


def convert(source: str | Path, target: str | Path) -> Converted:
    """Turn a recording into Parquet or CSV, as the suffix of `target` says; also one that a crash has cut off.

    The target appears complete or not at all. `ParameterError` if the source is no recording, or the target cannot be
    written.
    """
    target = Path(target)
    if target.suffix not in (".parquet", ".csv"):
        raise ParameterError.at(str(target), "is of no kind to convert to", allowed="a name in .parquet or .csv")
    if target.exists() and Path(source).exists() and target.samefile(source):
        raise ParameterError.at(str(target), "is the file to be converted")
    try:
        if not _columnar(source):
            return _from_csv(source, target)
        recording = columnar.Source(source)
        return columnar.to_parquet(recording, target) if target.suffix == ".parquet" else _to_csv(recording, target)
    except OSError as error:
        raise ParameterError.at(os.fspath(target), f"cannot be written: {error.strerror or error}") from error


def _columnar(path: str | Path) -> bool:
    try:
        with Path(path).open("rb") as file:
            return file.read(8).startswith(_MAGIC)
    except OSError as error:
        raise ParameterError.at(os.fspath(path), f"cannot be read: {error.strerror}") from error


def _from_csv(source: str | Path, target: Path) -> Converted:
    recording = csv_file.read(source)
    (recording.to_parquet if target.suffix == ".parquet" else recording.to_csv)(target)
    with Path(source).open("rb") as file:
        file.seek(-1, os.SEEK_END)
        complete = file.read() == b"\n"
    return Converted(len(recording), len(recording.signals), complete)


def _to_csv(source: columnar.Source, target: Path) -> Converted:
    rows = 0
    with documents.whole(target) as part, part.open("w", encoding="utf-8") as file:
        file.write(csv_file.header({name: unit for name, (unit, _) in source.signals.items()}))
        for batch in source.batches():
            table = np.column_stack([column.to_numpy(zero_copy_only=False) for column in batch.columns])
            file.write(csv_file.rows(table.astype(np.float64).tolist()))
            rows += len(batch)
    return Converted(rows, len(source.signals), source.complete)
