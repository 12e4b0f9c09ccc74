"""`seacrane fmu check`, `info`, `run`, `export` and `compare`."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .arguments import Commands, output, picture, save_figure, settings, verdict

if TYPE_CHECKING:
    from seacrane.fmi import ModelDescription
    from seacrane.results import Recording


def add(commands: Commands) -> None:
    """Declare the command."""
    fmu = commands.add_parser("fmu", help="make FMUs, look at them and run them").add_subparsers(
        required=True, metavar="ACTION"
    )
    check = fmu.add_parser(
        "check",
        help="list all that is wrong with an FMU, with the rule of the standard",
        description="Lists all that is wrong with an FMU. Its own code is run only where its binary does not "
        "show the GUID, in a process of its own.",
    )
    check.add_argument("file", type=Path)
    check.set_defaults(run=_check_fmu)

    info = fmu.add_parser("info", help="say what an FMU is, and list its variables")
    info.add_argument("file", type=Path)
    info.set_defaults(run=_info)

    run = fmu.add_parser("run", help="run an FMU by itself")
    run.add_argument("file", type=Path)
    _settings(run)
    run.add_argument(
        "--signals",
        "--output",
        type=lambda text: re.split(r",(?![^\[]*\])", text),  # no comma of the subscripts of an element
        metavar="NAME,...",
        help="what to record (default: all outputs that are numbers)",
    )
    run.add_argument("--csv", type=output, metavar="FILE", help="write what was recorded as CSV")
    run.add_argument("--plot", type=picture, metavar="FILE", help="plot what was recorded (SVG, PNG or PDF)")
    run.set_defaults(run=_run)

    export = fmu.add_parser("export", help="write a model as an FMU for co-simulation and model exchange")
    export.add_argument("file", help="model file (JSON)")
    export.add_argument("--version", choices=("2.0", "3.0"), default="2.0", help="version of FMI (default 2.0)")
    export.add_argument(
        "--platforms",
        default="host",
        metavar="host|all|LIST",
        help="what its binaries are for: this machine (default), all, or names as x86_64-windows,aarch64-linux",
    )
    export.add_argument("--sources", action="store_true", help="put the C sources inside; without, no equation shows")
    export.add_argument(
        "--wasm", action="store_true", help="also write it as a WebAssembly module for web pages, beside the FMU"
    )
    export.add_argument("--out", type=output, required=True, metavar="FILE", help="the FMU to be written")
    export.set_defaults(run=_export)

    compare = fmu.add_parser("compare", help="run two FMUs alike and show how far their outputs are apart")
    compare.add_argument("first", type=Path)
    compare.add_argument("second", type=Path)
    _settings(compare)
    compare.add_argument(
        "--within",
        type=float,
        metavar="R",
        help="fail if an output deviates by more than this part of its largest value",
    )
    compare.set_defaults(run=_compare)


def _settings(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--until", type=float, required=True, metavar="S", help="end of the run [s]")
    parser.add_argument("--step", type=float, default=0.01, metavar="S", help="communication step [s] (default 0.01)")
    parser.add_argument("--input", type=Path, metavar="CSV", help="inputs over time: `time [s],name [unit],...`")
    settings(parser, "start value")
    parser.add_argument("--kind", choices=("co-simulation", "model-exchange"), help="which kind of an FMU of both")
    parser.add_argument("--tolerance", type=float, metavar="T", help="relative tolerance of the solver")


def _check_fmu(options: argparse.Namespace) -> int:
    from seacrane import fmi

    return verdict(options.file, fmi.check(options.file))


def _info(options: argparse.Namespace) -> int:
    from seacrane import fmi

    d = fmi.read(options.file)
    facts = {
        "model": d.model_name,
        "about": d.description,
        "version": d.version,
        "FMI": f"{d.fmi_version}, {_kinds(d)}",
        "made by": d.generation_tool,
        "binaries": ", ".join(d.platforms) or "none",
        "sources": "C" if d.has_sources else "none",
        "states": str(len(d.derivatives)),
        "icons": ", ".join(f"{name} ({len(icon) / 1024:.1f} KiB)" for name, icon in fmi.icons(options.file).items()),
    }
    for key, value in facts.items():
        if value:
            print(f"{key:10} {value}")
    print()
    _print_table(
        ("name", "causality", "variability", "type", "start", "unit", "description"),
        [
            (
                v.name,
                v.causality,
                v.variability,
                v.type + "".join(f"[{n}]" for n in v.shape),
                "" if v.start is None else _short(v.start),
                _unit(v.unit),
                v.description,
            )
            for v in d.variables
        ],
    )
    if d.terminals:
        print()
        _print_table(
            ("terminal", "kind", "matching", "members", "description"),
            [
                (t.name, t.kind, t.matching, ", ".join(f"{m} = {v}" for m, v in t.members.items()), t.description)
                for t in d.terminals
            ],
        )
    return 0


def _kinds(d: ModelDescription) -> str:
    kinds = {
        "co-simulation": d.co_simulation,
        "model exchange": d.model_exchange,
        "scheduled execution": d.scheduled_execution,
    }
    return " and ".join(name for name, there in kinds.items() if there)


def _run(options: argparse.Namespace) -> int:
    recording = _recording(options, options.file, options.signals)
    if options.csv:
        recording.to_csv(options.csv)
        print(f"{options.csv}: {len(recording)} rows")
    if options.plot:
        save_figure(recording.plot(title=options.file.stem), options.plot)
        print(f"{options.plot}: drawn")
    if not options.csv and not options.plot:
        rows = [(n, f"{s.values[-1]:.6g}", _unit(s.unit)) for n, s in recording.signals.items()]
        _print_table(("name", f"at {recording.time[-1]:g} s", "unit"), rows)
    return 0


def _export(options: argparse.Namespace) -> int:
    from seacrane import fmi, model
    from seacrane.errors import FmuError

    beside = options.out.with_suffix(".wasm")
    if options.wasm and beside == options.out:
        raise FmuError.at("--out", "is the name of the module beside it; the FMU needs another", value=str(options.out))
    diagram = model.load(options.file)
    platforms = options.platforms if options.platforms in ("host", "all") else options.platforms.split(",")
    fmi.export(
        diagram,
        options.out,
        version=options.version,
        sources=options.sources,
        platforms=platforms,
        progress=lambda stage: print(f"{options.out.name}: {stage}", file=sys.stderr),
    )
    d = fmi.read(options.out)
    what = [
        f"FMI {d.fmi_version} for {_kinds(d)}",
        f"{len(d.inputs)} inputs, {len(d.outputs)} outputs, {len(d.derivatives)} states",
        ", ".join(d.platforms),
        *(["C sources"] if d.has_sources else []),
        f"{options.out.stat().st_size / 1024:.0f} kB",
    ]
    print(f"{options.out}: {'; '.join(what)}")
    if options.wasm:
        print(f"{options.out.name}: compiling for WebAssembly", file=sys.stderr)
        module = fmi.export_wasm(diagram, beside)
        print(f"{module}: WebAssembly; {module.stat().st_size / 1024:.0f} kB")
    return 0


def _compare(options: argparse.Namespace) -> int:
    from seacrane import fmi

    runs = [_recording(options, path, None) for path in (options.first, options.second)]
    deviations = fmi.compare(*runs)
    rows = [
        (d.name, f"{d.largest:.3g}", f"{d.rms:.3g}", _unit(d.unit), f"{d.relative:.3g}", f"{d.at:g} s")
        for d in deviations
    ]
    _print_table(("output", "largest", "rms", "unit", "relative", "at"), rows)
    if options.within is None:
        return 0
    far = [d.name for d in deviations if not d.relative <= options.within]
    print(f"{', '.join(far) if far else 'no output'} deviates by more than {options.within:g} of its largest value")
    return 1 if far else 0


def _recording(options: argparse.Namespace, path: Path, outputs: list[str] | None) -> Recording:
    from seacrane import fmi
    from seacrane.results import Recording

    description = fmi.read(path)
    return fmi.run(
        path,
        options.until,
        options.step,
        values=_values(description, options.set),
        inputs=Recording.read_csv(options.input) if options.input else None,
        outputs=outputs,
        kind=options.kind,
        tolerance=options.tolerance,
    )


def _values(description: ModelDescription, texts: list[str]) -> Mapping[str, Any]:
    from seacrane import fmi
    from seacrane.errors import FmuError, ParameterError, Problem, UnitError, nearest

    values: dict[str, Any] = {}
    problems: list[Problem] = []
    units = fmi.known_units(description)
    for text in texts:
        name, equals, value = text.partition("=")
        element = fmi.element_of(name.strip(), description.by_name)
        variable = replace(element[0], dimensions=()) if element else description.by_name.get(name.strip())
        if not equals:
            problems.append(Problem("--set", "is not NAME=VALUE", text))
        elif variable is None:
            problems.append(Problem(name, "no such variable", hint=nearest(name, description.by_name)))
        else:
            try:
                values[name.strip()] = fmi.parse(variable, value, fmi.unit_symbol(variable, units))
            except (FmuError, UnitError) as error:
                problems += error.problems
    if problems:
        raise ParameterError(problems)
    return values


def _unit(symbol: str | None) -> str:
    return "" if symbol in (None, "1") else symbol


def _short(value: object) -> str:
    text = f"{value:g}" if isinstance(value, float) else str(value)
    return text if len(text) <= 24 else f"{text[:21]}..."


def _print_table(head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> None:
    widths = [max(len(row[i]) for row in (head, *rows)) for i in range(len(head))]
    for row in (head, tuple("-" * width for width in widths), *rows):
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
