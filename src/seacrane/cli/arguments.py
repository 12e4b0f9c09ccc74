"""What the commands share: how they are declared, files that they write, and how a check tells what it found."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from seacrane.errors import ParameterError, Problem

if TYPE_CHECKING:
    from seacrane.results import Recording

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"
"""What `add_subparsers` gives, and commands are added to."""


def output(text: str) -> Path:
    """A file to be written: that it can be is better known before a long run than after it."""
    path = Path(text)
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f"{text!r} cannot be written; give a file in a folder that exists")
    return path


def verdict(file: str | os.PathLike[str], problems: Sequence[Problem]) -> int:
    """Print what a check has found in a file; the exit code of the command: 0 if nothing, else 1."""
    for problem in problems:
        print(problem)
    print(f"{os.fspath(file)}: {len(problems) or 'no'} problem{'s' if len(problems) != 1 else ''}")
    return 1 if problems else 0


def save_plot(run: Recording, names: Sequence[str], path: Path, title: str = "") -> None:
    """Write beside and rename; the suffix says the kind of picture."""
    beside = path.with_name(f".{path.stem}.part{path.suffix or '.svg'}")
    try:
        run.plot(*names, title=title).savefig(beside)
        beside.replace(path)
    except ValueError as error:
        raise ParameterError.at(str(path), f"cannot be drawn: {error}") from None
    finally:
        beside.unlink(missing_ok=True)
