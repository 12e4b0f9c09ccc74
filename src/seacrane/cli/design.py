"""`seacrane design check`."""

from __future__ import annotations

import argparse

from seacrane.errors import DesignError

from .arguments import Commands, verdict


def add(commands: Commands) -> None:
    """Declare the command."""
    design = commands.add_parser("design", help="look at a design").add_subparsers(required=True, metavar="ACTION")
    check = design.add_parser("check", help="list all that is wrong with a design file")
    check.add_argument("file")
    check.set_defaults(run=_check_design)


def _check_design(options: argparse.Namespace) -> int:
    from seacrane import design

    try:
        design.load(options.file)
    except DesignError as error:
        return verdict(options.file, error.problems)
    return verdict(options.file, ())
