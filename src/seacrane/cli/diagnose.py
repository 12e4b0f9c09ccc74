"""`seacrane diagnose`."""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from seacrane.errors import ParameterError

from .arguments import Commands, output, picture, settings
from .run import settings_of, tell_surprises

if TYPE_CHECKING:
    from seacrane.cosim import Execution


def add(commands: Commands) -> None:
    """Declare the command."""
    diagnose = commands.add_parser(
        "diagnose", help="find which bond of a coupled system limits its step, and which algorithm to take"
    )
    diagnose.add_argument("file", type=Path, help="FILE.ssp, FILE.ssd or OspSystemStructure.xml")
    diagnose.add_argument("--until", type=float, metavar="S", help="end of each run [s] (default: that of the file)")
    diagnose.add_argument(
        "--steps",
        type=_numbers,
        metavar="S,...",
        help="macro steps to try [s], each a divisor of the longest (default: that of the file, halved and doubled)",
    )
    diagnose.add_argument(
        "--algorithms", type=lambda text: text.split(","), metavar="NAME,...", help="algorithms to try (default: six)"
    )
    diagnose.add_argument("--tolerance", type=float, default=0.01, metavar="X", help="error asked for (default 0.01)")
    settings(diagnose, "parameter or input that nothing drives")
    diagnose.add_argument("--scenario", type=Path, metavar="FILE", help="events that make the system move (JSON)")
    diagnose.add_argument(
        "--patience", type=float, default=60.0, metavar="S", help="longest run, by the clock [s] (60)"
    )
    diagnose.add_argument("--json", type=output, metavar="FILE", help="write all that was measured")
    diagnose.add_argument("--plot", type=picture, metavar="FILE", help="plot error against cost (SVG, PNG or PDF)")
    diagnose.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    from seacrane import cosim

    system = cosim.load(options.file)
    given = settings_of(system, options.set)
    tell_surprises(system, given, "start")

    def prepare(run: Execution) -> None:
        for variable, value in given.items():
            run.set(variable, value)
        if options.scenario:
            run.follow(cosim.scenario.load(options.scenario, run.variables))

    found = cosim.diagnose(
        system,
        until=options.until,
        steps=options.steps,
        algorithms=options.algorithms or cosim.diagnosis.SWEPT,
        tolerance=options.tolerance,
        prepare=prepare,
        patience=options.patience,
        progress=_progress() if sys.stderr.isatty() else None,
    )
    print(found)
    if options.json:
        options.json.write_text(json.dumps(found.as_dict(), indent=1, allow_nan=False) + "\n", encoding="utf-8")
    if options.plot:
        try:
            found.figure().savefig(options.plot)
        except ValueError as error:
            raise ParameterError.at(str(options.plot), f"cannot be drawn: {error}") from None
    return 0


def _numbers(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not a list of numbers, as 0.001,0.002") from None


def _progress() -> Callable[[int, int, str], None]:
    """A bar over the runs that are done, and what is run."""
    begun = time.monotonic()

    def tell(done: int, total: int, what: str) -> None:
        bar, end = "#" * (30 * done // total), "\n" if done == total else ""
        seconds = time.monotonic() - begun
        print(f"\r[{bar:<30}] {done} of {total}, {seconds:.0f} s: {what:<32}", end=end, file=sys.stderr, flush=True)

    return tell
