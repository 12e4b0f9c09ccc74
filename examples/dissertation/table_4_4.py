"""Table 4.4 and Figure 4.11 of the dissertation: one cylinder drive, its two levels, solved in several ways.

    python examples/dissertation/table_4_4.py --json table_4_4.json --out figures

The drive (cylinder.py) follows a sine for one minute. RMSE is of the piston displacement against that sine; RTF is CPU
time over simulated time. Euler's method and Runge-Kutta need steps that resolve the fastest rate of the drive: the
script measures how long a step may be before the method diverges, and gives them half of that. The convergence table
shows that all solvers come to one solution: RMSE of the displacement against Radau IIA at 1e-11.
"""

from __future__ import annotations

import argparse
import json
import platform
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from cylinder import Sine, controlled

from seacrane.errors import SolveError
from seacrane.model import (
    BDF,
    RODAS4,
    Adams,
    Comparison,
    ExplicitEuler,
    NativeModel,
    Radau,
    RungeKutta4,
    build,
    compare,
    simulate,
)
from seacrane.model.solvers import Solver
from seacrane.results import Recording

PRINTED = {
    ("Runge-Kutta 4", "simplified"): (0.73, 2.38e-3),
    ("Runge-Kutta 4", "extended"): (2.36, 3.30e-3),
    ("Adams (SUNDIALS)", "simplified"): (0.0003, 2.73e-3),
    ("Adams (SUNDIALS)", "extended"): (0.067, 3.8e-3),
}
"""RTF and RMSE [m] in the dissertation."""

ELSEWHERE = (
    "The printed RTFs were measured on other hardware: a ratio compares machines and programs as well as methods."
)

LEVELS = ("simplified", "extended")
PISTON, WANTED = "cylinder.extension", "displacement.y"
PRESSURE = "line_b.pressure"


def diverges(drive: NativeModel, solver: Solver, reference: Recording, until: float) -> bool:
    """Whether the run ends early, or a pressure is more than 1 bar (rms) off."""
    try:
        run = simulate(drive, until, record=[PRESSURE], solver=solver)
    except SolveError:
        return True
    return bool(np.abs(run[PRESSURE]).max() > 1e9 or run.rmse(reference, PRESSURE) > 1e5)


def limit_of(drive: NativeModel, method: type[ExplicitEuler | RungeKutta4], until: float) -> float:
    """The step [s] at which an explicit method diverges, to 3 %."""
    reference = simulate(drive, until, record=[PRESSURE], tolerance=1e-9)
    stable, unstable = 1e-6, 1e-2
    while unstable / stable > 1.03:
        middle = float(np.sqrt(stable * unstable))
        if diverges(drive, method(step=middle), reference, until):
            unstable = middle
        else:
            stable = middle
    return unstable


def machine() -> dict[str, str]:
    """What it ran on."""
    cpu = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line.partition(":")[2].strip() for line in info.read_text().splitlines() if "model name" in line]
        cpu = names[0] if names else cpu
    return {"cpu": cpu, "system": platform.platform(), "python": f"Python {platform.python_version()}"}


def table(
    drives: Mapping[str, NativeModel], limits: Mapping[str, Mapping[str, float]], until: float
) -> dict[str, Comparison]:
    """By level, the drive solved by every solver."""
    found = {}
    for level, drive in drives.items():
        solvers = (
            RungeKutta4(step=limits[level]["Runge-Kutta 4"] / 2),
            ExplicitEuler(step=limits[level]["explicit Euler"] / 2),
            Adams(),
            BDF(),
            RODAS4(),
        )
        found[level] = compare({level: drive}, until, PISTON, solvers=solvers, reference=WANTED, tolerance=1e-5)
    return found


def rows(comparisons: Mapping[str, Comparison]) -> list[dict[str, Any]]:
    """Solver, level, RTF and RMSE [m] of each run, with the printed ones where there are any."""
    result = []
    for level, comparison in comparisons.items():
        for row in comparison.rows:
            solver, _, step = row.solver.partition(", ")
            printed = PRINTED.get((solver, level), (None, None))
            result.append(
                {
                    "solver": solver,
                    "level": level,
                    "rtf": row.real_time_factor,
                    "rmse_m": None if row.failure else row.rmse,
                    "step_s": float(step.split()[0]) if step else None,
                    "rtf_printed": printed[0],
                    "rmse_m_printed": printed[1],
                    "failure": row.failure,
                }
            )
    return result


def convergence(drive: NativeModel, until: float) -> dict[str, dict[str, float]]:
    """RMSE [m] of the displacement against Radau at 1e-11, by solver and tolerance (or step)."""
    reference = simulate(drive, until, record=[PISTON], solver=Radau(), tolerance=1e-11)
    found: dict[str, dict[str, float]] = {}
    for solver in (RODAS4(), BDF(), Adams()):
        found[solver.name] = {
            f"{tolerance:g}": simulate(drive, until, record=[PISTON], solver=solver, tolerance=tolerance).rmse(
                reference, PISTON
            )
            for tolerance in (1e-4, 1e-6, 1e-8, 1e-10)
        }
    found["Runge-Kutta 4"] = {
        f"{step:g} s": simulate(drive, until, record=[PISTON], solver=RungeKutta4(step)).rmse(reference, PISTON)
        for step in (8e-6, 4e-6, 2e-6)
    }
    return found


def show(lines: list[dict[str, Any]]) -> str:
    """The table as text; beside the printed figures, how many times faster ours is."""
    head = f"{'solver':<18} {'level':<11} {'RTF':>9} {'RMSE [m]':>10}"
    text = [f"{head} {'RTF printed':>12} {'ratio':>8} {'RMSE printed':>13}"]
    for r in lines:
        error = "diverged" if r["rmse_m"] is None else f"{r['rmse_m']:.2e}"
        line = f"{r['solver']:<18} {r['level']:<11} {r['rtf']:>9.2g} {error:>10}"
        if r["rtf_printed"]:
            line += f" {r['rtf_printed']:>12g} {r['rtf_printed'] / r['rtf']:>8.1f} {r['rmse_m_printed']:>13g}"
        text.append(f"{line}  {r['failure']}".rstrip())
    return "\n".join(text)


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="file for the rows of the table")
    parser.add_argument("--out", type=Path, help="folder for Figure 4.11 (SVG) and its data (CSV)")
    parser.add_argument("--until", type=float, default=60.0, help="simulated time [s]")
    options = parser.parse_args(arguments)
    drives = {level: build(controlled(level).compile()) for level in LEVELS}
    limits = {
        level: {
            method.name: limit_of(drive, method, min(options.until, Sine().period))
            for method in (RungeKutta4, ExplicitEuler)
        }
        for level, drive in drives.items()
    }
    comparisons = table(drives, limits, options.until)
    lines = rows(comparisons)
    here = machine()
    print(f"Table 4.4, {options.until:g} s of a sine of {Sine().amplitude:g} m every {Sine().period:g} s")
    print(", ".join(here.values()))
    print(show(lines))
    print(ELSEWHERE)
    for level, found in limits.items():
        print(f"{level}: " + ", ".join(f"{name} diverges at a step of {step:.2g} s" for name, step in found.items()))
    converged = convergence(drives["extended"], min(options.until, 5.0))
    print("convergence of the extended drive: RMSE [m] of the displacement against Radau at 1e-11")
    for name, errors in converged.items():
        print(f"  {name:<18} " + "  ".join(f"{key}: {error:.1e}" for key, error in errors.items()))
    if options.json:
        result = {"rows": lines, "limits_s": limits, "convergence_m": converged, "machine": here, "printed": ELSEWHERE}
        options.json.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
        for level, comparison in comparisons.items():
            comparison.plot().savefig(options.out / f"figure_4_11_{level}.svg")
            run = comparison.runs[level, "RODAS4"]
            run.to_csv(options.out / f"figure_4_11_{level}.csv")


if __name__ == "__main__":
    main()
