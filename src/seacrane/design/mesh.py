"""Surfaces of parts as triangles, closed and with their normals outward.

A hollow part has its inner surface too, with normals into the hollow, so that the volume of a mesh is that of the
steel in it.
"""

from __future__ import annotations

import base64
import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seacrane.design.parts import Box, Drum, Girder, Imported, Lug, Part, Sheave, Tube

Array = NDArray[np.float64]

_TRIANGLE = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
"""A triangle of a binary STL."""

SIDES = 48
"""Corners of a circle: its area is right to 0.3 %."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles: vertices (n, 3) [m]; faces (m, 3) of indices into them, counter-clockwise seen from outside."""

    vertices: Array
    faces: NDArray[np.int32]

    def moved(self, rotation: Array, origin: Array) -> Mesh:
        """The mesh in another frame: each vertex p at origin + rotation p."""
        return Mesh(self.vertices @ rotation.T + origin, self.faces)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    """Several meshes as one, side by side."""
    vertices, faces, offset = [np.empty((0, 3))], [np.empty((0, 3), np.int32)], 0
    for mesh in meshes:
        vertices.append(mesh.vertices)
        faces.append(mesh.faces + offset)
        offset += len(mesh.vertices)
    return Mesh(np.concatenate(vertices), np.concatenate(faces).astype(np.int32))


@functools.singledispatch
def mesh(part: Part) -> Mesh:
    """The surface of a part in the frame of its link."""
    raise TypeError(f"no such part: {type(part).__name__}")


# ---------------------------------------------------------------- parts
@mesh.register
def _(part: Girder) -> Mesh:
    first, last = part.stations[0].x, part.stations[-1].x
    t = part.thickness
    outer = [_section(part, s.x, 0.0) for s in part.stations]
    places = [first + t, *(s.x for s in part.stations if first + t < s.x < last - t), last - t]
    inner = [_section(part, x, t) for x in places]
    return joined([_loft(outer), _inside_out(_loft(inner))])


def _section(part: Girder, x: float, inset: float) -> Array:
    """The rectangle (4, 3) of a girder at x, its plates `inset` deep; counter-clockwise seen against x."""
    xs = [s.x for s in part.stations]
    top = float(np.interp(x, xs, [s.top for s in part.stations])) - inset
    bottom = float(np.interp(x, xs, [s.bottom for s in part.stations])) + inset
    half = 0.5 * float(np.interp(x, xs, [s.width for s in part.stations])) - inset
    y = part.y
    return np.array([[x, y - half, bottom], [x, y + half, bottom], [x, y + half, top], [x, y - half, top]])


@mesh.register
def _(part: Tube) -> Mesh:
    start, end = np.array(part.start, float), np.array(part.end, float)
    along = (end - start) / np.linalg.norm(end - start)
    aside = np.cross(along, [0.0, 1.0, 0.0])
    if np.linalg.norm(aside) < 1e-6:
        aside = np.cross(along, [0.0, 0.0, 1.0])
    aside /= np.linalg.norm(aside)
    across = np.cross(along, aside)
    radii = 0.5 * part.diameter, 0.5 * part.end_diameter
    length, t = float(np.linalg.norm(end - start)), part.thickness
    profile = [(radii[0], 0.0), (radii[1], length), (radii[1] - t, length), (radii[0] - t, 0.0)]
    return _lathe(profile).moved(np.column_stack([aside, across, along]), start)


@mesh.register
def _(part: Lug) -> Mesh:
    outline, hole = _eye(part)
    half = 0.5 * part.gap
    plates = []
    for inner, outer in ((half, half + part.thickness), (-half - part.thickness, -half)):
        rings = [
            _at_y(ring, part.y + y) for ring, y in ((outline, outer), (outline, inner), (hole, inner), (hole, outer))
        ]
        plates.append(_torus(rings))
    return joined(plates)


def _eye(part: Lug) -> tuple[Array, Array]:
    """Outline and hole (SIDES, 2) of an eye plate in x and z: the hull of a circle and the root, point by point."""
    pin, root = np.array([part.x, part.z]), np.array([part.root_x, part.root_z])
    down = root - pin
    reach = float(np.linalg.norm(down))
    along = down / reach if reach > 0 else np.array([0.0, -1.0])
    aside = np.array([-along[1], along[0]])
    corners = [(reach, 0.5 * part.root_width), (reach, -0.5 * part.root_width)]
    angles = 2 * math.pi * np.arange(SIDES) / SIDES
    rays = np.column_stack([np.cos(angles), np.sin(angles)])
    far = np.full(SIDES, part.radius)
    if reach > part.radius:
        far = np.array([_hull_distance(ray, part.radius, corners) for ray in rays])
    frame = np.array([along, aside])
    hole = pin + 0.5 * part.hole * rays @ frame
    return pin + far[:, None] * rays @ frame, hole


def _hull_distance(ray: Array, radius: float, corners: list[tuple[float, float]]) -> float:
    """How far the hull of a circle about the origin and two corners reaches along a unit vector."""
    best = radius
    (ax, ay), (bx, by) = corners
    edges = [((ax, ay), (bx, by))]
    for cx, cy in corners:
        size = math.hypot(cx, cy)
        if size <= radius:
            continue
        turn = math.acos(radius / size) * (1.0 if cy > 0 else -1.0)
        angle = math.atan2(cy, cx) + turn
        edges.append(((cx, cy), (radius * math.cos(angle), radius * math.sin(angle))))
    for (x0, y0), (x1, y1) in edges:
        ex, ey = x1 - x0, y1 - y0
        cross = ray[0] * ey - ray[1] * ex
        if abs(cross) < 1e-15:
            continue
        distance = (x0 * ey - y0 * ex) / cross
        where = (x0 * ray[1] - y0 * ray[0]) / cross
        if distance > best and -1e-12 <= where <= 1 + 1e-12:
            best = float(distance)
    return best


@mesh.register
def _(part: Sheave) -> Mesh:
    half, hole = 0.5 * part.width, 0.5 * part.hole
    floor = part.radius - part.groove
    profile = [(hole, -half), (part.radius, -half), (floor, 0.0), (part.radius, half), (hole, half)]
    return _across(_lathe(profile), part.x, part.z)


@mesh.register
def _(part: Drum) -> Mesh:
    half, t = 0.5 * part.length, part.thickness
    profile = [
        (part.radius - t, -half),
        (part.flange, -half),
        (part.flange, -half + t),
        (part.radius, -half + t),
        (part.radius, half - t),
        (part.flange, half - t),
        (part.flange, half),
        (part.radius - t, half),
    ]
    return _across(_lathe(profile), part.x, part.z)


@mesh.register
def _(part: Box) -> Mesh:
    outer = _block(part.centre, part.size)
    if part.thickness is None:
        return outer
    x, y, z = (s - 2 * part.thickness for s in part.size)
    return joined([outer, _inside_out(_block(part.centre, (x, y, z)))])


@mesh.register
def _(part: Imported) -> Mesh:
    return decoded(part.surface)


def decoded(surface: str) -> Mesh:
    """The mesh in a binary STL in base64, its equal corners joined. `ValueError` if it is none."""
    content = base64.b64decode(surface, validate=True)
    count = int.from_bytes(content[80:84], "little") if len(content) >= 84 else -1
    if len(content) != 84 + 50 * count:
        raise ValueError("is not a binary STL")
    corners = np.frombuffer(content, _TRIANGLE, count, 84)["corners"].reshape(-1, 3).astype(float)
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    return Mesh(vertices, index.reshape(-1, 3).astype(np.int32))


def encoded(shape: Mesh) -> str:
    """A mesh as binary STL in base64, coordinates to single precision."""
    triangles = np.zeros(len(shape.faces), _TRIANGLE)
    corners = shape.vertices[shape.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    triangles["normal"] = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-30)[:, None]
    triangles["corners"] = corners
    head = b"seacrane".ljust(80) + len(triangles).to_bytes(4, "little")
    return base64.b64encode(head + triangles.tobytes()).decode("ascii")


def open_edges(shape: Mesh) -> int:
    """How many edges do not lie between two triangles that turn the same way: 0 for a closed surface."""
    start, end = shape.faces.astype(np.int64).ravel(), shape.faces[:, [1, 2, 0]].astype(np.int64).ravel()
    size = len(shape.vertices)
    there, back = start * size + end, end * size + start
    return int(np.count_nonzero(~np.isin(back, there))) + len(there) - len(np.unique(there))


# ---------------------------------------------------------------- surfaces
def _block(centre: tuple[float, float, float], size: tuple[float, float, float]) -> Mesh:
    (x, y, z), (a, b, c) = centre, (0.5 * s for s in size)
    rings = [
        np.array([[u, y - b, z - c], [u, y + b, z - c], [u, y + b, z + c], [u, y - b, z + c]]) for u in (x - a, x + a)
    ]
    return _loft(rings)


def _loft(rings: Sequence[Array]) -> Mesh:
    """The skin over rings (n, 3) one after the other, closed by a fan at both ends; rings turn about the way along."""
    n, count = len(rings[0]), len(rings)
    faces = [face for k in range(count - 1) for face in _band(k * n, (k + 1) * n, n)]
    last = (count - 1) * n
    faces += [(0, i + 1, i) for i in range(1, n - 1)] + [(last, last + i, last + i + 1) for i in range(1, n - 1)]
    return Mesh(np.concatenate(rings), np.array(faces, np.int32))


def _torus(rings: Sequence[Array]) -> Mesh:
    """The skin over rings (n, 3) one after the other, and from the last back to the first."""
    n, count = len(rings[0]), len(rings)
    faces = [face for k in range(count) for face in _band(k * n, (k + 1) % count * n, n)]
    return Mesh(np.concatenate(rings), np.array(faces, np.int32))


def _band(near: int, far: int, n: int) -> list[tuple[int, int, int]]:
    band = []
    for i in range(n):
        j = (i + 1) % n
        band += [(near + i, near + j, far + j), (near + i, far + j, far + i)]
    return band


def _lathe(profile: Sequence[tuple[float, float]]) -> Mesh:
    """A closed profile of (radius, height) turned about z; it runs counter-clockwise with the radius to the right."""
    angles = 2 * math.pi * np.arange(SIDES) / SIDES
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    return _torus([np.column_stack([r * circle, np.full(SIDES, z)]) for r, z in profile])


def _across(turned: Mesh, x: float, z: float) -> Mesh:
    """What was turned about z with its axle across the link, at (x, z)."""
    return turned.moved(np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]), np.array([x, 0.0, z]))


def _at_y(ring: Array, y: float) -> Array:
    return np.column_stack([ring[:, 0], np.full(len(ring), y), ring[:, 1]])


def _inside_out(closed: Mesh) -> Mesh:
    return Mesh(closed.vertices, closed.faces[:, ::-1])
