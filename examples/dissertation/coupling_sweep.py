"""Macro step times algorithm, on the drive and the boom of Table 4.5: error, cost, and where coupling is lost.

    python examples/dissertation/coupling_sweep.py --json coupling_sweep.json --out figures

The two units (boom.py) integrate to 1e-6, so that what is left is the error of their coupling: RMSE of the piston
against the same model in one piece. RTF is CPU time over simulated time. `seacrane.cosim.diagnose` says the same of any
system; this script is the figure that the dissertation asks for in its future work.
"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from boom import Boom, compiled
from split_drive import LOST, reference, run
from table_4_4 import machine

from seacrane.cosim import Adaptive, Algorithm, FixedPoint, GaussSeidel, Iterative, Jacobi, Newton, PowerResidual
from seacrane.results import sweeps

STEPS = (1e-4, 2e-4, 5e-4, 1e-3, 2e-3, 5e-3, 1e-2, 2e-2)
ALGORITHMS: dict[str, Callable[[float], Algorithm]] = {
    "Jacobi": Jacobi,
    "Jacobi, linear": lambda h: Jacobi(h, extrapolation="linear"),
    "Gauss-Seidel": GaussSeidel,
    "Gauss-Seidel, linear": lambda h: GaussSeidel(h, extrapolation="linear"),
    "fixed point": lambda h: Iterative(GaussSeidel(h, extrapolation="linear"), FixedPoint()),
    "Newton": lambda h: Iterative(Jacobi(h, extrapolation="linear"), Newton()),
    "power residual": lambda h: Adaptive(GaussSeidel(h), PowerResidual(1e-3), smallest=min(h, 1e-4)),
}
WANTED_M = (0.5e-3, 0.01e-3)
"""Deviations [m] for which the cheapest way is told."""


def sweep(until: float, steps: Sequence[float], names: Sequence[str]) -> list[dict[str, Any]]:
    """A row for each algorithm and macro step."""
    boom = Boom()
    system, exact = compiled(boom), reference(boom, until)
    found = []
    for name in names:
        for step in steps:
            done = run(system, ALGORITHMS[name](step), exact)
            found.append(
                {
                    "algorithm": name,
                    "macro_step_s": step,
                    "rmse_m": done.rmse if math.isfinite(done.rmse) else None,
                    "cpu_s": done.cpu,
                    "rtf": done.cpu / until,
                    "stable": done.stable,
                    "failure": done.failure,
                }
            )
    return found


def show(rows: Sequence[dict[str, Any]]) -> str:
    """RMSE by algorithm and step, and the cost below it."""
    steps = sorted({r["macro_step_s"] for r in rows})
    text = [f"{'RMSE [mm] (RTF)':<22}" + "".join(f"{f'{1e3 * h:g} ms':>11}" for h in steps)]
    for name in dict.fromkeys(r["algorithm"] for r in rows):
        own = {r["macro_step_s"]: r for r in rows if r["algorithm"] == name}
        text.append(f"{name:<22}" + "".join(f"{_millimetres(own[h]):>11}" for h in steps))
        text.append(" " * 22 + "".join(f"{_cost(own[h]):>11}" for h in steps))
    return "\n".join(text)


def _millimetres(row: dict[str, Any]) -> str:
    return f"{1e3 * row['rmse_m']:.2g}" if row["stable"] else "lost"


def _cost(row: dict[str, Any]) -> str:
    return f"({row['rtf']:.2g})" if row["stable"] else ""


def findings(rows: Sequence[dict[str, Any]]) -> list[str]:
    """Where each algorithm loses the solution, and the cheapest way to each deviation."""
    said = []
    for name in dict.fromkeys(r["algorithm"] for r in rows):
        lost = [r["macro_step_s"] for r in rows if r["algorithm"] == name and not r["stable"]]
        until = f"loses the solution at {1e3 * min(lost):g} ms" if lost else "keeps the solution at all steps"
        said.append(f"{name} {until}")
    for wanted in WANTED_M:
        good = [r for r in rows if r["stable"] and r["rmse_m"] <= wanted]
        for name in dict.fromkeys(r["algorithm"] for r in good):
            best = min((r for r in good if r["algorithm"] == name), key=lambda r: r["rtf"])
            said.append(
                f"within {1e3 * wanted:g} mm: {name} at {1e3 * best['macro_step_s']:g} ms, RTF {best['rtf']:.2g}"
            )
    factor = residual_factor(rows)
    if factor is not None:
        said.append(
            f"control by power residual has {factor:.2g} times the error of fixed Gauss-Seidel steps of equal cost here"
        )
    return said


def residual_factor(rows: Sequence[dict[str, Any]]) -> float | None:
    """Error of the controlled runs over that of fixed steps at the same cost, on straight lines between logarithms."""
    fixed = sorted((r["rtf"], r["rmse_m"]) for r in rows if r["algorithm"] == "Gauss-Seidel" and r["stable"])
    ratios = []
    for r in rows:
        if r["algorithm"] == "power residual" and r["stable"] and fixed and fixed[0][0] <= r["rtf"] <= fixed[-1][0]:
            costs, errors = np.log(np.array(fixed)).T
            ratios.append(r["rmse_m"] / math.exp(float(np.interp(math.log(r["rtf"]), costs, errors))))
    return float(np.median(ratios)) if ratios else None


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="file for the rows")
    parser.add_argument("--out", type=Path, help="folder for the figure (SVG)")
    parser.add_argument("--until", type=float, default=15.0, help="simulated time [s]")
    parser.add_argument(
        "--steps", type=lambda t: [float(x) for x in t.split(",")], default=STEPS, help="macro steps [s]"
    )
    options = parser.parse_args(arguments)
    rows = sweep(options.until, options.steps, list(ALGORITHMS))
    here = machine()
    print(f"cylinder drive and boom, {options.until:g} s; {', '.join(here.values())}")
    print(f"lost: more than {1e3 * LOST:g} mm off")
    print(show(rows))
    print("\n".join(findings(rows)))
    if options.json:
        options.json.write_text(json.dumps({"rows": rows, "machine": here}, indent=1) + "\n", encoding="utf-8")
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
        runs = {
            name: [
                (r["macro_step_s"], r["rtf"], 1e3 * r["rmse_m"] if r["stable"] else None)
                for r in rows
                if r["algorithm"] == name
            ]
            for name in ALGORITHMS
        }
        title = "cylinder drive and boom, split at the rod (crosses: lost)"
        figure = sweeps.error_and_cost(runs, "deviation of the piston, rms [mm]", tolerance=0.5, title=title)
        figure.savefig(options.out / "coupling_sweep.svg")


if __name__ == "__main__":
    main()
