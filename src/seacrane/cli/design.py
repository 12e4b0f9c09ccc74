"""`seacrane design show`, `check`, `chart`, `optimise` and `export`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from seacrane import documents
from seacrane.errors import DesignError, ParameterError

from .arguments import Commands, output, picture, save_figure, verdict

if TYPE_CHECKING:
    from seacrane.design import Crane
    from seacrane.design.chart import Mode
    from seacrane.results import Figure
    from seacrane.studies import Front


def add(commands: Commands) -> None:
    """Declare the command."""
    design = commands.add_parser("design", help="look at a design").add_subparsers(required=True, metavar="ACTION")
    show = design.add_parser("show", help="print what a crane is and how far it reaches")
    show.set_defaults(run=_show)
    check = design.add_parser("check", help="list all that is wrong with a design")
    check.set_defaults(run=_check)
    chart = design.add_parser("chart", help="print the load chart: load over radius, and what governs")
    chart.add_argument("--mode", metavar="NAME", help="harbour, or a wave height such as hs2.0; all unless given")
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
    optimise.add_argument("--population", type=int, default=40, help="candidates of a generation (default 40)")
    optimise.add_argument("--seed", type=int, default=1, help="another seed searches elsewhere (default 1)")
    optimise.set_defaults(run=_optimise)
    for action in (show, check, chart, export, optimise):
        action.add_argument("design", help="a design that comes with the package, a design file, or an exported ZIP")


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
    try:
        load(options.design)
    except DesignError as error:
        return verdict(options.design, error.problems)
    return verdict(options.design, ())


def _chart(options: argparse.Namespace) -> int:
    from seacrane.design import chart
    from seacrane.results import charts

    crane = load(options.design)
    modes = chart.modes(crane) if options.mode is None else (chart.mode(crane, options.mode),)
    curves = {mode.name: chart.curve(crane, mode) for mode in modes}
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
        for mode in modes[1:]:
            need = chart.hook_speed_needed(crane, mode)
            have = crane.hoist.speed / crane.hoist.falls
            if have < need:
                print(f"{mode.name}: the hook at {have:.2f} m/s is slower than the {need:.2f} m/s of EN 13852-1")
        print(charts.NOT_CERTIFIED)
    return 0


def _draw_section(crane: Crane, mode: Mode, path: Path) -> None:
    from seacrane.design import planar, sheet, workspace
    from seacrane.results import charts

    where = workspace.section(crane, 400 if len(planar.plane_joints(crane)) == 2 else 160)
    best = workspace.loads(crane, where, mode)
    view = sheet.side_view(crane, sheet.half_way(crane))
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
        _goes_on(state, crane, (variables, goals), options.front)
    search = studies.optimise(
        crane,
        variables,
        goals,
        population=options.population,
        generations=options.generations,
        seed=options.seed,
        state=state,
    )
    for front in search:
        studies.save(front, options.front)
        print(f"\rgeneration {front.generation} of {options.generations}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    names = [*(variable.path for variable in front.variables), *(goal.name for goal in front.wanted)]
    print("  ".join(names))
    for values, results in zip(front.values[front.best], front.goals[front.best], strict=True):
        sizes = [f"{size:.4g} m" for size in values]
        shown = [
            f"{result:.4g} m" if goal.kind == "reach" else f"{result / 1e3:.4g} t"
            for goal, result in zip(front.wanted, results, strict=True)
        ]
        print("  ".join([*sizes, *shown]))
    print(f"{options.front}: {int(front.best.sum())} designs that none beats in every goal")
    return 0


def _goes_on(state: Front, crane: Crane, wanted: tuple[object, object], path: Path) -> None:
    """Refuse to go on from the front of another search as if it were the one asked for."""
    hint = "Name another file for another search."
    if state.crane != crane:
        raise ParameterError.at(
            str(path), "is the front of another design", value=state.crane.name, allowed=crane.name, hint=hint
        )
    if wanted != ((), ()) and wanted != (state.variables, state.wanted):
        raise ParameterError.at(
            str(path), "is the front of a search for other sizes or goals than --spec has", hint=hint
        )


def _export(options: argparse.Namespace) -> int:
    from seacrane.design import archive

    crane = load(options.design)
    path = options.out or output(f"{crane.name}.zip")
    archive.export(crane, path)
    print(f"{path}: {crane.name}, design SHA-256 {archive.provenance(crane)}")
    return 0
