"""The data sheet of a design: drawing, workspace, load chart with its conditions, masses and sources."""

from __future__ import annotations

import msgspec
import numpy as np

from seacrane.design import chart, geometry, mass, workspace
from seacrane.design.crane import Attachment, Crane, Cylinder
from seacrane.design.mesh import Mesh, mesh
from seacrane.design.parts import Box, Girder, Part
from seacrane.design.planar import plane_joints
from seacrane.design.standard import furnished
from seacrane.results.charts import Shape
from seacrane.results.data_sheet import Sheet, data_sheet
from seacrane.units import bar, deg, kN, rpm


def sheet(crane: Crane, provenance: str) -> bytes:
    """The sheet as PDF; `provenance` is the hash that it names. The same design gives the same bytes."""
    return data_sheet(content(crane, provenance))


def content(crane: Crane, provenance: str) -> Sheet:
    """What the sheet says and shows."""
    where = workspace.section(crane, 240 if len(plane_joints(crane)) == 2 else 120)
    curves = {mode.name: chart.curve(crane, mode) for mode in chart.modes(crane)}
    posture = at_work(crane)
    x, _, z = geometry.tip(crane, posture)
    return Sheet(
        name=crane.name,
        about=crane.about,
        facts=facts(crane, where),
        view=side_view(crane, posture),
        tip=(float(x), float(z)),
        section=(where.radius, where.height, workspace.loads(crane, where)),
        curves={mode: [(row.radius, row.swl, row.governs) for row in rows] for mode, rows in curves.items()},
        conditions=chart.conditions(crane),
        tables=tables(crane),
        sources=[f"{source.of} ({source.kind}): {source.note}" for source in crane.sources],
        provenance=f"Design SHA-256 {provenance}",
    )


# ---------------------------------------------------------------- drawing
def side_view(crane: Crane, posture: dict[str, float]) -> list[Shape]:
    """The crane seen from starboard in a posture: parts, cylinders and rope, what is farther to port first [m]."""
    frames = geometry.frames(crane, posture)
    shapes: list[tuple[float, Shape]] = []
    for link in furnished(crane).links:
        frame = frames[link.name]
        for part in link.parts:
            shape = _outside(part).moved(frame.rotation, frame.origin)
            shapes.append((float(shape.vertices[:, 1].mean()), _seen(shape)))

    def at(pin: Attachment) -> np.ndarray:
        place: np.ndarray = frames[pin.link].point((pin.x, 0.0, pin.z))[[0, 2]]
        return place

    shapes += [(0.0, shape) for c in crane.cylinders for shape in _cylinder(crane, c, at(c.base), at(c.eye))]
    path = np.array([at(pin) for pin in (crane.hoist.drum, *crane.hoist.sheaves)])
    rope = Shape(np.empty((0, 3, 2)), np.stack([path[:-1], path[1:]], axis=1))
    return [shape for _, shape in sorted(shapes, key=lambda item: -item[0])] + [rope]


def _outside(part: Part) -> Mesh:
    """The surface of a part without that of its hollow, which nobody sees."""
    if isinstance(part, Box):
        return mesh(msgspec.structs.replace(part, thickness=None))
    whole = mesh(part)
    if isinstance(part, Girder):  # the outer skin, then as large a share of vertices and faces for the inner one
        outer = 4 * len(part.stations)
        return Mesh(whole.vertices[:outer], whole.faces[(whole.faces < outer).all(axis=1)])
    return whole


def _seen(shape: Mesh) -> Shape:
    """What a mesh covers, and its edges: where it turns by 30 degrees, or away from who looks from starboard."""
    flat = shape.vertices[:, [0, 2]]
    a, b, c = (shape.vertices[shape.faces[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
    edges = np.concatenate([shape.faces[:, [0, 1]], shape.faces[:, [1, 2]], shape.faces[:, [2, 0]]])
    owner = np.tile(np.arange(len(shape.faces)), 3)
    key = np.sort(edges, axis=1)
    order = np.lexsort((key[:, 1], key[:, 0]))
    first, second = order[0::2], order[1::2]  # a closed surface has each edge twice
    one, other = normals[owner[first]], normals[owner[second]]
    towards = np.minimum(one[:, 1], other[:, 1]) < -1e-6
    turned = np.einsum("ij,ij->i", one, other) < np.cos(np.pi / 6)
    away = np.maximum(one[:, 1], other[:, 1]) > -1e-6
    return Shape(flat[shape.faces], flat[key[first[towards & (turned | away)]]])


def _cylinder(crane: Crane, cylinder: Cylinder, base: np.ndarray, eye: np.ndarray) -> list[Shape]:
    """Rod and barrel from pin to pin; the barrel ends a bore short of the eye when the rod is in."""
    length = float(np.linalg.norm(eye - base))
    along = (eye - base) / max(length, 1e-9)
    end = base + along * min(max(geometry.retracted_length(crane, cylinder) - cylinder.bore, 0.0), length)
    return [_bar(end, eye, cylinder.rod), _bar(base, end, 1.2 * cylinder.bore)]


def _bar(start: np.ndarray, end: np.ndarray, width: float) -> Shape:
    along = (end - start) / max(float(np.linalg.norm(end - start)), 1e-9)
    aside = 0.5 * width * np.array([-along[1], along[0]])
    ring = np.array([start - aside, end - aside, end + aside, start + aside])
    return Shape(ring[[[0, 1, 2], [0, 2, 3]]], np.stack([ring, np.roll(ring, -1, axis=0)], axis=1))


def at_work(crane: Crane) -> dict[str, float]:
    """The best posture in harbour at the middle radius of the load chart."""
    rows = chart.curve(crane)
    return rows[len(rows) // 2].posture if rows else half_way(crane)


def half_way(crane: Crane) -> dict[str, float]:
    """The posture with every joint in the middle of its limits."""
    return {
        joint.name: 0.5 * (joint.limits[0] + joint.limits[1]) if joint.limits else 0.0 for joint in plane_joints(crane)
    }


# ---------------------------------------------------------------- words
def facts(crane: Crane, where: workspace.Section | None = None) -> list[tuple[str, str]]:
    """What a data sheet says of a crane, as pairs of words; `where` is its workspace if that is known already."""
    where = where or workspace.section(crane, 240 if len(plane_joints(crane)) == 2 else 120)
    low_x, high_x, low_z, high_z = workspace.extent(crane)
    turned = f", {where.volume(crane):.0f} m3 in slewing" if crane.slew else ""
    rated = [f"{point.mass / 1e3:.4g} t at {point.radius:.4g} m" for point in crane.capacity]
    several = f" (and {len(rated) - 3} more)" if len(rated) > 3 else ""
    known = [
        ("rated load", ", ".join(rated[:3]) + several),
        ("reach", f"{max(low_x, 0) if crane.slew else low_x:.2f} to {high_x:.2f} m"),
        ("height of tip over foot", f"{low_z:.2f} to {high_z:.2f} m"),
        ("workspace", f"{where.area:.0f} m2{turned}"),
        ("mass of all links", f"{sum(link.mass for link in crane.links) / 1e3:.1f} t"),
    ]
    for joint in crane.joints:
        unit, symbol = (1.0, "m") if joint.kind == "prismatic" else (deg, "deg")
        limits = f"{joint.limits[0] / unit:.4g} to {joint.limits[1] / unit:.4g} {symbol}" if joint.limits else "endless"
        speed = f", {crane.slew.speed / rpm:.3g} rpm" if crane.slew and crane.slew.joint == joint.name else ""
        known.append((f"joint {joint.name}", limits + speed))
    for c in crane.cylinders:
        size = (
            f"{c.count} x {c.bore * 1e3:.0f}/{c.rod * 1e3:.0f} mm, stroke {c.stroke:.3g} m, {c.pressure / bar:.0f} bar"
        )
        known.append((c.name, size))
    hoist = crane.hoist
    falls = "1 fall" if hoist.falls == 1 else f"{hoist.falls} falls"
    pull = f", line pull {hoist.line_pull / kN:.4g} kN" if hoist.line_pull else ""
    known.append(("hoist", f"{falls} of {hoist.rope.diameter * 1e3:.0f} mm, rope at {hoist.speed:.3g} m/s{pull}"))
    if hoist.rope.breaking_load:
        factor = f"used to 1/{hoist.rope.safety_factor:.3g} of it"
        known.append(("rope breaking load", f"{hoist.rope.breaking_load / kN:.4g} kN, {factor}"))
    known.append(("hook block", f"{hoist.hook_mass / 1e3:.3g} t" if hoist.hook_mass else "none given"))
    return known


def tables(crane: Crane) -> dict[str, list[list[str]]]:
    """Links with their masses and cylinders with their forces, as rows of words under their heads."""
    links = [["link", "length [m]", "mass [t]", "centre x, y, z [m]", "inertia x, y, z [t.m2]"]]
    ends = [link.joint.origin for link in crane.links[1:]]
    tip = crane.hoist.sheaves[-1]
    for link, (x, y, z) in zip(crane.links, [*ends, (tip.x, 0.0, tip.z)], strict=True):
        links.append(
            [
                link.name,
                f"{np.linalg.norm((x, y, z)):.3f}",
                f"{link.mass / 1e3:.2f}",
                ", ".join(f"{value:.2f}" for value in link.com),
                ", ".join(f"{value / 1e3:.4g}" for value in link.inertia),
            ]
        )
    sets = [["cylinders", "moves", "pin to pin [m]", "push [kN]", "pull [kN]", "steel, estimate [t]"]]
    for c in crane.cylinders:
        push, pull = chart.forces(c)
        shortest, longest = geometry.cylinder_range(crane, c)
        steel = mass.of_cylinder(c) / 1e3
        sets.append(
            [
                c.name,
                c.moves,
                f"{shortest:.3f} to {longest:.3f}",
                f"{push / kN:.0f}",
                f"{pull / kN:.0f}",
                f"{steel:.2f}",
            ]
        )
    return {"Links": links} | ({"Cylinders, all of a set together": sets} if crane.cylinders else {})
