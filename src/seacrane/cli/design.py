"""`seacrane design check`."""

from __future__ import annotations

import argparse

from .arguments import Commands


def add(commands: Commands) -> None:
    """Declare the command."""
    design = commands.add_parser("design", help="look at a design").add_subparsers(required=True, metavar="ACTION")
    check = design.add_parser("check", help="list all that is wrong with a design file")
    check.add_argument("file")
    check.set_defaults(run=_check_design)


def _check_design(options: argparse.Namespace) -> int:
    from seacrane import design

    crane = design.load(options.file)
    print(f"{options.file}: {crane.name}, no problems")
    return 0
