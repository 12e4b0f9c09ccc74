"""What a co-simulation master costs: microseconds per FMU and macro step, ours and those of others side by side.

    pip install seacrane[peers]
    apt-get install libtbb12            # which ecospy's wheel needs and does not bring (Debian, Ubuntu)
    python benchmarks/cosim.py --json cosim.json

The FMU is compiled here (FMI 2.0, 4 inputs, 4 outputs, 2 states, one Euler step), so that little but the exchange is
left; ten of them in a chain are stepped at 1 ms by Jacobi's scheme, without logging and with their 40 outputs logged to
memory (ecospy: to a CSV file, it has no log in memory). Then longer chains; a winch drive and the crane that it hoists
on, exported from the reference crane, at 10 kHz; and slaves that cost 1, 50 and 200 us on one and on two threads.

Each engine runs in a process of its own, with all its threads counted. Figures are CPU time, but for the threads, where
it is the clock that counts; rounds of all engines are interleaved, and the least of the rounds is given. Peers that
are not installed are named and left out. On a busy machine threads show nothing but how busy it is, unless the whole
has precedence: `chrt -f 1 python benchmarks/cosim.py`.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import time
import zipfile
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

from cosim_peers import MISSING, PEERS, Case

from seacrane import design, fmi, plant
from seacrane.cosim import Execution, FmuSlave, Jacobi, System
from seacrane.native import compiler

INPUTS, OUTPUTS = [f"u{i}" for i in range(1, 5)], [f"y{i}" for i in range(1, 5)]

SOURCE = r"""
/* x1' = x2, x2' = -k x1 - d x2 + u1 + u2/10 + u3/100 + u4/1000; y = x1, x2, x1/2, x1 + x2. Value references: u 1 to 4,
   y 5 to 8, x 9 and 10, k 11, d 12, and 13 the number of Euler steps in a step, which says what the FMU costs. It
   starts at 1 and passes on what it gets, so that no number dies away into what processors are slow with. */
#include <stdlib.h>
#include <string.h>
#define COUNT 14
typedef struct { double v[COUNT]; } Oscillator;
static void outputs(double *v) { v[5] = v[9]; v[6] = v[10]; v[7] = v[9] / 2; v[8] = v[9] + v[10]; }
void *fmi2Instantiate(const char *n, int t, const char *g, const char *r, const void *f, int v, int l)
{
    Oscillator *o = calloc(1, sizeof *o);
    if (o) { o->v[9] = 1; o->v[11] = 1; o->v[12] = 2; o->v[13] = 1; }
    return o;
}
void fmi2FreeInstance(void *c) { free(c); }
int fmi2SetupExperiment(void *c, int a, double b, double t, int d, double e) { return 0; }
int fmi2EnterInitializationMode(void *c) { outputs(((Oscillator *)c)->v); return 0; }
int fmi2ExitInitializationMode(void *c) { outputs(((Oscillator *)c)->v); return 0; }
int fmi2GetReal(void *c, const unsigned r[], size_t n, double v[])
{
    for (size_t i = 0; i < n; i++) { if (r[i] >= COUNT) return 3; v[i] = ((Oscillator *)c)->v[r[i]]; }
    return 0;
}
int fmi2SetReal(void *c, const unsigned r[], size_t n, const double v[])
{
    for (size_t i = 0; i < n; i++) { if (r[i] >= COUNT) return 3; ((Oscillator *)c)->v[r[i]] = v[i]; }
    return 0;
}
int fmi2DoStep(void *c, double t, double h, int keep)
{
    double *v = ((Oscillator *)c)->v, u = v[1] + 0.1 * v[2] + 0.01 * v[3] + 0.001 * v[4];
    long n = (long)v[13];
    for (long i = 0; i < n; i++) {
        double a = u - v[11] * v[9] - v[12] * v[10];
        v[9] += h / n * v[10];
        v[10] += h / n * a;
    }
    outputs(v);
    return 0;
}
const char *fmi2GetVersion(void) { return "2.0"; }
const char *fmi2GetTypesPlatform(void) { return "default"; }
#define NOTHING(name) int fmi2##name(void) { return 0; }
NOTHING(SetDebugLogging) NOTHING(Terminate) NOTHING(Reset)
NOTHING(GetInteger) NOTHING(GetBoolean) NOTHING(GetString) NOTHING(SetInteger) NOTHING(SetBoolean) NOTHING(SetString)
NOTHING(GetFMUstate) NOTHING(SetFMUstate) NOTHING(FreeFMUstate) NOTHING(SerializedFMUstateSize)
NOTHING(SerializeFMUstate) NOTHING(DeSerializeFMUstate) NOTHING(GetDirectionalDerivative)
NOTHING(SetRealInputDerivatives) NOTHING(GetRealOutputDerivatives) NOTHING(CancelStep) NOTHING(GetStatus)
NOTHING(GetRealStatus) NOTHING(GetIntegerStatus) NOTHING(GetBooleanStatus) NOTHING(GetStringStatus)
"""


def description() -> str:
    scalars = [(n, i, "input", "continuous", 'start="0"') for i, n in enumerate(INPUTS, 1)]
    scalars += [(n, i, "output", "continuous", "") for i, n in enumerate(OUTPUTS, 5)]
    scalars += [("x1", 9, "local", "continuous", ""), ("x2", 10, "local", "continuous", "")]
    scalars += [("k", 11, "parameter", "fixed", 'start="1"'), ("d", 12, "parameter", "fixed", 'start="2"')]
    scalars += [("substeps", 13, "parameter", "fixed", 'start="1"')]
    variables = "".join(
        f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" variability="{changes}">'
        f"<Real {start}/></ScalarVariable>"
        for name, reference, causality, changes, start in scalars
    )
    unknowns = "".join(f'<Unknown index="{i}" dependencies=""/>' for i in range(5, 9))
    return (
        '<fmiModelDescription fmiVersion="2.0" modelName="oscillator" guid="seacrane-benchmark">'
        '<CoSimulation modelIdentifier="oscillator" canHandleVariableCommunicationStepSize="true"/>'
        f"<ModelVariables>{variables}</ModelVariables><ModelStructure><Outputs>{unknowns}</Outputs>"
        f"<InitialUnknowns>{unknowns}</InitialUnknowns></ModelStructure></fmiModelDescription>"
    )


def make_oscillator(folder: Path) -> Path:
    """The benchmark FMU, compiled by this machine's compiler."""
    source, library, path = folder / "oscillator.c", folder / "oscillator.so", folder / "oscillator.fmu"
    source.write_text(SOURCE)
    subprocess.run([*compiler(), "-O2", "-w", "-shared", "-fPIC", source, "-o", library], check=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", description())
        archive.write(library, "binaries/linux64/oscillator.so")
    return path


def chain(path: Path, length: int, substeps: int = 1) -> Case:
    """FMUs of which each drives the next by all its outputs."""
    names = [f"m{i}" for i in range(length)]
    return Case(
        f"chain of {length}",
        dict.fromkeys(names, path),
        [(a, y, b, u) for a, b in pairwise(names) for y, u in zip(OUTPUTS, INPUTS, strict=True)],
        1e-3,
        [(name, y) for name in names for y in OUTPUTS],
        {name: {"substeps": float(substeps)} for name in names},
    )


def make_crane_pair(folder: Path) -> None:
    """The winch drive and the mechanics of the reference crane, at 10 kHz."""
    parts = plant.parts(design.load("offshore-100t"))
    for name in ("winch_drive", "crane"):
        fmi.export(parts[name], folder / f"{name}.fmu")


def crane_pair(folder: Path) -> Case:
    return Case(
        "winch and crane, 10 kHz",
        {name: folder / f"{name}.fmu" for name in ("winch_drive", "crane")},
        [("winch_drive", "torque", "crane", "drum.torque"), ("crane", "drum.speed", "winch_drive", "speed")],
        1e-4,
        [("winch_drive", "torque"), ("crane", "rope.tension")],
        {name: {"solver.fixed_step": 1e-4} for name in ("winch_drive", "crane")},
    )


# ---------------------------------------------------------------- ours
@dataclass
class Ours:
    """A case with our own master."""

    case: Case
    logging: bool
    threads: int | None = None
    run: Execution = field(init=False)

    def __post_init__(self) -> None:
        slaves: dict[tuple[Path, str], FmuSlave] = {}
        system = System(self.case.name.replace(" ", "_"))
        for name, path in self.case.slaves.items():
            starts = self.case.starts.get(name, {})
            key = (path, repr(starts))
            if key not in slaves:
                slaves[key] = FmuSlave(path, starts)
            system.add(name, slaves[key])
        for source, output, target, entry in self.case.joined:
            system.connect(f"{source}.{output}", f"{target}.{entry}")
        self.run = Execution(system, Jacobi(self.case.step), threads=self.threads)
        if self.logging:
            self.run.record([".".join(end) for end in self.case.logged])
        self.run.start()

    def step(self, steps: int) -> None:
        self.run.step(steps)

    def last(self) -> float:
        return float(self.run.values([".".join(self.case.logged[-1])])[0])


TRIED = 1000
"""Macro steps in which a run decides, more than once, whether threads pay."""

ENGINES: dict[str, Callable[[Case, bool], Any]] = {"seacrane": Ours, **PEERS}


def timed(engine: Any, steps: int, repeats: int) -> tuple[float, float]:
    """CPU and clock time [s] of so many steps: each the least of the repeats. The first steps start what is lazy."""
    engine.step(max(2, steps // 20))
    found = []
    for _ in range(repeats):
        wall, cpu = time.perf_counter(), time.process_time()
        engine.step(steps)
        found.append((time.process_time() - cpu, time.perf_counter() - wall))
    return min(cpu for cpu, _ in found), min(wall for _, wall in found)


def measure(engine: str, folder: Path) -> list[dict[str, Any]]:
    """The rows of one engine, in this process."""
    path, rows = folder / "oscillator.fmu", []
    budget = 3_000 if engine == "FMPy" else 20_000
    plan = [(chain(path, 10), logging, budget) for logging in (False, True)]
    if engine in ("seacrane", "libcosimpy, 0 worker threads"):
        plan += [(chain(path, length), False, 10 * budget // length) for length in (100, 1000)]
    if engine != "FMPy":
        plan.append((crane_pair(folder), False, 5_000))
    for case, logging, steps in plan:
        run = ENGINES[engine](case, logging)
        cpu, wall = timed(run, steps, 3)
        per = 1e6 / steps / len(case.slaves)
        kept = "none" if not logging else "CSV" if engine == "ecospy" else "memory"
        rows.append({"engine": engine, "case": case.name, "logging": kept, "us_per_fmu_step": per * cpu,
                     "clock_us_per_fmu_step": per * wall, "last": run.last()})  # fmt: skip
        del run
    if engine == "seacrane":
        rows += threads(path)
    return rows


def threads(path: Path) -> list[dict[str, Any]]:
    """Slaves of 1, 50 and 200 us on one thread and on two, by the clock, turn by turn."""
    cost = timed(Ours(chain(path, 1, 20_000), False), 50, 5)[0] / 50 / 20_000  # of one Euler step
    rows = []
    for us in (1, 50, 200):
        case = chain(path, 10, round(us * 1e-6 / cost))
        runs = {count: Ours(case, False, count) for count in (1, 2)}
        steps = max(20, 20_000 // us)
        for run in runs.values():
            run.step(max(steps, TRIED))
        least = dict.fromkeys(runs, float("inf"))
        for _ in range(15):
            for count, run in runs.items():
                least[count] = min(least[count], timed(run, steps, 1)[1])
        for count, wall in least.items():
            per = 1e6 * wall / steps / len(case.slaves)
            rows.append({"engine": f"seacrane, {count} thread{'s' * (count > 1)}", "logging": "none",
                         "case": f"{case.name}, slaves of {us} us", "us_per_fmu_step": per,
                         "clock_us_per_fmu_step": per})  # fmt: skip
    return rows


def in_a_process(engine: str, folder: Path) -> list[dict[str, Any]]:
    command = [sys.executable, __file__, "--measure", engine, "--folder", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)
    if done.returncode:
        print(f"{engine} failed: {done.stderr.strip()[-400:]}", file=sys.stderr)
        return []
    found: list[dict[str, Any]] = json.loads(done.stdout.splitlines()[-1])
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    parser.add_argument("--measure", choices=ENGINES, help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        print(json.dumps(measure(options.measure, options.folder)), flush=True)
        os._exit(0)  # libraries of peers may wait for their threads
    for name, why in MISSING.items():
        print(f"{name} is left out: {why}")
    best: dict[tuple[str, str, str], dict[str, Any]] = {}
    before = os.getloadavg()[0]
    with tempfile.TemporaryDirectory(prefix="seacrane-benchmark-") as name:
        folder = Path(name)
        make_oscillator(folder)
        make_crane_pair(folder)
        for _ in range(options.rounds):
            for engine in ENGINES:
                for row in in_a_process(engine, folder):
                    key = (row["engine"], row["case"], row["logging"])
                    if key not in best or row["us_per_fmu_step"] < best[key]["us_per_fmu_step"]:
                        best[key] = row
    rows = list(best.values())
    machine = {"processors": os.cpu_count(), "cpu": platform.processor() or platform.machine(),
               "load": [before, os.getloadavg()[0]]}  # fmt: skip
    print(
        f"{machine['processors']} processors, load {before:.1f} to {machine['load'][1]:.1f}; us per FMU and macro step"
    )
    print(f"{'case':28} {'logging':8} {'engine':30} {'us':>9} {'by clock':>9}")
    for row in sorted(rows, key=lambda r: (r["case"], r["logging"])):
        print(f"{row['case']:28} {row['logging']:8} {row['engine']:30} {row['us_per_fmu_step']:9.3f} "
              f"{row['clock_us_per_fmu_step']:9.3f}")  # fmt: skip
    if options.json:
        options.json.write_text(json.dumps({"rows": rows, "machine": machine, "left_out": MISSING}, indent=1) + "\n")


if __name__ == "__main__":
    main()
