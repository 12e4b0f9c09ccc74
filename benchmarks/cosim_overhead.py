"""What the master costs: microseconds per slave and macro step, C loop and Python loop side by side.

Ten compiled models in a chain, each with 4 inputs, 4 outputs and 2 states, stepped by a single linearly implicit Euler
step per macro step of 1 ms, so that little but the exchange is left. The rounds of all variants are interleaved, so
that a busy machine slows all of them; the median over the rounds counts. `alone` is one such model run by its own C
loop without any master: what lies above it is the master's.

    python benchmarks/cosim_overhead.py [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from seacrane.cosim import Execution, Jacobi, ModelSlave, System
from seacrane.model.dae import Dae, Variable

STEP = 1e-3
SLAVES = 10
PORTS = 4


def link() -> Dae:
    """x1' = u1 - x1, x2' = x1 - x2; the outputs are the states and their sums with the other inputs."""
    x, u, none = ca.SX.sym("x", 2), ca.SX.sym("u", PORTS), ca.SX(0, 1)
    return Dae(
        "link",
        (Variable("x1"), Variable("x2")),
        (),
        tuple(Variable(f"u{i}") for i in range(PORTS)),
        (),
        tuple(Variable(f"y{i}") for i in range(PORTS)),
        (),
        t=ca.SX.sym("t"),
        x=x,
        z=none,
        u=u,
        p=none,
        ode=ca.vertcat(u[0] - x[0], x[0] - x[1]),
        alg=none,
        out=ca.vertcat(x[1], x[0] + u[1], x[1] + u[2], x[0] + x[1] + u[3]),
        obs=none,
    )


def chain(slaves: int = SLAVES, substeps: int = 1) -> System:
    slave = ModelSlave(link(), {"solver.fixed_step": STEP / substeps, "u0": 1.0})
    system = System("chain", {f"s{i}": slave for i in range(slaves)})
    for i in range(1, slaves):
        for j in range(PORTS):
            system.connect(f"s{i - 1}.y{j}", f"s{i}.u{j}")
    return system


def coupled(
    loop: str, steps: int, record: bool = False, system: System | None = None, threads: int = 1, **how: Any
) -> tuple[Callable[[], None], Execution]:
    run = Execution(system or chain(), Jacobi(STEP, **how), loop=loop, threads=threads).start()  # type: ignore[arg-type]
    if record:
        run.record(keep=1.0)
    return lambda: run.step(steps), run


def alone(steps: int) -> Callable[[], None]:
    slave = ModelSlave(link(), {"solver.fixed_step": STEP, "u0": 1.0})
    instance = slave.native.instantiate()
    instance.set(list(slave.parameters), list(slave.parameters.values()))
    instance.initialize(0.0)
    outputs = [v.name for v in slave.interface.outputs]

    def run() -> None:
        instance.simulate(instance.time + STEP * np.arange(1, steps + 1), outputs)

    return run


def measure(rounds: int, steps: int) -> dict[str, float]:
    """Median microseconds per slave and macro step for each variant."""
    slow, few = max(1, steps // 20), max(1, steps // 100)
    cores = os.cpu_count() or 1
    c, c_run = coupled("c", steps, record=False)
    recorded, _ = coupled("c", steps, record=True)
    linear, _ = coupled("c", steps, extrapolation="linear")
    thousand, _ = coupled("c", few, system=chain(1000))
    expensive = [coupled("c", few, system=chain(SLAVES, substeps=500), threads=n)[0] for n in (1, cores)]
    python, python_run = coupled("python", slow, record=False)
    variants = {
        "alone": (alone(steps), steps),
        "c": (c, steps * SLAVES),
        "c, recorded": (recorded, steps * SLAVES),
        "c, linear": (linear, steps * SLAVES),
        "c, 1000": (thousand, few * 1000),
        "50 us": (expensive[0], few * SLAVES),
        "50 us, threads": (expensive[1], few * SLAVES),
        "python": (python, slow * SLAVES),
    }
    times: dict[str, list[float]] = {name: [] for name in variants}
    for turn in range(rounds + 1):
        for name, (work, count) in variants.items():
            begin = time.perf_counter()
            work()
            if turn:
                times[name].append((time.perf_counter() - begin) / count * 1e6)
    for run in (c_run, python_run):
        run.close()
    return {name: statistics.median(values) for name, values in times.items()}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--steps", type=int, default=20_000, help="macro steps of the C loop in a round")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    arguments = parser.parse_args()
    figures = measure(arguments.rounds, arguments.steps)
    print("us per slave and macro step (slave included):")
    for name, value in figures.items():
        print(f"  {name:14} {value:7.3f}")
    overhead = figures["c"] - figures["alone"]
    recording = figures["c, recorded"] - figures["c"]
    ratio = figures["python"] / figures["c"]
    print(f"master in C above the slave itself: {overhead:.3f}; recording all outputs to memory: {recording:.3f}")
    print(
        f"python loop / C loop: {ratio:.1f}; threads: {figures['50 us'] / figures['50 us, threads']:.2f} times as fast"
    )
    if arguments.json:
        arguments.json.write_text(
            json.dumps({"us": figures, "overhead_us": overhead, "recording_us": recording, "ratio": ratio}, indent=2)
            + "\n"
        )


if __name__ == "__main__":
    main()
