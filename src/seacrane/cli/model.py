"""`seacrane model show` and `seacrane model check`."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from seacrane import documents
from seacrane.units import convert, with_unit

from .arguments import Commands, output, verdict

if TYPE_CHECKING:
    from seacrane.model import Diagram


def add(commands: Commands) -> None:
    """Declare the command."""
    model = commands.add_parser("model", help="look at a model file").add_subparsers(required=True, metavar="ACTION")
    show = model.add_parser("show", help="print its parameters, equations, bond graph and sources")
    show.add_argument("file", help="model file (JSON)")
    show.add_argument(
        "--svg",
        type=output,
        metavar="FILE",
        help="draw it: FILE is the iconic diagram, and beside it goes the bond graph (drive.svg, drive.bonds.svg)",
    )
    show.set_defaults(run=_show)
    check = model.add_parser("check", help="list all that is wrong with a model file")
    check.add_argument("file", help="model file (JSON)")
    check.set_defaults(run=_check)


def _show(options: argparse.Namespace) -> int:
    from seacrane import model

    diagram = model.load(options.file)
    graph = diagram.bond_graph()
    sections = (
        (f"{diagram.name}: parameters", _parameters(diagram)),
        ("ports", [f"{name}: {handle.path}" for name, handle in diagram.exposed.items()]),
        ("equations", str(diagram.equations()).splitlines()),
        ("bond graph", str(graph).splitlines()),
        ("sources", diagram.sources()),
    )
    for title, lines in sections:
        print(f"{title}\n{'-' * len(title)}")
        print("\n".join(lines) + "\n")
    if options.svg:
        bonds = options.svg.with_suffix(f".bonds{options.svg.suffix or '.svg'}")
        _draw(diagram.icons_svg(), options.svg)
        _draw(graph.svg(), bonds)
    return 0


def _draw(svg: str, path: Path) -> None:
    documents.write(svg, path)
    print(f"{path}: drawn")


def _parameters(diagram: Diagram) -> Iterator[str]:
    """A line for each parameter: its name, its value in engineering units, and what it is."""
    rows = []
    for parameter in diagram.parameters():
        shown = parameter.display_unit
        value = with_unit(convert(parameter.start, parameter.unit, shown), shown, ".6g")
        rows.append((parameter.name, value, parameter.about))
    widths = [max((len(row[i]) for row in rows), default=0) for i in (0, 1)]
    for name, value, about in rows:
        yield f"{name:<{widths[0]}}  {value:>{widths[1]}}  {about}"


def _check(options: argparse.Namespace) -> int:
    from seacrane import model

    return verdict(options.file, model.check(options.file))
