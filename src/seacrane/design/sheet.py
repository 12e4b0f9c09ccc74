"""The data sheet of a design: one page of PDF with drawing, load chart, workspace and where it all comes from."""

from __future__ import annotations

import numpy as np

from seacrane.design import chart, geometry, workspace
from seacrane.design.crane import Attachment, Crane
from seacrane.design.mesh import joined, mesh
from seacrane.design.planar import plane_joints
from seacrane.design.standard import furnished
from seacrane.results.charts import Line, data_sheet
from seacrane.units import bar, deg, kN


def sheet(crane: Crane, provenance: str) -> bytes:
    """The sheet as PDF; `provenance` is the hash that it names. The same design gives the same bytes."""
    where = workspace.section(crane, 240 if len(plane_joints(crane)) == 2 else 120)
    best = workspace.loads(crane, where)
    curves = {}
    for mode in chart.modes(crane):
        rows = chart.curve(crane, mode)
        curves[mode.name] = [row.radius for row in rows], [row.swl for row in rows]
    return data_sheet(
        crane.name,
        crane.about,
        facts(crane, where),
        side_view(crane, half_way(crane)),
        curves,
        (where.radius, where.height, best),
        f"Design SHA-256 {provenance}",
    )


def side_view(crane: Crane, posture: dict[str, float]) -> list[Line]:
    """The crane seen from starboard in a posture: edges of the links, cylinders, rope, as lines (x, z) [m]."""
    lines: list[Line] = []
    frames = geometry.frames(crane, posture)
    for link in furnished(crane).links:
        frame = frames[link.name]
        shape = joined([mesh(part) for part in link.parts]).moved(frame.rotation, frame.origin)
        ends = shape.vertices[_creases(shape.vertices, shape.faces)][:, :, [0, 2]]
        broken = np.concatenate([ends, np.full((len(ends), 1, 2), np.nan)], axis=1).reshape(-1, 2)
        lines.append((broken[:, 0].tolist(), broken[:, 1].tolist()))

    def at(pin: Attachment) -> tuple[float, float]:
        x, _, z = frames[pin.link].point((pin.x, 0.0, pin.z))
        return float(x), float(z)

    for cylinder in crane.cylinders:
        (x0, z0), (x1, z1) = at(cylinder.base), at(cylinder.eye)
        lines.append(([x0, x1], [z0, z1]))
    path = [at(pin) for pin in (crane.hoist.drum, *crane.hoist.sheaves)]
    lines.append(([x for x, _ in path], [z for _, z in path]))
    return lines


def _creases(vertices: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """The edges (n, 2) where the surface turns by more than 30 degrees."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    owner = np.tile(np.arange(len(faces)), 3)
    key = np.sort(edges, axis=1)
    order = np.lexsort((key[:, 1], key[:, 0]))
    first, second = order[0::2], order[1::2]  # a closed surface has each edge twice
    turned = np.einsum("ij,ij->i", normals[owner[first]], normals[owner[second]]) < np.cos(np.pi / 6)
    creases: np.ndarray = key[first[turned]]
    return creases


def half_way(crane: Crane) -> dict[str, float]:
    """The posture with every joint in the middle of its limits."""
    return {
        joint.name: 0.5 * (joint.limits[0] + joint.limits[1]) if joint.limits else 0.0 for joint in plane_joints(crane)
    }


def facts(crane: Crane, where: workspace.Section | None = None) -> list[tuple[str, str]]:
    """What a data sheet says of a crane, as pairs of words; `where` is its workspace if that is known already."""
    where = where or workspace.section(crane, 240 if len(plane_joints(crane)) == 2 else 120)
    low_x, high_x, low_z, high_z = workspace.extent(crane)
    total = sum(link.mass for link in crane.links)
    known = [
        ("reach", f"{max(low_x, 0):.2f} to {high_x:.2f} m"),
        ("height of the tip above the foot", f"{low_z:.2f} to {high_z:.2f} m"),
        ("workspace", f"{where.area:.0f} m2, {where.volume(crane):.0f} m3"),
        ("mass of all links", f"{total / 1e3:.1f} t"),
    ]
    for joint in crane.joints:
        unit, symbol = (1.0, "m") if joint.kind == "prismatic" else (deg, "deg")
        limits = f"{joint.limits[0] / unit:.4g} to {joint.limits[1] / unit:.4g} {symbol}" if joint.limits else "endless"
        known.append((f"joint {joint.name}", limits))
    for c in crane.cylinders:
        size = (
            f"{c.count} x {c.bore * 1e3:.0f}/{c.rod * 1e3:.0f} mm, stroke {c.stroke:.3g} m, {c.pressure / bar:.0f} bar"
        )
        known.append((c.name, size))
    hoist = crane.hoist
    falls = "1 fall" if hoist.falls == 1 else f"{hoist.falls} falls"
    pull = f", line pull {hoist.line_pull / kN:.4g} kN" if hoist.line_pull else ""
    known.append(("hoist", f"{falls} of {hoist.rope.diameter * 1e3:.0f} mm, rope at {hoist.speed:.3g} m/s{pull}"))
    return known
