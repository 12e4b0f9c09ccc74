"""What load charts cost: CPU time of the curve of each shipped design in each mode, at the default resolution, and how
many candidates a search for better designs judges in a second of CPU.

Beside a curve, how many times as long a plain loop takes in the same run: `chart.each_limit`, the same law for one
posture, over some postures and scaled to the number of the curve. Quiet figures need a quiet machine.

    python benchmarks/chart.py [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

from seacrane import design, studies
from seacrane.design import Crane, chart, planar
from seacrane.design.chart import Mode

ROUNDS, ONE_BY_ONE, POPULATION = 5, 40, 40


def milliseconds(work: Callable[[], object], rounds: int = ROUNDS) -> float:
    """CPU time of this process, the best of the rounds [ms]."""
    times = []
    for _ in range(rounds):
        begun = time.process_time()
        work()
        times.append(time.process_time() - begun)
    return 1e3 * min(times)


def one_by_one(crane: Crane, mode: Mode) -> float:
    """The time per posture of the same limits in a plain loop [ms]."""
    random = np.random.default_rng(1)
    limits = {joint.name: joint.limits or (0.0, 0.0) for joint in planar.plane_joints(crane)}
    postures = [{name: random.uniform(*ends) for name, ends in limits.items()} for _ in range(ONE_BY_ONE)]

    def loop() -> None:
        for posture in postures:
            chart.each_limit(crane, posture, mode)

    return milliseconds(loop, rounds=2) / ONE_BY_ONE


def search() -> float:
    """Candidates per second of three sizes of the 100 t crane, for reach, weight and a load at sea."""
    crane, generations = design.load("offshore-100t"), 4
    sizes = ("links[jib].length", "cylinders[boom_cylinder].bore", "cylinders[boom_cylinder].eye.x")
    goals = [{"kind": "reach"}, {"kind": "weight"}, {"kind": "capacity", "radius": 20, "mode": "hs2.0"}]
    wanted = studies.specification({"variables": [{"path": path} for path in sizes], "goals": goals}, crane)
    judged = POPULATION * (generations + 1)
    whole = milliseconds(lambda: [*studies.optimise(crane, *wanted, population=POPULATION, generations=generations)], 2)
    return 1e3 * judged / whole


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path, metavar="FILE")
    options = parser.parse_args()
    rows = []
    print(f"{'design':<20} {'mode':<8} {'postures':>8} {'curve':>9} {'loop':>9}")
    for name in design.names():
        crane = design.load(name)
        joints = len(planar.plane_joints(crane))
        count = chart.COUNTS[joints] ** joints
        for mode in chart.modes(crane):
            whole, single = milliseconds(lambda c=crane, m=mode: chart.curve(c, m)), one_by_one(crane, mode)
            ratio = single * count / whole
            rows.append(
                {"design": name, "mode": mode.name, "postures": count, "curve_ms": whole, "loop_over_curve": ratio}
            )
            print(f"{name:<20} {mode.name:<8} {count:>8} {whole:>6.1f} ms {ratio:>6.0f} x")
    judged = search()
    print(f"a search judges {judged:.0f} candidates per second")
    if options.json:
        result = {"curves": rows, "candidates_per_s": judged}
        options.json.write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
