"""Loads of postures of every shipped design, by which the page's load chart is held to this package's."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import msgspec

from seacrane import design
from seacrane.design import Crane, chart, planar

FILE = Path(__file__).parents[3] / "web" / "core" / "design" / "loadChart.fixture.json"

COUNTS = {2: 7, 3: 4}


def cranes() -> list[Crane]:
    """The shipped designs, and one that has every limit there is."""
    every = design.load("offshore-100t")
    hoist = msgspec.structs.replace(every.hoist, falls=2, sheave_efficiency=0.98, hook_mass=800.0)
    rating = msgspec.structs.replace(
        every.rating,
        heel=0.05,
        trim=0.02,
        slew_torque=0.6e6,
        load_moment=13e6,
        heeling_moment=18e6,
        structure=(design.JointMoment(joint="luff", moment=16e6), design.JointMoment(joint="jib", moment=9e6)),
    )
    led = design.Attachment(link="column", x=-1.0, z=5.0)
    straight = msgspec.structs.replace(every.hoist, sheaves=(led, every.hoist.sheaves[-1]))
    return [
        *(design.load(name) for name in design.names()),
        msgspec.structs.replace(every, name="every limit", hoist=hoist, rating=rating),
        msgspec.structs.replace(every, name="rope past the knuckle", hoist=straight),
    ]


def content() -> str:
    """The text of the fixture."""
    cases = []
    for crane in cranes():
        postures = planar.grid(crane, COUNTS[len(planar.plane_joints(crane))])
        modes: dict[str, Any] = {}
        for mode in (chart.HARBOUR, chart.mode(crane, "hs2.0")):
            found = chart.capacity(crane, postures, mode)
            modes[mode.name] = {
                "load": found.swl.ravel().tolist(),
                "governs": [found.limits[i] for i in found.governs.ravel()],
            }
        cases.append(
            {
                "crane": json.loads(design.to_json(crane)),
                "coordinates": [q.ravel().tolist() for q in postures.values()],
                "radius": found.radius.ravel().tolist(),
                "height": found.height.ravel().tolist(),
                "modes": modes,
            }
        )
    return json.dumps(cases, indent=None, separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.write_text(content(), encoding="utf-8")
