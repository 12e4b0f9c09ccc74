"""`seacrane run`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING

from seacrane.errors import CosimError, ParameterError, Problem, SeacraneError, UnitError, nearest
from seacrane.units import value_of

from .arguments import Commands, output, picture, save_figure, settings

if TYPE_CHECKING:
    from seacrane.cosim import Algorithm, Execution, Experiment, Pace, System
    from seacrane.results import Recording

_MOST_NAMED, _MOST_PLOTTED = 8, 12


def add(commands: Commands) -> None:
    """Declare the command."""
    run = commands.add_parser("run", help="run a coupled system: SSP, SSD or OspSystemStructure.xml")
    run.add_argument("file", type=Path, help="FILE.ssp, FILE.ssd or OspSystemStructure.xml")
    run.add_argument("--until", type=float, metavar="S", help="end of the run [s] (default: that of the file)")
    run.add_argument("--step", type=float, metavar="S", help="macro step [s] (default: that of the file)")
    run.add_argument(
        "--algorithm", metavar="NAME", help="co-simulation algorithm (default: that of the file, or gauss-seidel)"
    )
    settings(run, "parameter or input that nothing drives")
    run.add_argument(
        "--signals",
        type=lambda text: text.split(","),
        metavar="NAME,...",
        help="what to record; * stands for any characters (default: all outputs and bonds)",
    )
    run.add_argument("--every", type=float, metavar="S", help="record each so many seconds (default: each macro step)")
    run.add_argument(
        "--record",
        "--csv",
        type=output,
        metavar="FILE",
        help="record while it runs: FILE.csv, FILE.arrow (survives a crash), or FILE.parquet (made of that at the end)",
    )
    run.add_argument("--plot", type=picture, metavar="FILE", help="plot what was recorded (SVG, PNG or PDF)")
    run.add_argument("--scenario", type=Path, metavar="FILE", help="events to carry out (JSON, seacrane-scenario/1)")
    run.add_argument("--resume", type=Path, metavar="FILE", help="go on from a state that --save has written")
    run.add_argument("--save", type=output, metavar="FILE", help="save the whole state at the end")
    run.add_argument("--speed", type=float, metavar="X", help="run at X times real time (default: as fast as it can)")
    run.add_argument("--progress", action="store_true", help="show how far the run is")
    run.set_defaults(run=_run)


def _run(options: argparse.Namespace) -> int:
    from seacrane import cosim

    system = cosim.load(options.file)
    experiment = system.experiment
    until = _needed(options.until, experiment.stop, "--until")
    if not until > experiment.start:
        raise CosimError.at("--until", "is not after the start", value=until, allowed=f"above {experiment.start:g} s")
    step = _needed(options.step, experiment.step, "--step")
    name = options.algorithm or experiment.algorithm or "gauss-seidel"
    if name not in cosim.ALGORITHMS:
        allowed = ", ".join(cosim.ALGORITHMS)
        raise CosimError.at("--algorithm", "there is no such algorithm", value=name, allowed=allowed)
    given = settings_of(system, options.set)
    signals = _signals(system, options.signals)
    tell_surprises(system, given, "saved" if options.resume else "start")
    with cosim.Execution(system, _algorithm(name, step, experiment), start=experiment.start) as run:
        for variable, value in given.items():
            run.set(variable, value)
        if options.scenario:
            run.follow(cosim.scenario.load(options.scenario, run.variables))
        if options.resume:
            run.restore_file(options.resume)
            if not until > run.time:
                raise CosimError.at(
                    "--until", "is not after the saved state", value=until, allowed=f"above {run.time:g} s"
                )
        recorder = run.record(signals, every=options.every)
        if options.record:
            run.record_file(options.record, signals, every=options.every)
        try:
            run.start()
            pace = _advance(run, until, options)
            if options.save:
                run.save_file(options.save)
        except SeacraneError:
            run.flush()
            if run.usage.macro_steps and (options.record or options.plot):
                print(f"seacrane: the results until {run.time:g} s are kept", file=sys.stderr)
            raise
        finally:
            if options.plot and len(recorder.recording()) > 1:
                recording = recorder.recording()
                _draw(recording, signals or list(recording.signals), options.plot)
        if options.progress:
            _progress(run)(run.time, until)
            print(file=sys.stderr)
        _summary(system, run, name)
        if pace is not None:
            print(
                f"{options.speed:g} times real time: {pace.overruns} overruns, {1e3 * pace.lateness_p99:.3g} ms late "
                f"(99th percentile), {pace.lost_s:.3g} s not made up for"
            )
        if options.record:
            print(f"{options.record}: {len(recorder.recording().signals)} signals, {len(recorder.recording())} rows")
        elif not options.plot:
            _last(run, recorder.recording().signals)
    return 0


def _advance(run: Execution, until: float, options: argparse.Namespace) -> Pace | None:
    """Run to the end; how well the pace was kept, if there is one."""
    from seacrane import cosim

    progress = _progress(run) if options.progress else None
    if options.speed is None:
        run.run(until, progress)
        return None
    pacing = cosim.RealTime(run, speed=options.speed)
    while run.steps_to(until):
        pacing.advance(min(until, run.time + 0.1 * options.speed))
        if progress is not None:
            progress(run.time, until)
    return pacing.pace


def _algorithm(name: str, step: float, experiment: Experiment) -> Algorithm:
    """The algorithm with its macro step [s], and with the steps of slaves that the file gives."""
    from seacrane import cosim

    algorithm = cosim.ALGORITHMS[name](step)
    if not experiment.steps:
        return algorithm
    if isinstance(algorithm, (cosim.GaussSeidel, cosim.Jacobi)):
        return replace(algorithm, rates={slave: step / own for slave, own in experiment.steps.items()})
    print(f"seacrane: {name} steps all slaves together, so the file's steps of slaves are not used", file=sys.stderr)
    return algorithm


def _needed(given: float | None, of_file: float | None, option: str) -> float:
    value = of_file if given is None else given
    if value is None:
        raise CosimError.at(option, "is not given, and the file does not say it")
    return value


def settings_of(system: System, texts: list[str]) -> dict[str, float]:
    """Values by variable or connector, each in its unit."""
    values: dict[str, float] = {}
    problems: list[Problem] = []
    known = (*system.variables, *system.level.connectors)
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            problems.append(Problem("--set", "is not NAME=VALUE", text))
        elif name in known:
            try:
                values[name] = value_of(value, system.unit_of(name) or "1", name)
            except UnitError as error:
                problems += error.problems
        else:
            problems.append(Problem(name, "no such variable", hint=nearest(name, known)))
    if problems:
        raise ParameterError(problems)
    return values


def _signals(system: System, patterns: list[str] | None) -> list[str] | None:
    """The names asked for, each once; None for the default."""
    if patterns is None:
        return None
    causalities = system.causalities
    known = [name for name, causality in causalities.items() if causality != "parameter"]
    names: dict[str, None] = {}
    problems = []
    for pattern in patterns:
        found = [n for n in known if fnmatchcase(n, pattern)] or list(_behind(system, pattern))
        if not found:
            problems.append(Problem(pattern, "is no variable that can be recorded", hint=nearest(pattern, known)))
        names |= dict.fromkeys(found)
    if problems:
        raise ParameterError(problems)
    return list(names)


def _behind(system: System, connector: str) -> Iterator[str]:
    """The variables that a connector of the system stands for."""
    if connector in system.level.connectors:
        for link in system.behind(connector):
            yield link.source if system.level.connectors[connector].kind == "output" else link.target


def tell_surprises(system: System, settings: Mapping[str, float], of: str) -> None:
    """What may surprise: notes of the reader, and inputs that nothing drives."""
    for note in system.notes:
        print(f"seacrane: {note}", file=sys.stderr)
    given = {target for name in settings for target, _, _ in system.settable_connectors.get(name, ((name, 1.0, 0.0),))}
    open_inputs = [name for name in system.open_inputs if name not in given]
    if open_inputs:
        named = ", ".join(open_inputs[:_MOST_NAMED]) + (", ..." if len(open_inputs) > _MOST_NAMED else "")
        they = (
            f"input is not connected and keeps its {of} value"
            if len(open_inputs) == 1
            else f"inputs are not connected and keep their {of} values"
        )
        print(f"seacrane: {len(open_inputs)} {they}: {named}", file=sys.stderr)


def _progress(run: Execution) -> Callable[[float, float], None]:
    """Prints how far a run is, on one line."""

    def tell(time: float, until: float) -> None:
        factor = run.usage.real_time_factor
        print(f"\r{time:10.3f} of {until:g} s, real-time factor {factor:.3g} ", end="", file=sys.stderr, flush=True)

    return tell


def _summary(system: System, run: Execution, algorithm: str) -> None:
    usage = run.usage
    print(
        f"{system.name}: {usage.simulated_s:g} s simulated, {algorithm}, {usage.macro_steps} macro steps of "
        f"{run.macro_step:g} s; {usage.busy_s:.3g} s of computing, real-time factor {usage.real_time_factor:.3g}"
    )
    for name, bond in run.bonds.items():
        share = f"{100 * bond.relative_error:.2g} %" if bond.energy_moved else "none moved"
        print(f"bond {name}: energy error {bond.energy_error:.3g} J of {bond.energy_moved:.3g} J moved ({share})")


def _draw(recording: Recording, names: list[str], path: Path) -> None:
    drawn = names[:_MOST_PLOTTED]
    save_figure(recording.plot(*drawn), path)
    print(f"{path}: {', '.join(drawn)}")
    if len(names) > len(drawn):
        print(f"seacrane: {len(names) - len(drawn)} more are not drawn; choose with --signals", file=sys.stderr)


def _last(run: Execution, names: Mapping[str, object]) -> None:
    width = max(map(len, names), default=0)
    for name, value in zip(names, run.values(list(names)), strict=True):
        print(f"{name:{width}}  {value:12.6g} {run.variables[name].unit}")
