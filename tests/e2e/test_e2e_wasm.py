"""An exported drive in Node and in Chromium, held against the same drive compiled for this machine."""

import json
import math
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from seacrane import fmi, model
from seacrane.errors import SolveError
from seacrane.model.native import NativeInstance, build

ROOT = Path(__file__).parents[2]
WEB = ROOT / "web"
STEP = 0.01
WEIGHT = 5.2e6  # N, on the rod: what the pressures at the start hold


def refusal(action: Callable[[], object]) -> str:
    with pytest.raises(SolveError) as refused:
        action()
    return str(refused.value)


def lift(drive: NativeInstance, plan: dict[str, Any]) -> list[list[float]]:
    """As in web/e2e/wasmDrive.mjs, operation by operation."""
    x, v = plan["position"], 0.0
    rows = []
    for i, spool in enumerate(plan["spool"]):
        v += (STEP * (drive.get("rod_force") - plan["weight"])) / plan["mass"]
        x += STEP * v
        drive.set(["spool", "rod_velocity", "rod_position"], [spool, v, x])
        drive.step(i * STEP, STEP)
        rows.append(drive.get(plan["names"]).tolist())
    return rows


def test_an_exported_drive_gives_the_native_results_in_node_and_in_chromium(tmp_path: Path) -> None:
    chromium, node = shutil.which("chromium"), shutil.which("node")
    assert chromium, "needs Chromium; `make test` brings it"
    assert node, "needs Node 20"
    assert (WEB / "node_modules").is_dir(), "needs the page's packages; `make setup` brings them"
    diagram = model.load(ROOT / "examples" / "boom_drive.json")
    native = build(diagram.compile())
    kinds = ("STATE", "DERIVATIVE", "OUTPUT", "OBSERVABLE")
    plan = {
        "step": STEP,
        "spool": [0.6 * math.sin(0.4 * i * STEP) + 0.3 * math.sin(1.7 * i * STEP) for i in range(6000)],
        "mass": WEIGHT / 9.81,
        "weight": WEIGHT,
        "position": native.variables["partner.position"].variable.start,
        "names": [e.variable.name for e in native.entries if e.kind in kinds],
    }
    with native.instantiate() as drive:
        refusals = [refusal(lambda: drive.step(0.0, STEP))]
        drive.initialize()
        refusals.append(refusal(lambda: drive.step(0.005, STEP)))
        refusals.append(refusal(lambda: drive.step(0.0, 0.0)))
        refusals.append(refusal(lambda: drive.restore(bytes(len(drive.save())))))
        refusals.append(refusal(lambda: drive.restore(bytes(7))))
        wanted = np.array(lift(drive, plan))

    (tmp_path / "plan.json").write_text(json.dumps(plan))
    environment = {
        "MODULE": str(fmi.export_wasm(diagram, tmp_path / "boom_drive.wasm")),
        "PLAN": str(tmp_path / "plan.json"),
        "RESULT": str(tmp_path / "result.json"),
        "CHROMIUM": chromium,
    }
    command = [node, "e2e/wasm.mjs"]
    done = subprocess.run(
        command, check=False, cwd=WEB, env=os.environ | environment, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stdout + done.stderr
    results = json.loads((tmp_path / "result.json").read_text())

    position = wanted[:, plan["names"].index("cylinder.extension")]
    assert np.ptp(position) > 0.2  # the drive has worked
    scale = np.abs(wanted).max(axis=0)
    for place in ("node", "chromium"):
        deviation = np.abs(np.array(results[place]["trajectory"]) - wanted).max(axis=0)
        far = {name: d for name, d, s in zip(plan["names"], deviation, scale, strict=True) if d > 1e-12 * s}
        assert not far, place
        assert results[place]["refusals"] == refusals
