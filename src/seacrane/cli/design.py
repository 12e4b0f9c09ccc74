"""`seacrane design show`, `check`, `chart`, `optimise` and `export`."""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from seacrane import documents
from seacrane.errors import DesignError, ParameterError
from seacrane.units import t

from .arguments import Commands, output, picture, save_figure, verdict

if TYPE_CHECKING:
    from collections.abc import Sequence

    from seacrane.design import Crane
    from seacrane.design.chart import Mode
    from seacrane.results import Figure
    from seacrane.studies import Front


def add(commands: Commands) -> None:
    """Declare the command."""
    design = commands.add_parser("design", help="look at a design").add_subparsers(required=True, metavar="ACTION")
    show = design.add_parser("show", help="print what a crane is and how far it reaches")
    show.set_defaults(run=_show)
    check = design.add_parser("check", help="list all that is wrong with a design, and what makes it hard to build")
    check.set_defaults(run=_check)
    chart = design.add_parser("chart", help="print the load chart: load over radius, and what governs")
    chart.add_argument("--mode", metavar="NAME", help="harbour, or a wave height such as hs2.0; all unless given")
    chart.add_argument("--radii", type=_radii, metavar="M,M", help="at these radii [m], instead of each whole metre")
    chart.add_argument("--csv", type=output, metavar="OUT", help="write mode, radius_m, swl_t, governs")
    chart.add_argument("--plot", type=picture, metavar="OUT", help="draw the curves (SVG, PNG or PDF)")
    chart.add_argument("--section", type=picture, metavar="OUT", help="draw the load over the workspace of the mode")
    chart.set_defaults(run=_chart)
    export = design.add_parser("export", help="write a ZIP: design, meshes, masses, load chart, MJCF, URDF, data sheet")
    export.add_argument("--out", type=output, metavar="FILE", help="NAME.zip in this folder unless given")
    export.set_defaults(run=_export)
    optimise = design.add_parser(
        "optimise", help="search sizes for reach, capacity and weight; the front goes to a file"
    )
    optimise.add_argument("--spec", metavar="FILE", help='JSON: {"variables": [{"path"}], "goals": [{"kind"}]}')
    optimise.add_argument("--front", type=output, required=True, metavar="FILE", help="the front; an old one goes on")
    optimise.add_argument("--generations", type=int, default=50, help="generations in all (default 50)")
    optimise.add_argument("--population", type=int, help="candidates of a generation (default 40)")
    optimise.add_argument("--seed", type=int, help="another seed searches elsewhere (default 1)")
    optimise.add_argument("--designs", metavar="FOLDER", type=Path, help="write each design of the front as a file")
    optimise.set_defaults(run=_optimise)
    for action in (show, check, chart, export, optimise):
        action.add_argument("design", help="a design that comes with the package, a design file, or an exported ZIP")


def _radii(text: str) -> list[float]:
    try:
        radii = sorted({float(item) for item in text.split(",")})
    except ValueError:
        radii = []
    if not radii or not all(0 < radius < math.inf for radius in radii):
        raise argparse.ArgumentTypeError(f"{text!r} are no radii; give numbers in m above 0, such as 4,20.3")
    return radii


def load(source: str) -> Crane:
    """The crane of a shipped name, a JSON file or an exported ZIP."""
    from seacrane import design

    return design.archive.load_archive(source) if source.endswith(".zip") else design.load(source)


def _show(options: argparse.Namespace) -> int:
    from seacrane.design import sheet

    crane = load(options.design)
    facts = sheet.facts(crane)
    width = max(len(name) for name, _ in facts)
    print(f"{crane.name}\n{crane.about}\n")
    for name, value in facts:
        print(f"  {name:<{width}}  {value}")
    for source in crane.sources:
        print(f"\n  {source.of} ({source.kind}): {source.note}")
    return 0


def _check(options: argparse.Namespace) -> int:
    from seacrane import studies

    try:
        crane = load(options.design)
    except DesignError as error:
        return verdict(options.design, error.problems)
    for words in studies.why_not(crane):
        print(f"hard to build: {words}")
    return verdict(options.design, ())


def _chart(options: argparse.Namespace) -> int:
    from seacrane.design import chart
    from seacrane.results import charts

    crane = load(options.design)
    modes = chart.modes(crane) if options.mode is None else (chart.mode(crane, options.mode),)
    curves = {mode.name: chart.curve(crane, mode, radii=options.radii) for mode in modes}
    rows = [row for curve in curves.values() for row in curve]
    if options.csv:
        documents.write(chart.to_csv(rows), options.csv)
        print(f"{options.csv}: {len(rows)} rows")
    if options.plot:
        lines = {name: ([row.radius for row in curve], [row.swl for row in curve]) for name, curve in curves.items()}
        _save(charts.load_curves(lines, crane.name), options.plot)
    if options.section:
        _draw_section(crane, modes[0], options.section)
    if not (options.csv or options.plot or options.section):
        print(f"{'mode':<8} {'radius':>8} {'load':>8}  governs")
        for row in rows:
            print(f"{row.mode:<8} {row.radius:>6.1f} m {row.swl / 1e3:>6.1f} t  {row.governs}")
        print()
        for condition in chart.conditions(crane):
            print(f"* {condition}")
        print(charts.NOT_CERTIFIED)
    return 0


def _draw_section(crane: Crane, mode: Mode, path: Path) -> None:
    from seacrane.design import planar, sheet, workspace
    from seacrane.results import charts

    where = workspace.section(crane, 400 if len(planar.plane_joints(crane)) == 2 else 160)
    best = workspace.loads(crane, where, mode)
    view = sheet.side_view(crane, sheet.at_work(crane))
    title = f"{crane.name}, {mode.name}: load of the best posture"
    _save(charts.load_section(where.radius, where.height, best, view, title), path)


def _save(figure: Figure, path: Path) -> None:
    save_figure(figure, path)
    print(f"{path}: drawn")


def _optimise(options: argparse.Namespace) -> int:
    from seacrane import studies

    crane = load(options.design)
    state = studies.read(options.front) if options.front.exists() else None
    variables: tuple[studies.Variable, ...] = ()
    goals: tuple[studies.Goal, ...] = ()
    if options.spec is not None:
        data = documents.parsed(documents.read(options.spec, ParameterError), options.spec, ParameterError)
        variables, goals = studies.specification(data, crane)
    elif state is None:
        raise ParameterError.at("--spec", "is needed to begin a search", hint="See docs: optimisation of a design.")
    if state is not None:
        _goes_on(state, crane, (variables, goals), options)
    search = studies.optimise(
        crane,
        variables,
        goals,
        population=40 if options.population is None else options.population,
        generations=options.generations,
        seed=1 if options.seed is None else options.seed,
        state=state,
    )
    try:
        for front in search:
            studies.save(front, options.front)
            print(f"\rgeneration {front.generation} of {options.generations}", end="", file=sys.stderr, flush=True)
    except KeyboardInterrupt:
        print(f"\n{options.front} has what was found; the same command goes on from there", file=sys.stderr)
        raise
    print(file=sys.stderr)
    return _front(front, options.front, options.designs)


def _goes_on(state: Front, crane: Crane, wanted: tuple[object, object], options: argparse.Namespace) -> None:
    """Refuse to go on from the front of another search as if it were the one asked for."""
    path, hint = str(options.front), "Name another file for another search."
    if state.crane != crane:
        raise ParameterError.at(
            path, "is the front of another design", value=state.crane.name, allowed=crane.name, hint=hint
        )
    if wanted != ((), ()) and wanted != (state.variables, state.wanted):
        raise ParameterError.at(path, "is the front of a search for other sizes or goals than --spec has", hint=hint)
    for name, asked, has in (
        ("population", options.population, len(state.values)),
        ("seed", options.seed, state.seed),
    ):
        if asked not in (None, has):
            raise ParameterError.at(path, f"is the front of a search with another {name}", value=has, hint=hint)
    if options.generations < state.generation:
        raise ParameterError.at(
            "--generations", "has been passed by the front", value=options.generations, allowed=f"{state.generation} on"
        )


def _front(front: Front, path: Path, folder: Path | None) -> int:
    """Print the designs of a front under the one that the search began with, and write them where asked."""
    from seacrane import design, studies
    from seacrane.design import changes

    if not front.best.any():
        print(f"{path}: none of the {len(front.values)} candidates can be built. The one that misses least:")
        print("\n".join(f"  {words}" for words in studies.why_not(front.design(front.nearest))))
        return 1
    now = [changes.value(front.crane, variable.path) for variable in front.variables]
    best = [index for index, good in enumerate(front.best) if good]
    order = sorted(best, key=lambda index: tuple(front.goals[index]))
    rows = [["start", *_shown(front, now, studies.judged(front.crane, front.wanted))]]
    rows += [[str(n), *_shown(front, front.values[i], front.goals[i])] for n, i in enumerate(order, start=1)]
    heads = ["design", *(f"{v.path} [m]" for v in front.variables)]
    heads += [f"{goal.name} [{'m' if goal.kind == 'reach' else 't'}]" for goal in front.wanted]
    for row in [heads, *rows]:
        print("  ".join(cell.rjust(len(head)) for cell, head in zip(row, heads, strict=True)))
    print(f"{path}: {len(order)} designs that none beats in every goal")
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        for number, index in enumerate(order, start=1):
            design.save(front.design(index), folder / f"{number}.json")
        print(f"{folder}: 1.json to {len(order)}.json")
    return 0


def _shown(front: Front, values: Sequence[float], results: Sequence[float]) -> list[str]:
    sizes = [f"{size:.3f}" for size in values]
    return sizes + [
        f"{result if goal.kind == 'reach' else result / t:.2f}"
        for goal, result in zip(front.wanted, results, strict=True)
    ]


def _export(options: argparse.Namespace) -> int:
    from seacrane.design import archive

    crane = load(options.design)
    path = options.out or output(f"{archive.file_names([crane.name])[crane.name]}.zip")
    archive.export(crane, path)
    print(f"{path}: {crane.name}, design SHA-256 {archive.provenance(crane)}")
    return 0
