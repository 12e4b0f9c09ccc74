"""What a co-simulation master costs: microseconds per FMU and macro step, ours and those of others side by side.

    pip install seacrane[peers]
    apt-get install libtbb12            # which ecospy's wheel needs and does not bring (Debian, Ubuntu)
    python benchmarks/cosim.py --json cosim.json

The FMU is compiled here (FMI 2.0, 4 inputs, 4 outputs, 2 states, one Euler step), so that little but the exchange is
left; ten of them in a chain are stepped at 1 ms by Jacobi's scheme, without logging and with their 40 outputs logged to
memory (ecospy: to a CSV file, it has no log in memory). Then longer chains; a winch drive and the crane that it hoists
on, exported from the reference crane, at 10 kHz; and slaves that cost 1, 50 and 200 us on one and on two threads.

What the FMUs cost by themselves is measured beside, in the same process and turn by turn: a bare C loop sets the inputs
that our run had, steps and gets. `master` is what an engine takes above that, in the median of the turns.

Each engine runs in a process of its own, with all its threads counted. Figures are CPU time, but for the threads, where
it is the clock that counts; each is the least of several repeats, and with `--rounds` that of so many rounds of all
engines. Rows are printed as they come. Peers that are not installed are named and left out. On a busy machine threads
show nothing but how busy it is, unless the whole has precedence: `chrt -f 1 python benchmarks/cosim.py`.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from cosim_cases import Alone, chain, crane_pair, make_crane_pair, make_oscillator, system
from cosim_peers import MISSING, PEERS, Case

from seacrane.cosim import Execution, Jacobi

THREADS = "seacrane, threads"
REPEATS = 16
SECONDS = 0.025
"""CPU time of a repeat, about."""

Row = dict[str, Any]


@dataclass
class Ours:
    """A case with our own master."""

    case: Case
    logging: bool
    threads: int | None = None
    run: Execution = field(init=False)

    def __post_init__(self) -> None:
        self.run = Execution(system(self.case), Jacobi(self.case.step), threads=self.threads)
        if self.logging:
            self.run.record([".".join(end) for end in self.case.logged], keep=10.0)
        self.run.start()

    def step(self, steps: int) -> None:
        self.run.step(steps)


ENGINES: dict[str, Callable[[Case, bool], Any]] = {"seacrane": Ours, **PEERS}


# ---------------------------------------------------------------- one engine, in a process of its own
def timed(engine: Any, steps: int) -> tuple[float, float]:
    """CPU and clock time [s] of so many steps."""
    wall, cpu = time.perf_counter(), time.process_time()
    engine.step(steps)
    return time.process_time() - cpu, time.perf_counter() - wall


def repeated(*runs: Any) -> np.ndarray:
    """CPU and clock time [s] of a step, shape (runs, repeats, 2), turn by turn. The first steps start what is lazy."""
    steps = []
    for run in runs:
        run.step(3)
        steps.append(max(20, round(SECONDS / max(timed(run, 20)[0] / 20, 1e-7))))
    found = [[timed(run, count) for run, count in zip(runs, steps, strict=True)] for _ in range(REPEATS)]
    return np.swapaxes(found, 0, 1) / np.reshape(steps, (-1, 1, 1))


def measure(engine: str, folder: Path) -> Iterator[Row]:
    """The rows of one engine, in this process."""
    path = folder / "oscillator.fmu"
    if engine == THREADS:
        yield from threads(path)
        return
    plan = [(chain(path, 10), logging) for logging in (False, True)]
    if engine in ("seacrane", "libcosimpy, 0 worker threads"):
        plan += [(chain(path, length), False) for length in (100, 1000)]
    if engine != "FMPy":
        plan.append((crane_pair(folder), False))
    for case, logging in plan:
        run = ENGINES[engine](case, logging)
        found = repeated(run) if logging else repeated(run, Alone(case, folder))
        found *= 1e6 / len(case.slaves)
        kept = "none" if not logging else "CSV" if engine == "ecospy" else "memory"
        cpu, wall = found[0].min(axis=0).tolist()
        row = {"engine": engine, "case": case.name, "logging": kept, "us_per_fmu_step": cpu,
               "clock_us_per_fmu_step": wall}  # fmt: skip
        if not logging:
            row["master_us_per_fmu_step"] = float(np.median(found[0, :, 0] - found[1, :, 0]))
        yield row
        del run


def threads(path: Path) -> Iterator[Row]:
    """Slaves of 1, 50 and 200 us on one thread and on two, by the clock, turn by turn."""
    cost = repeated(Ours(chain(path, 1, 20_000), False)).min() / 20_000  # of one Euler step
    for us in (1, 50, 200):
        case = chain(path, 10, round(us * 1e-6 / cost))
        runs = {count: Ours(case, False, count) for count in (1, 2)}
        steps = max(50, 5_000 // us)
        for run in runs.values():
            run.step(200)  # in which it is decided whether threads pay
        found: dict[int, list[float]] = {count: [] for count in runs}
        for _ in range(12):
            for count, run in runs.items():
                found[count].append(timed(run, steps)[1])
        for count, walls in found.items():
            per = 1e6 * min(walls) / steps / len(case.slaves)
            yield {"engine": f"seacrane, {count} thread{'s' * (count > 1)}", "logging": "none",
                   "case": f"{case.name}, slaves of {us} us", "us_per_fmu_step": per,
                   "clock_us_per_fmu_step": per}  # fmt: skip


def in_a_process(engine: str, folder: Path) -> Iterator[Row]:
    command = [sys.executable, __file__, "--measure", engine, "--folder", str(folder)]
    with (
        tempfile.TemporaryFile("w+") as said,
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=said, text=True) as process,
    ):
        late = threading.Timer(300, process.kill)
        late.start()
        assert process.stdout is not None
        for line in process.stdout:
            if line.startswith("{"):
                yield json.loads(line)
        late.cancel()
        if process.wait():
            said.seek(0)
            print(f"{engine} failed: {said.read().strip()[-400:]}", file=sys.stderr)


# ---------------------------------------------------------------- what it shows
def show(row: Row) -> None:
    master = row.get("master_us_per_fmu_step")
    print(f"{row['case']:30} {row['logging']:8} {row['engine']:30} {row['us_per_fmu_step']:9.3f} "
          f"{row['clock_us_per_fmu_step']:9.3f} {'' if master is None else f'{master:9.3f}'}", flush=True)  # fmt: skip


def conclusions(rows: list[Row]) -> Iterator[str]:
    """How we stand beside the others with the crane, and what two threads gain."""
    crane = {row["engine"]: row for row in rows if row["case"].startswith("winch")}
    if ours := crane.pop("seacrane", None):
        for engine, row in crane.items():
            whole, master = ([r[key] for r in (ours, row)] for key in ("us_per_fmu_step", "master_us_per_fmu_step"))
            yield (f"{row['case']}: {whole[0] / whole[1]:.2f} of the CPU time of {engine}; "
                   f"of the masters alone, {master[0]:.2f} us beside {master[1]:.2f} us")  # fmt: skip
    found = {(row["case"], row["engine"]): row["us_per_fmu_step"] for row in rows}
    for (case, engine), us in found.items():
        if engine == "seacrane, 1 thread" and (two := found.get((case, "seacrane, 2 threads"))):
            yield f"{case}: two threads are {us / two:.2f} times as fast as one"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=1, help="of all engines in turn; the least counts (default 1)")
    parser.add_argument("--json", type=Path, help="write the rows to this file")
    parser.add_argument("--measure", choices=[*ENGINES, THREADS], help=argparse.SUPPRESS)
    parser.add_argument("--folder", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        for row in measure(options.measure, options.folder):
            print(json.dumps(row), flush=True)
        os._exit(0)  # libraries of peers may wait for their threads
    for name, why in MISSING.items():
        print(f"{name} is left out: {why}")
    best: dict[tuple[str, str, str], Row] = {}
    before = os.getloadavg()[0]
    head = f"{'case':30} {'logging':8} {'engine':30} {'CPU us':>9} {'clock us':>9} {'master':>9}"
    with tempfile.TemporaryDirectory(prefix="seacrane-benchmark-") as name:
        folder = Path(name)
        print("compiling the FMUs", flush=True)
        make_oscillator(folder)
        make_crane_pair(folder)
        print(f"us per FMU and macro step\n{head}", flush=True)
        for turn in range(options.rounds):
            if turn:
                print(f"round {turn + 1} of {options.rounds}", flush=True)
            for engine in (*ENGINES, THREADS):
                for row in in_a_process(engine, folder):
                    key = (row["engine"], row["case"], row["logging"])
                    if key not in best or row["us_per_fmu_step"] < best[key]["us_per_fmu_step"]:
                        best[key] = row
                    show(row)
    rows = sorted(best.values(), key=lambda row: (row["case"], row["logging"]))
    machine = {"processors": os.cpu_count(), "cpu": platform.processor() or platform.machine(),
               "load": [before, os.getloadavg()[0]]}  # fmt: skip
    print(
        f"\n{machine['processors']} processors, load {before:.1f} to {machine['load'][1]:.1f}; the least of all\n{head}"
    )
    for row in rows:
        show(row)
    for line in conclusions(rows):
        print(line)
    if options.json:
        options.json.write_text(json.dumps({"rows": rows, "machine": machine, "left_out": MISSING}, indent=1) + "\n")


if __name__ == "__main__":
    main()
