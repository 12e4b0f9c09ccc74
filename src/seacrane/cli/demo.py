"""`seacrane demo`."""

from __future__ import annotations

import argparse
from dataclasses import asdict

from .arguments import Commands, output


def add(commands: Commands) -> None:
    """Declare the command."""
    demo = commands.add_parser("demo", help="drive a crane at sea in the browser, or headless")
    demo.add_argument("--crane", default="offshore-100t", help="name of a shipped crane, or a design file (JSON)")
    demo.add_argument(
        "--load",
        type=float,
        metavar="T",
        help="load on the hook [t] (40, or what the crane bears with a fifth in hand)",
    )
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
    demo.add_argument("--report", type=output, metavar="FILE", help="write the report of a headless run as JSON")
    demo.add_argument("--csv", type=output, metavar="FILE", help="write the signals of a headless run as CSV")
    demo.set_defaults(run=_demo)


def _demo(options: argparse.Namespace) -> int:
    from seacrane.operation import demo

    settings = demo.Settings(
        crane=options.crane,
        load=None if options.load is None else options.load * 1e3,
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
