"""What an FMU costs per communication step in our loop and in FMPy's: set one input, step, get one output.

The FMU is as small as can be (x' = u, one Euler step), so that little but the exchange is left. It is compiled here for
FMI 2.0 and FMI 3.0 co-simulation. `bare` calls the same three functions of the FMI 2.0 library from a C loop without
any master; what lies above it is ours. The rounds of all variants are interleaved, so that a busy machine slows all of
them; the median over the rounds counts.

Then, what an export takes: the hydraulics of two hoisting cranes (boom, jib and winch drives, 56 states) for this
machine and for all platforms. The cache of compiled models is empty, that of the cross compiler's own libraries is not:
a small model has been exported before.

    python benchmarks/fmi.py [--json FILE]
"""

from __future__ import annotations

import argparse
import ctypes
import importlib.util
import json
import os
import re
import statistics
import subprocess
import tempfile
import time
import zipfile
from collections.abc import Callable
from pathlib import Path

import fmpy
from fmpy.fmi2 import FMU2Slave
from fmpy.fmi3 import FMU3Slave

from seacrane import design, fmi, plant
from seacrane.cosim import Execution, FmuSlave, GaussSeidel, System
from seacrane.library.signals import Sine
from seacrane.model import Diagram
from seacrane.native import cache_folder, compiler

STEP = 1e-3

SOURCE = r"""
#include <stdlib.h>
#ifdef THREE
#include "fmi3Functions.h"
#define F(name) fmi3##name
#define STATUS fmi3Status
#define NV , size_t m
#define OK fmi3OK
#else
#include "fmi2Functions.h"
#define F(name) fmi2##name
#define STATUS fmi2Status
#define NV
#define OK fmi2OK
#endif
typedef struct { double u, x; } Tank;
void F(FreeInstance)(void *c) { free(c); }
STATUS F(ExitInitializationMode)(void *c) { return OK; }
STATUS F(Terminate)(void *c) { return OK; }
STATUS F(Reset)(void *c) { return OK; }
#define NONE(T, type) \
    STATUS F(Get##T)(void *c, const unsigned r[], size_t n, type v[] NV) { return OK; } \
    STATUS F(Set##T)(void *c, const unsigned r[], size_t n, const type v[] NV) { return OK; }
#define REAL(T) \
    STATUS F(Get##T)(void *c, const unsigned r[], size_t n, double v[] NV) \
    { for (size_t i = 0; i < n; i++) v[i] = r[i] == 1 ? ((Tank *)c)->u : ((Tank *)c)->x; return OK; } \
    STATUS F(Set##T)(void *c, const unsigned r[], size_t n, const double v[] NV) \
    { for (size_t i = 0; i < n; i++) if (r[i] == 1) ((Tank *)c)->u = v[i]; return OK; }
NONE(Boolean, F(Boolean))
NONE(String, F(String))
#ifdef THREE
REAL(Float64)
NONE(Float32, float) NONE(Int8, fmi3Int8) NONE(UInt8, fmi3UInt8) NONE(Int16, fmi3Int16) NONE(UInt16, fmi3UInt16)
NONE(Int32, fmi3Int32) NONE(UInt32, fmi3UInt32) NONE(Int64, fmi3Int64) NONE(UInt64, fmi3UInt64)
STATUS fmi3GetBinary(void *c, const unsigned r[], size_t n, size_t s[], fmi3Binary v[], size_t m) { return OK; }
STATUS fmi3SetBinary(void *c, const unsigned r[], size_t n, const size_t s[], const fmi3Binary v[], size_t m)
{ return OK; }
STATUS fmi3EnterInitializationMode(void *c, bool a, double b, double t, bool d, double e) { return OK; }
void *fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String path, bool a, bool b, bool e, bool f,
    const unsigned r[], size_t n, void *v, fmi3LogMessageCallback log, fmi3IntermediateUpdateCallback u)
{ return calloc(1, sizeof(Tank)); }
STATUS fmi3DoStep(void *c, double t, double h, bool n, bool *event, bool *end, bool *early, double *last)
{ ((Tank *)c)->x += h * ((Tank *)c)->u; *event = *end = *early = false; *last = t + h; return OK; }
#else
REAL(Real)
NONE(Integer, int)
STATUS fmi2SetupExperiment(void *c, int a, double b, double t, int d, double e) { return OK; }
STATUS fmi2EnterInitializationMode(void *c) { return OK; }
void *fmi2Instantiate(fmi2String n, fmi2Type t, fmi2String g, fmi2String r, const fmi2CallbackFunctions *f, int v,
                      int l)
{ return calloc(1, sizeof(Tank)); }
STATUS fmi2DoStep(void *c, double t, double h, int n) { ((Tank *)c)->x += h * ((Tank *)c)->u; return OK; }
void bare(void *c, long steps, int (*set)(void *, const unsigned *, size_t, const double *),
          int (*step)(void *, double, double, int), int (*get)(void *, const unsigned *, size_t, double *))
{
    const unsigned in = 1, out = 2;
    double u = 1, x = 0;
    for (long i = 0; i < steps; i++) { set(c, &in, 1, &u); step(c, 1e-3 * i, 1e-3, 1); get(c, &out, 1, &x); }
}
#endif
"""

TWO = """<fmiModelDescription fmiVersion="2.0" modelName="tank" guid="g">
<CoSimulation modelIdentifier="tank" canHandleVariableCommunicationStepSize="true"/><ModelVariables>
<ScalarVariable name="u" valueReference="1" causality="input"><Real start="1"/></ScalarVariable>
<ScalarVariable name="x" valueReference="2" causality="output"><Real/></ScalarVariable>
</ModelVariables><ModelStructure><Outputs><Unknown index="2"/></Outputs>
<InitialUnknowns><Unknown index="2"/></InitialUnknowns></ModelStructure></fmiModelDescription>"""

THREE = """<fmiModelDescription fmiVersion="3.0" modelName="tank" instantiationToken="g">
<CoSimulation modelIdentifier="tank" canHandleVariableCommunicationStepSize="true"/><ModelVariables>
<Float64 name="time" valueReference="0" causality="independent"/>
<Float64 name="u" valueReference="1" causality="input" start="1"/>
<Float64 name="x" valueReference="2" causality="output"/></ModelVariables>
<ModelStructure><Output valueReference="2"/><InitialUnknown valueReference="2"/></ModelStructure>
</fmiModelDescription>"""


def make(folder: Path, text: str, place: str, *flags: str) -> Path:
    """The FMU compiled by this machine's compiler."""
    source, library, path = folder / "tank.c", folder / f"{place}.so", folder / f"{place}.fmu"
    source.write_text(SOURCE)
    headers = Path(fmpy.__file__).parent / "c-code"
    functions = (headers / f"fmi{3 if flags else 2}Functions.h").read_text()
    names = re.findall(r"^#define (fmi[23]\w+)\s+fmi[23]FullName", functions, re.MULTILINE)
    others = folder / "others.c"  # FMPy wants every function of the standard to be there
    others.write_text("".join(f"__attribute__((weak)) int {name}(void) {{ return 0; }}\n" for name in names))
    command = [*compiler(), "-O2", "-w", "-shared", "-fPIC", f"-I{headers}", *flags, source, others, "-o", library]
    subprocess.run(command, check=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", text)
        archive.write(library, f"binaries/{place}/tank.so")
    return path


def ours(path: Path, steps: int) -> Callable[[], None]:
    run = Execution(System("one", {"tank": FmuSlave(path)}), GaussSeidel(STEP)).start()
    return lambda: run.step(steps)


def bare(path: Path, steps: int) -> Callable[[], None]:
    fmu = fmi.Fmu(path)
    instance = fmu.instantiate()
    instance.initialize()
    loop = fmu.library.loaded.bare
    loop.argtypes = [ctypes.c_void_p, ctypes.c_long, *[ctypes.c_void_p] * 3]
    calls = instance.calls

    def run() -> None:  # the FMU and its instance live as long as this function
        loop(instance.handle, steps, calls.set, calls.step, calls.get)

    return run


def theirs(path: Path, steps: int) -> Callable[[], None]:
    """The loop that FMPy's simulate_fmu does, without what it records and interpolates."""
    description = fmpy.read_model_description(str(path))
    kind, suffix = (FMU3Slave, "3") if description.fmiVersion.startswith("3") else (FMU2Slave, "2")
    slave = kind(
        guid=description.guid if suffix == "2" else description.instantiationToken,
        unzipDirectory=fmpy.extract(str(path)),
        modelIdentifier="tank",
        instanceName="tank",
    )
    slave.instantiate()
    if suffix == "2":
        slave.setupExperiment()
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    write, read = (slave.setReal, slave.getReal) if suffix == "2" else (slave.setFloat64, slave.getFloat64)

    def run() -> None:
        for i in range(steps):
            write([1], [1.0])
            slave.doStep(currentCommunicationPoint=STEP * i, communicationStepSize=STEP)
            read([2])

    return run


def measure(rounds: int, steps: int) -> dict[str, float]:
    """Median microseconds per step for each variant."""
    with tempfile.TemporaryDirectory(prefix="seacrane-benchmark-") as folder:
        two = make(Path(folder), TWO, "linux64")
        three = make(Path(folder), THREE, "x86_64-linux", "-DTHREE")
        slow = max(1, steps // 100)
        variants = {
            "bare": (bare(two, steps), steps),
            "ours, FMI 2": (ours(two, steps), steps),
            "ours, FMI 3": (ours(three, steps), steps),
            "FMPy, FMI 2": (theirs(two, slow), slow),
            "FMPy, FMI 3": (theirs(three, slow), slow),
        }
        times: dict[str, list[float]] = {name: [] for name in variants}
        for turn in range(rounds + 1):
            for name, (work, count) in variants.items():
                begin = time.perf_counter()
                work()
                if turn:
                    times[name].append((time.perf_counter() - begin) / count * 1e6)
    return {name: statistics.median(values) for name, values in times.items()}


def two_cranes() -> Diagram:
    """The drives that hoist, of two cranes, side by side."""
    both = Diagram("two_cranes")
    for crane in ("first", "second"):
        for name, drive in plant.parts(design.load("offshore-100t")).items():
            if isinstance(drive, Diagram) and name != "slew_drive":
                part = both.add(f"{crane}_{name}", drive)
                both.expose(**{f"{crane}_{name}_{port}": getattr(part, port) for port in drive.exposed})
    return both


def measure_export() -> dict[str, dict[str, float]]:
    """Seconds of an export from the compiled equations to the finished file, by the clock and of all processors."""
    small = Diagram("small")
    small.expose(y=small.add("wave", Sine(amplitude=1.0, period=1.0)).y)
    dae = two_cranes().compile()
    assert len(dae.states) == 56
    os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(cache_folder().parent / "zig"))
    kept, times = os.environ.get("XDG_CACHE_HOME"), {}
    all_ = ["all"] if importlib.util.find_spec("ziglang") is not None else []
    with tempfile.TemporaryDirectory(prefix="seacrane-benchmark-") as folder:
        os.environ["XDG_CACHE_HOME"] = folder
        for platforms in ("host", *all_):
            fmi.export(small, Path(folder) / "small.fmu", platforms=platforms)
            begin, used = time.perf_counter(), sum(os.times()[:4])
            fmi.export(dae, Path(folder) / "large.fmu", platforms=platforms)
            times[platforms] = {"clock": time.perf_counter() - begin, "processors": sum(os.times()[:4]) - used}
    os.environ.pop("XDG_CACHE_HOME")
    if kept is not None:
        os.environ["XDG_CACHE_HOME"] = kept
    return times


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--steps", type=int, default=200_000, help="steps of the C loop in a round")
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    arguments = parser.parse_args()
    figures = measure(arguments.rounds, arguments.steps)
    print("us per set + step + get (FMU included):")
    for name, value in figures.items():
        print(f"  {name:12} {value:8.4f}")
    overhead = {n: figures[f"ours, {n}"] - figures["bare"] for n in ("FMI 2", "FMI 3")}
    ratio = {n: figures[f"FMPy, {n}"] / figures[f"ours, {n}"] for n in ("FMI 2", "FMI 3")}
    for name in ratio:
        print(f"{name}: overhead of our loop {overhead[name]:.4f} us; FMPy / ours {ratio[name]:.0f}")
    exports = measure_export()
    for platforms, seconds in exports.items():
        print(
            f"56 states exported for {platforms}: {seconds['clock']:.1f} s, of processors {seconds['processors']:.1f} s"
        )
    if arguments.json:
        report = {"us": figures, "overhead_us": overhead, "ratio": ratio, "export_s": exports}
        arguments.json.write_text(json.dumps(report, indent=2) + "\n")


if __name__ == "__main__":
    main()
