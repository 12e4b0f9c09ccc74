"""The page draws the crane and the sea that the physics has: one file of postures and elevations, checked by both.

This side checks that the file is what Python computes now; `web/core` checks its own functions against the file. After
a change of the kinematics or of the reference crane, run this file as a program to write it anew.
"""

import json
from pathlib import Path
from typing import Any

import msgspec
import pytest

from seacrane import design, ocean
from seacrane.design import geometry
from seacrane.units import deg

FILE = Path(__file__).parents[1] / "fixtures" / "crane_kinematics.json"

POSTURES = [
    {"slew": 90 * deg, "luff": 50 * deg, "jib": -70 * deg},
    {"slew": 0.0, "luff": 0.0, "jib": 0.0},
    {"slew": -143 * deg, "luff": 78 * deg, "jib": -115 * deg},
    {"slew": 805 * deg, "luff": 12.5 * deg, "jib": -33.3 * deg},
]
PROBES = [(0.0, 0.0, 0.0), (31.7, -18.2, 12.4), (-240.0, 410.0, 3600.0), (12.0, 7.0, 360_000.0)]


def content() -> dict[str, Any]:
    crane = design.load("offshore-100t")
    sea = ocean.Jonswap(hs=2.5, tp=8.0, seed=7).waves()
    return {
        "crane": json.loads(msgspec.json.encode(crane)),
        "postures": [
            {
                "joints": posture,
                "frames": {
                    name: {"R": frame.rotation.ravel().tolist(), "p": frame.origin.tolist()}
                    for name, frame in geometry.frames(crane, posture).items()
                },
                "tip": geometry.tip(crane, posture).tolist(),
                "radius": geometry.radius(crane, posture),
                "cylinders": {c.name: geometry.cylinder_length(crane, c, posture) for c in crane.cylinders},
            }
            for posture in POSTURES
        ],
        "retracted": {c.name: geometry.retracted_length(crane, c) for c in crane.cylinders},
        "waves": sea.rows(),
        "elevations": [{"x": x, "y": y, "t": t, "eta": float(sea.elevation(x, y, t))} for x, y, t in PROBES],
    }


def differences(kept: Any, computed: Any, path: str = "") -> list[str]:
    """Where two contents differ by more than rounding."""
    if isinstance(kept, dict) and isinstance(computed, dict) and kept.keys() == computed.keys():
        return [d for key in kept for d in differences(kept[key], computed[key], f"{path}.{key}")]
    if isinstance(kept, list) and isinstance(computed, list) and len(kept) == len(computed):
        return [
            d for i, (a, b) in enumerate(zip(kept, computed, strict=True)) for d in differences(a, b, f"{path}[{i}]")
        ]
    if isinstance(kept, int | float) and isinstance(computed, int | float):
        return [] if kept == pytest.approx(computed, rel=1e-9, abs=1e-9) else [f"{path}: {kept} is now {computed}"]
    return [] if kept == computed else [f"{path}: {kept} is now {computed}"]


def test_the_postures_and_elevations_that_the_page_is_checked_against_are_those_of_the_physics() -> None:
    assert differences(json.loads(FILE.read_text(encoding="utf-8")), content()) == []


if __name__ == "__main__":
    FILE.write_text(json.dumps(content(), indent=1) + "\n", encoding="utf-8")
