"""`seacrane designer`."""

from __future__ import annotations

import argparse

from .arguments import Commands


def add(commands: Commands) -> None:
    """Declare the command."""
    designer = commands.add_parser("designer", help="draw a crane in the browser: workspace, load chart, parts")
    designer.add_argument(
        "design", nargs="?", help="a design that comes with the package, a design file, or an exported ZIP"
    )
    designer.add_argument("--host", default="127.0.0.1", help="address to listen on (default 127.0.0.1)")
    designer.add_argument("--port", type=int, default=8472, help="port of the page (default 8472); 0 takes a free one")
    designer.add_argument("--allow-remote", action="store_true", help="allow an address other than this machine's own")
    designer.set_defaults(run=_designer)


def _designer(options: argparse.Namespace) -> int:
    from seacrane.operation import demo
    from seacrane.server import serve_designer

    from .design import load

    serve_designer(
        demo.FACTORY,
        opened=load(options.design) if options.design else None,
        host=options.host,
        port=options.port,
        allow_remote=options.allow_remote,
    )
    return 0
