"""Masses of the standard parts of every shipped design, by which the page's meshes are held to this package's."""

from __future__ import annotations

import json
from pathlib import Path

from seacrane import design
from seacrane.design import mass, mesh, standard

FILE = Path(__file__).parents[3] / "web" / "core" / "design" / "parts.fixture.json"


def content() -> str:
    """The text of the fixture: by design and link, each part with its dimensions, corners, mass, centre and inertia."""
    cases = []
    for name in design.names():
        crane = design.load(name)
        whole = json.loads(design.to_json(standard.furnished(crane)))
        bodies = {}
        for link in standard.furnished(crane).links:
            bodies[link.name] = []
            for part in link.parts:
                body, surface = mass.of_part(part), mesh.mesh(part)
                i = body.inertia
                bodies[link.name].append(
                    {
                        "name": part.name,
                        "vertices": len(surface.vertices),
                        "faces": len(surface.faces),
                        "mass": body.mass,
                        "centre": body.centre.tolist(),
                        "inertia": [float(i[k]) for k in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))],
                    }
                )
        cases.append({"crane": json.loads(design.to_json(crane)), "links": whole["links"], "bodies": bodies})
    return json.dumps(cases, separators=(",", ":")) + "\n"


if __name__ == "__main__":
    FILE.write_text(content(), encoding="utf-8")
