"""`seacrane simulate`."""

from __future__ import annotations

import argparse
import sys
from typing import TYPE_CHECKING

from seacrane.errors import ParameterError, Problem, SolveError, nearest

from .arguments import Commands, output, picture, save_figure, settings

if TYPE_CHECKING:
    from seacrane.results import Recording


def add(commands: Commands) -> None:
    """Declare the command."""
    run = commands.add_parser("simulate", help="run a model file by itself")
    run.add_argument("file", help="model file (JSON)")
    run.add_argument("--until", type=float, required=True, metavar="S", help="end of the run [s]")
    run.add_argument("--every", type=float, default=0.01, metavar="S", help="output step [s] (default 0.01)")
    run.add_argument("--csv", type=output, metavar="FILE", help="write the signals as CSV, in SI")
    run.add_argument("--plot", type=picture, metavar="FILE", help="plot the signals (SVG, PNG or PDF)")
    run.add_argument(
        "--signals",
        type=lambda text: text.split(","),
        metavar="NAME,...",
        help="what to write and plot (default: in the plot inputs and outputs, or states where it has no outputs; "
        "in the CSV all but unset parameters)",
    )
    settings(run, "parameter, input or start value")
    run.add_argument("--solver", default="rodas4", metavar="NAME", help="name of the solver (default rodas4)")
    run.add_argument("--tolerance", type=float, default=1e-6, metavar="T", help="relative tolerance (default 1e-6)")
    run.set_defaults(run=_simulate)


def _setting(text: str) -> tuple[str, str]:
    name, equals, value = text.partition("=")
    if not equals or not name.strip() or not value.strip():
        raise ParameterError.at("--set", "is not NAME=VALUE", value=text)
    return name.strip(), value.strip()


def _simulate(options: argparse.Namespace) -> int:
    from seacrane import model

    diagram = model.load(options.file)
    dae = diagram.compile()
    names = [v.name for v in dae.variables]
    unknown = [name for name in options.signals or () if name not in names]
    if unknown:
        raise ParameterError(_unknown_signals(unknown, names))
    shown = [v.name for v in dae.inputs + (dae.outputs or dae.states)]
    given = dict(map(_setting, options.set))
    constant = {v.name for v in dae.parameters} - given.keys()
    try:
        run = model.simulate(
            dae,
            options.until,
            every=options.every,
            parameters=model.settings(diagram, dae, given),
            record=options.signals or [name for name in names if name not in constant],
            solver=options.solver,
            tolerance=options.tolerance,
        )
    except SolveError as error:
        if error.results is not None and len(error.results):
            _write(error.results, options, shown)
            until = f"until {error.results.time[-1]:g} s"
            print(f"seacrane: the results {until} were kept", file=sys.stderr)
        raise
    _write(run, options, shown)
    print(f"{diagram.name}: {options.until:g} s simulated")
    for doubt in run.doubts:
        print(f"seacrane: {doubt}", file=sys.stderr)
    if run.statistics is not None:
        done = run.statistics
        print(f"{done.solver}: {done.steps} steps, {done.cpu_time:.3g} s, real-time factor {done.real_time_factor:.2g}")
    return 0


def _unknown_signals(unknown: list[str], names: list[str]) -> list[Problem]:
    return [Problem(name, "is not a signal of the model", hint=nearest(name, names)) for name in unknown]


def _write(run: Recording, options: argparse.Namespace, shown: list[str]) -> None:
    if options.csv:
        run.to_csv(options.csv)
        print(f"{options.csv}: {len(run.signals)} signals, {len(run)} rows")
    if options.plot:
        names = options.signals or [name for name in shown if name in run.signals] or list(run.signals)[:12]
        save_figure(run.plot(*names), options.plot)
        print(f"{options.plot}: {', '.join(names)}")
