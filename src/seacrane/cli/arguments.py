"""What the commands share: how they are declared, files that they write, and how a check tells what it found."""

from __future__ import annotations

import argparse
import os
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from seacrane import documents
from seacrane.errors import Problem

if TYPE_CHECKING:
    from seacrane.results import Figure

Commands: TypeAlias = "argparse._SubParsersAction[argparse.ArgumentParser]"
"""What `add_subparsers` gives, and commands are added to."""


def output(text: str) -> Path:
    """A file to be written: that it can be is better known before a long run than after it."""
    path = Path(text)
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f"{text!r} cannot be written; give a file in a folder that exists")
    return path


def picture(text: str) -> Path:
    """A picture to be written, of a kind that its suffix says."""
    path = output(text)
    if path.suffix.lower() not in (".svg", ".png", ".pdf"):
        raise argparse.ArgumentTypeError(f"{text!r} is of no kind of picture; give a name in .svg, .png or .pdf")
    return path


def settings(parser: argparse.ArgumentParser, what: str) -> None:
    """`--set NAME=VALUE`, which means the same in every command that has it."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help=f"{what}, as pump.pressure='210 bar'; a bare number is in the variable's own unit (SI in our own models)",
    )


def verdict(file: str | os.PathLike[str], problems: Sequence[Problem]) -> int:
    """Print what a check has found in a file; the exit code of the command: 0 if nothing, else 1."""
    for problem in problems:
        print(problem)
    print(f"{os.fspath(file)}: {len(problems) or 'no'} problem{'s' if len(problems) != 1 else ''}")
    return 1 if problems else 0


def save_figure(figure: Figure, path: Path) -> None:
    """An existing picture is replaced only once the new one is complete."""
    with documents.whole(path) as part:
        figure.savefig(part)
