"""The command line: `seacrane demo`, `seacrane fmu check`, `seacrane design check`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from seacrane import __version__
from seacrane.errors import SeacraneError


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; 0 if all went well, 1 if a check found problems, 2 if the command could not be carried out."""
    options = _parser().parse_args(arguments)
    try:
        status: int = options.run(options)
    except SeacraneError as error:
        for problem in error.problems:
            print(f"seacrane: {error.code}: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    return status


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="seacrane", description="Marine cranes: designed, modelled, simulated, operated."
    )
    parser.add_argument("--version", action="version", version=f"seacrane {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    demo = commands.add_parser("demo", help="drive the 100 t knuckle boom crane in the browser, or headless")
    demo.add_argument("--crane", default="offshore-100t", help="name of a shipped crane, or a design file (JSON)")
    demo.add_argument("--load", type=float, default=40.0, metavar="T", help="load on the hook [t] (default 40)")
    demo.add_argument(
        "--sea",
        choices=("swell", "jonswap", "calm"),
        default="swell",
        help="the sea that is drawn, and what the ship follows",
    )
    demo.add_argument("--hs", type=float, default=2.0, metavar="M", help="significant wave height [m] (default 2)")
    demo.add_argument("--tp", type=float, default=9.0, metavar="S", help="peak period [s] (default 9)")
    demo.add_argument("--step", type=float, default=2.0, metavar="MS", help="macro step [ms] (default 2)")
    demo.add_argument("--host", default="127.0.0.1", help="address to listen on (default 127.0.0.1)")
    demo.add_argument("--port", type=int, default=8470, help="port of the page (default 8470); 0 takes a free one")
    demo.add_argument(
        "--tcp-port", type=int, default=8471, help="port of JSON-RPC over TCP (default 8471); 0 takes a free one"
    )
    demo.add_argument("--allow-remote", action="store_true", help="allow an address other than this machine's own")
    demo.add_argument("--headless", action="store_true", help="no page: drive a recorded joystick as fast as it goes")
    demo.add_argument("--seconds", type=float, default=20.0, help="simulated time of a headless run [s] (default 20)")
    demo.add_argument("--realtime", action="store_true", help="pace a headless run to the clock")
    demo.add_argument("--report", type=_output, metavar="FILE", help="write the report of a headless run as JSON")
    demo.add_argument("--csv", type=_output, metavar="FILE", help="write the signals of a headless run as CSV")
    demo.set_defaults(run=_demo)

    fmu = commands.add_parser("fmu", help="look at an FMU").add_subparsers(required=True, metavar="ACTION")
    check = fmu.add_parser("check", help="list all that is wrong with an FMU, with the rule of the standard")
    check.add_argument("file", type=Path)
    check.set_defaults(run=_check_fmu)

    design = commands.add_parser("design", help="look at a design").add_subparsers(required=True, metavar="ACTION")
    check = design.add_parser("check", help="list all that is wrong with a design file")
    check.add_argument("file")
    check.set_defaults(run=_check_design)
    return parser


def _output(text: str) -> Path:
    """A file to be written: that it can be is better known before a long run than after it."""
    path = Path(text)
    if path.is_dir() or not os.access(path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f"{text!r} cannot be written; give a file in a folder that exists")
    return path


def _demo(options: argparse.Namespace) -> int:
    from seacrane.operation import demo

    settings = demo.Settings(
        crane=options.crane,
        load=options.load * 1e3,
        sea=options.sea,
        hs=options.hs,
        tp=options.tp,
        step=options.step * 1e-3,
    )
    if options.headless:
        report = demo.run_headless(settings, options.seconds, realtime=options.realtime, csv=options.csv)
        print(demo.summary(report))
        if options.report:
            demo.write_report(report, options.report)
        return 0
    from seacrane.server import serve

    serve(
        demo.FACTORY,
        arguments=asdict(settings),
        host=options.host,
        port=options.port,
        tcp_port=options.tcp_port,
        allow_remote=options.allow_remote,
    )
    return 0


def _check_fmu(options: argparse.Namespace) -> int:
    from seacrane import fmi

    problems = fmi.check(options.file)
    for problem in problems:
        print(problem)
    print(f"{options.file}: {len(problems) or 'no'} problem{'s' if len(problems) != 1 else ''}")
    return 1 if problems else 0


def _check_design(options: argparse.Namespace) -> int:
    from seacrane import design

    crane = design.load(options.file)
    print(f"{options.file}: {crane.name}, no problems")
    return 0


if __name__ == "__main__":
    sys.exit(main())
