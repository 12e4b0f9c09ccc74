"""What `cosim.py` runs: FMUs and how they are joined, and what they cost by themselves, without any master."""

from __future__ import annotations

import ctypes
import subprocess
import zipfile
from itertools import pairwise
from pathlib import Path

import numpy as np
from cosim_peers import Case

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


def compiled(source: Path, library: Path) -> None:
    subprocess.run([*compiler(), "-O2", "-w", "-shared", "-fPIC", source, "-o", library], check=True)


def make_oscillator(folder: Path) -> Path:
    """The benchmark FMU, compiled by this machine's compiler."""
    source, library, path = folder / "oscillator.c", folder / "oscillator.so", folder / "oscillator.fmu"
    source.write_text(SOURCE)
    compiled(source, library)
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


def system(case: Case) -> System:
    """A case for our own master."""
    slaves: dict[tuple[Path, str], FmuSlave] = {}
    made = System(case.name.replace(" ", "_"))
    for name, path in case.slaves.items():
        starts = case.starts.get(name, {})
        key = (path, repr(starts))
        if key not in slaves:
            slaves[key] = FmuSlave(path, starts)
        made.add(name, slaves[key])
    for source, output, target, entry in case.joined:
        made.connect(f"{source}.{output}", f"{target}.{entry}")
    return made


# ---------------------------------------------------------------- no master
REPLAY = r"""
#include <stddef.h>
typedef struct {
    void *handle;
    int (*set)(void *, const unsigned *, size_t, const double *);
    int (*step)(void *, double, double, int);
    int (*get)(void *, const unsigned *, size_t, double *);
    const unsigned *taken, *given;
    size_t inputs, outputs;
    double *y;
} Fmu;
int replay(const Fmu *fmus, size_t count, const double *rows, long width, long begin, long end, double h)
{
    int bad = 0;
    for (long k = begin; k < end; k++) {
        const double *u = rows + (k - begin) * width;
        for (size_t i = 0; i < count; i++) {
            const Fmu *f = fmus + i;
            if (f->inputs) bad |= f->set(f->handle, f->taken, f->inputs, u) > 1;
            bad |= f->step(f->handle, k * h, h, 1) > 1;
            bad |= f->get(f->handle, f->given, f->outputs, f->y) > 1;
            u += f->inputs;
        }
    }
    return bad;
}
"""

REPLAYED = 4_000
"""Rows of inputs that are given again and again, over the number of FMUs."""


class _Fmu(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_void_p) for name in ("handle", "set", "step", "get", "taken", "given")),
        *((name, ctypes.c_size_t) for name in ("inputs", "outputs")),
        ("y", ctypes.c_void_p),
    )


class Alone:
    """The FMUs of a case without a master: a C loop calls set, step and get of each, with recorded inputs."""

    def __init__(self, case: Case, folder: Path) -> None:
        source, library = folder / "replay.c", folder / "replay.so"
        if not library.exists():
            source.write_text(REPLAY)
            compiled(source, library)
        self.replay = ctypes.CDLL(str(library)).replay
        self.replay.argtypes = [
            ctypes.c_void_p,
            ctypes.c_size_t,
            ctypes.c_void_p,
            *3 * [ctypes.c_long],
            ctypes.c_double,
        ]
        whole = system(case)
        inputs = [f"{name}.{v.name}" for name, slave in whole.slaves.items() for v in slave.interface.inputs]
        with Execution(whole, Jacobi(case.step), threads=1) as run:
            run.record(inputs)
            recording = run.run(REPLAYED // len(case.slaves) * case.step)
        self.rows = np.column_stack([recording[name][1:] for name in inputs])
        self.case, self.done, self.kept = case, 0, []
        self.fmus = (_Fmu * len(whole.slaves))()
        for fmu, (name, slave) in zip(self.fmus, whole.slaves.items(), strict=True):
            instance, interface = slave.instantiate(name), slave.interface
            taken, given = np.zeros(len(interface.inputs)), np.zeros(len(interface.outputs))
            instance.bind(taken, given)
            instance.initialise(0.0)
            instance.evaluate()
            instance.begin()
            calls = instance.calls
            references = [
                np.array([calls.references[v.name] for v in variables], dtype=np.uint32)
                for variables in (interface.inputs, interface.outputs)
            ]
            fmu.handle, fmu.set, fmu.step, fmu.get = calls.handle, calls.set, calls.step, calls.get
            fmu.taken, fmu.given = (array.ctypes.data for array in references)
            fmu.inputs, fmu.outputs, fmu.y = taken.size, given.size, given.ctypes.data
            self.kept.append((instance, taken, given, references))

    def step(self, steps: int) -> None:
        while steps > 0:
            first = self.done % len(self.rows)
            count = min(steps, len(self.rows) - first)
            table = self.rows[first:].ctypes.data, self.rows.shape[1]
            arguments = ctypes.addressof(self.fmus), len(self.fmus), *table, self.done, self.done + count
            assert self.replay(*arguments, self.case.step) == 0
            self.done += count
            steps -= count
