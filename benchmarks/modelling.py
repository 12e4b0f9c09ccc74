"""What the solver costs beside others: CPU time over simulated time, and the slowest of a thousand steps.

Cases, all with the drive of examples/dissertation/cylinder.py at its extended level, following sines:

- cylinder: one drive, 12 states;
- hydraulics: five drives on one pump line, 61 states, the size of a whole crane's hydraulics.

`called every 10 ms` is by the co-simulation master: each step ends at a communication point. `one call` lets the
solver choose its steps over the whole time. Of both the shortest of ten runs is told. The tolerance is 1.5e-4 for our
solver, at which the displacement is within about 0.005 mm of the solution, and 1e-6 for the others. Column `error` is
rms every 10 ms; for one call it is that of another run, with outputs. p999 is of CPU time as well, so that what else
the machine does is not in it; 2 us of it are for Python and the clock. The model is compiled before the clock starts;
for the large one that time is reported, first without the C compiler.

    python benchmarks/modelling.py [--json FILE] [--until SECONDS]
"""

from __future__ import annotations

import argparse
import ctypes
import json
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "examples" / "dissertation"))

from cylinder import Drive, Sine, controlled  # lies beside the examples

from seacrane.cosim import Execution, GaussSeidel, ModelSlave, System
from seacrane.library import hydraulics as hyd
from seacrane.model import BDF, LSODA, RODAS4, Adams, Dae, Diagram, NativeModel, RungeKutta4, build, simulate
from seacrane.model.codegen import generate
from seacrane.model.solvers import Solver
from seacrane.results import Recording, Signal
from seacrane.units import l, mm

MACRO_STEP = 0.01
TOLERANCE = 1.5e-4
OTHERS_TOLERANCE = 1e-6
RUNS = 10
"""Of which the shortest is told: a run in one call takes a few milliseconds."""


def hydraulics(units: int = 5) -> Diagram:
    """Drives that follow sines of different periods, on one pump line."""
    d = Drive()
    crane = Diagram("hydraulics", bulk_modulus=1.0e9)
    pump = crane.add("pump", hyd.ConstantPressurePump(pressure=d.supply))
    throttle = crane.add("throttle", hyd.Orifice(diameter=40 * mm))
    line = crane.add("line", hyd.ControlVolume(volume=5 * l, pressure=d.supply))
    crane.connect(pump.p, throttle.a)
    drives = [
        crane.add(f"unit_{i}", controlled(d=d, sine=Sine(period=15.0 + i), own_pump=False)) for i in range(1, units + 1)
    ]
    crane.connect(throttle.b, line.a, *(drive.supply for drive in drives))
    return crane


def driven(dae: Dae, until: float, setting: dict[str, float]) -> float:
    """RTF of a run by the co-simulation master."""
    took = []
    for _ in range(RUNS):
        system = System()
        system.add("model", ModelSlave(dae, setting))
        with Execution(system, GaussSeidel(MACRO_STEP)) as execution:
            execution.start()
            begun = time.process_time()
            execution.run(until)
            took.append(time.process_time() - begun)
    return min(took) / until


def stepped(native: NativeModel, piston: str, until: float, setting: dict[str, float]) -> tuple[float, Recording]:
    """p99.9 [ms] of a step of 10 ms, by the very C function that a master calls, and the piston's motion."""
    step = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int)(
        native.calls.step
    )
    count = round(until / MACRO_STEP)
    took, x = np.empty(count), np.empty(count + 1)
    with native.instantiate() as instance:
        instance.set(list(setting), list(setting.values()))
        instance.initialize(0.0)
        x[0] = instance.get(piston)
        for k in range(count):
            begun = time.thread_time()
            status = step(instance.handle, k * MACRO_STEP, MACRO_STEP, 0)
            took[k] = time.thread_time() - begun
            if status != 0:
                raise RuntimeError(f"the step at {k * MACRO_STEP:g} s failed")
            x[k + 1] = instance.get(piston)
    motion = Recording(np.arange(count + 1) * MACRO_STEP, {piston: Signal("m", "m", x)})
    return 1e3 * float(np.quantile(took, 0.999)), motion


def rows_of(case: str, native: NativeModel, piston: str, until: float, rk4_step: float) -> list[dict[str, Any]]:
    """All solvers on one model."""
    reference = simulate(native, until, every=MACRO_STEP, record=[piston], tolerance=1e-10, progress=False)
    rows = []

    def add(solver: str, rtf: float, p999: float | None, run: Recording) -> None:
        error = run.rmse(reference, piston)
        rows.append({"case": case, "solver": solver, "rtf": rtf, "p999_step_ms": p999, "error_m": error})

    for label, setting in (
        ("RODAS4, called every 10 ms", {"solver.tolerance": TOLERANCE}),
        ("implicit Euler, called every 10 ms", {"solver.fixed_step": MACRO_STEP}),
    ):
        add(label, driven(native.dae, until, setting), *stepped(native, piston, until, setting))
    whole: list[tuple[str, Solver, float, float]] = [
        ("RODAS4, one call", RODAS4(), TOLERANCE, until),
        ("RODAS4, output every 10 ms", RODAS4(), TOLERANCE, MACRO_STEP),
        ("BDF (SUNDIALS), one call", BDF(), OTHERS_TOLERANCE, until),
        ("BDF (SUNDIALS), output every 10 ms", BDF(), OTHERS_TOLERANCE, MACRO_STEP),
        ("Adams (SUNDIALS), output every 10 ms", Adams(), OTHERS_TOLERANCE, MACRO_STEP),
        ("LSODA (scipy), output every 10 ms", LSODA(), OTHERS_TOLERANCE, MACRO_STEP),
        (f"Runge-Kutta 4, {rk4_step:g} s", RungeKutta4(rk4_step), OTHERS_TOLERANCE, MACRO_STEP),
    ]
    for label, solver, tolerance, every in whole:
        settings: dict[str, Any] = {"record": [piston], "solver": solver, "tolerance": tolerance, "progress": False}
        runs = [simulate(native, until, every=every, **settings) for _ in range(RUNS if every == until else 1)]
        looked = runs[0] if every == MACRO_STEP else simulate(native, until, every=MACRO_STEP, **settings)
        add(label, min(r.statistics.real_time_factor for r in runs if r.statistics), None, looked)
    return rows


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", type=Path, help="file for the rows")
    parser.add_argument("--until", type=float, default=60.0, help="simulated time [s]")
    options = parser.parse_args(arguments)
    one, five = controlled(), hydraulics()
    begun = time.process_time()
    dae = five.compile()
    generate(dae)
    compiling = time.process_time() - begun
    rows = rows_of("cylinder", build(one.compile()), "cylinder.extension", options.until, 2e-5)
    rows += rows_of("hydraulics", build(dae), "unit_1.cylinder.extension", options.until, 2e-5)
    print(f"hydraulics: {len(dae.states)} states, {len(dae.algebraics)} algebraic unknowns, ", end="")
    print(f"equations and C code in {compiling:.2f} s of CPU time")
    print(f"{'case':<12} {'solver':<38} {'RTF':>9} {'p99.9 [ms]':>11} {'error [mm]':>11}")
    for r in rows:
        p999 = "" if r["p999_step_ms"] is None else f"{r['p999_step_ms']:.3f}"
        print(f"{r['case']:<12} {r['solver']:<38} {r['rtf']:>9.2g} {p999:>11} {1e3 * r['error_m']:>11.2g}")
    if options.json:
        found = {"rows": rows, "states": len(dae.states), "compile_s": compiling, "until_s": options.until}
        options.json.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
