"""CSV files of recordings: readable by people and spreadsheets, and exact.

The header is `time [s]` and then `name [unit]` for each signal; values are SI, written so that the nearest double is
the one that was recorded. Each row ends with a newline: a last row without one was being written when its program
died, and is left out on reading.
"""

from __future__ import annotations

import csv
import io
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from seacrane import documents, units
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.results.recording import Recording, signals_of

COLUMN = re.compile(r"^(?P<name>.*\S)\s*\[(?P<unit>[^\[\]]*)\]$")
"""A column's heading: its name, and its unit in brackets."""


def header(signals: Mapping[str, str]) -> str:
    """The header line for {name: SI unit}."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerow(["time [s]", *(f"{n} [{u}]" for n, u in signals.items())])
    return text.getvalue()


def rows(table: Iterable[Iterable[float]]) -> str:
    """Lines for rows of (time, values...); `repr` of a float is the shortest text that reads back exactly."""
    return "".join(",".join(map(repr, row)) + "\n" for row in table)


def write(recording: Recording, path: str | Path) -> None:
    """No half-written file is ever found under `path`."""
    columns = [recording.time, *(s.values for s in recording.signals.values())]
    table = np.column_stack(columns).tolist() if len(recording) else []
    documents.write(header({n: s.unit for n, s in recording.signals.items()}) + rows(table), path)


def read(path: str | Path) -> Recording:
    """The recording in a file; `ParameterError` if it is not one, with every column that is wrong."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise ParameterError.at(str(path), f"cannot be read: {error.strerror}") from error
    except UnicodeDecodeError:
        raise ParameterError.at(str(path), "is not a recording: neither text in UTF-8 nor Arrow nor Parquet") from None
    complete = text[: text.rfind("\n") + 1]
    top, _, body = complete.partition("\n")
    if not top:
        raise ParameterError.at(str(path), "has no complete header line", allowed="time [s],name [unit],...")
    names = _columns(next(csv.reader([top])), path)
    try:
        table = np.loadtxt(io.StringIO(body), delimiter=",", ndmin=2, comments=None) if body else np.empty((0, 0))
    except ValueError as error:
        raise ParameterError.at(str(path), f"is not a table of numbers: {error}") from None
    if not table.size:
        table = np.empty((0, len(names) + 1))
    if table.shape[1] != len(names) + 1:
        raise ParameterError.at(str(path), f"has {table.shape[1]} values in a row for {len(names) + 1} columns")
    return Recording(table[:, 0], signals_of({n: (u, units.display(u)) for n, u in names.items()}, table[:, 1:]))


def _columns(cells: list[str], path: Path) -> dict[str, str]:
    problems, names = [], {}
    if cells[0].strip() != "time [s]":
        problems.append(Problem(str(path), "the first column is not the time", cells[0], "time [s]"))
    for cell in cells[1:]:
        match = COLUMN.match(cell.strip())
        if match is None:
            problems.append(Problem(str(path), "a column has no unit", cell, "name [unit]"))
        elif match["unit"] not in units.UNITS:
            hint = nearest(match["unit"], units.UNITS)
            problems.append(
                Problem(str(path), f"column {match['name']!r} has an unknown unit", match["unit"], hint=hint)
            )
        elif match["name"] in names:
            problems.append(Problem(str(path), "a column appears twice", cell))
        else:
            names[match["name"]] = match["unit"]
    if problems:
        raise ParameterError(problems)
    return names
