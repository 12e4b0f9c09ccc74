"""`seacrane recording show` and `convert`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .arguments import Commands, output


def add(commands: Commands) -> None:
    """Declare the command."""
    recording = commands.add_parser("recording", help="look at a recording, convert it, recover it after a crash")
    actions = recording.add_subparsers(required=True, metavar="ACTION")
    show = actions.add_parser("show", help="list the signals of a recording with their ranges")
    show.add_argument("file", type=Path, help="CSV, Arrow or Parquet file")
    show.set_defaults(run=_show)

    convert = actions.add_parser(
        "convert", help="write a recording as Parquet or CSV; of one that was cut off by a crash, all that can be read"
    )
    convert.add_argument("file", type=Path, help="CSV, Arrow or Parquet file")
    convert.add_argument("target", type=output, help="FILE.parquet or FILE.csv")
    convert.set_defaults(run=_convert)


def _show(options: argparse.Namespace) -> int:
    from seacrane.results import Recording
    from seacrane.units import convert

    recording = Recording.read(options.file)
    rows = len(recording)
    span = f" from {recording.time[0]:g} to {recording.time[-1]:g} s" if rows else ""
    print(f"{options.file}: {len(recording.signals)} signals, {rows} rows{span}")
    width = max((len(name) for name in recording), default=0)
    for name, signal in recording.signals.items():
        low, high = (signal.values.min(), signal.values.max()) if rows else (float("nan"), float("nan"))
        low, high = (convert(float(value), signal.unit, signal.display) for value in (low, high))
        print(f"{name:{width}}  {low:12.6g} to {high:12.6g} {signal.display}")
    return 0


def _convert(options: argparse.Namespace) -> int:
    from seacrane.results import convert

    done = convert(options.file, options.target)
    print(f"{options.target}: {done.signals} signals, {done.rows} rows")
    if not done.complete:
        print(f"seacrane: {options.file} was cut off: these are all its complete rows", file=sys.stderr)
    return 0
