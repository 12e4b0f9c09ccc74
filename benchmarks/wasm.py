"""What a 10 ms step of the boom drive costs as WebAssembly in Node, and compiled for this machine.

Both set the three inputs, step and read the two outputs, for 60 s in which the rod moves to and fro and the valve gives
what it needs. Native is one call of `simulate`, so that no Python is in it. Processor time, least of the rounds, which
alternate.

    python benchmarks/wasm.py [--json FILE]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np

from seacrane import fmi, model
from seacrane.model.native import NativeModel, build

ROOT = Path(__file__).parents[1]
STEP, COUNT = 0.01, 6000
RECORD = ["rod_force", "rod_work"]


def motion(start: float) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Times, and the inputs held from each of them on: the rod swings by 0.1 m about its start."""
    t = STEP * np.arange(COUNT)
    swing, rate = 0.1, 0.4
    velocity = swing * rate * np.cos(rate * t)
    position = start + swing * np.sin(rate * t)
    return t, {"spool": 0.6 * np.cos(rate * t), "rod_velocity": velocity, "rod_position": position}


def native_step(native: NativeModel, t: np.ndarray, inputs: dict[str, np.ndarray]) -> float:
    """Microseconds per step."""
    with native.instantiate() as drive:
        drive.set(list(inputs), [series[0] for series in inputs.values()])
        drive.initialize()
        begin = time.process_time()
        drive.simulate(t + STEP, RECORD, {name: (t, series) for name, series in inputs.items()})
        return (time.process_time() - begin) / COUNT * 1e6


def wasm_step(module: Path, inputs: dict[str, np.ndarray], rounds: int) -> float:
    """Microseconds per step, with the wrapper of the page."""
    rows = np.stack(list(inputs.values()), axis=1).tolist()
    request = {"module": str(module), "step": STEP, "names": list(inputs), "rows": rows, "record": RECORD}
    plan = module.with_suffix(".json")
    plan.write_text(json.dumps(request | {"rounds": rounds}))
    command = ["node", str(ROOT / "web" / "scripts" / "wasmSteps.mjs"), str(plan)]
    said = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    return float(said.stdout)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", type=Path, help="write the figures to this file")
    arguments = parser.parse_args()
    diagram = model.load(ROOT / "examples" / "boom_drive.json")
    native = build(diagram.compile())
    t, inputs = motion(native.variables["partner.position"].variable.start)
    with tempfile.TemporaryDirectory(prefix="seacrane-benchmark-") as folder:
        module = fmi.export_wasm(diagram, Path(folder) / "boom_drive.wasm")
        size = module.stat().st_size
        rounds = [(native_step(native, t, inputs), wasm_step(module, inputs, 3)) for _ in range(arguments.rounds)]
    figures = {"native": min(n for n, _ in rounds), "wasm": min(w for _, w in rounds)}
    print(f"us per step of 10 ms, inputs set and outputs read ({size / 1000:.1f} kB of WebAssembly):")
    for name, value in figures.items():
        print(f"  {name:8} {value:7.2f}")
    if arguments.json:
        arguments.json.write_text(json.dumps({"us": figures, "bytes": size}, indent=2) + "\n")


if __name__ == "__main__":
    main()
