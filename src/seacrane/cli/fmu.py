"""`seacrane fmu check`."""

from __future__ import annotations

import argparse
from pathlib import Path

from .arguments import Commands


def add(commands: Commands) -> None:
    """Declare the command."""
    fmu = commands.add_parser("fmu", help="look at an FMU").add_subparsers(required=True, metavar="ACTION")
    check = fmu.add_parser("check", help="list all that is wrong with an FMU, with the rule of the standard")
    check.add_argument("file", type=Path)
    check.set_defaults(run=_check_fmu)


def _check_fmu(options: argparse.Namespace) -> int:
    from seacrane import fmi

    problems = fmi.check(options.file)
    for problem in problems:
        print(problem)
    print(f"{options.file}: {len(problems) or 'no'} problem{'s' if len(problems) != 1 else ''}")
    return 1 if problems else 0
