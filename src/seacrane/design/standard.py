"""Parts for a crane that has none yet: what an engineer would expect between its joints, pins and sheaves.

Girders taper from the heel to where the cylinder pushes and on to the end, columns are tubes, pins sit in pairs of eye
plates, sheaves are twenty rope diameters across. The plates are as thick as makes the link weigh what the design says,
between 6 and 80 mm. A start for a designer to draw on, not a strength calculation.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import msgspec

from seacrane.design.crane import Attachment, Crane, Cylinder, Link
from seacrane.design.mass import of_part
from seacrane.design.parts import Box, Drum, Girder, Lug, Part, Sheave, Station, Tube

_THINNEST, _THICKEST = 0.006, 0.080
"""Plates of cranes [m]."""


def furnished(crane: Crane) -> Crane:
    """The crane with standard parts in every link that has none; masses stay those of the design."""
    return msgspec.structs.replace(
        crane, links=tuple(link if link.parts else _built(crane, i) for i, link in enumerate(crane.links))
    )


def _built(crane: Crane, index: int) -> Link:
    link = crane.links[index]
    start, end = _ends(crane, index)
    upright = abs(end[1] - start[1]) > abs(end[0] - start[0])
    fittings = [*_lugs(crane, link, start, end), *_rope(crane, link, start, end)]
    if upright and index == 0:
        fittings += _upper_works(crane, end[1])
    body = (_column if upright else _girder)(crane, link, start, end)
    rest = sum(of_part(part).mass for part in fittings)
    return msgspec.structs.replace(link, parts=(_weighing(body, link.mass - rest), *fittings))


def _ends(crane: Crane, index: int) -> tuple[tuple[float, float], tuple[float, float]]:
    """Where the body of a link begins and ends (x, z), in its frame."""
    link = crane.links[index]
    if index + 1 < len(crane.links):
        x, _, z = crane.links[index + 1].joint.origin
    else:
        x, z = crane.hoist.sheaves[-1].x, crane.hoist.sheaves[-1].z
    if link.joint.kind == "revolute":
        return (0.0, 0.0), (x, z)
    travel = link.joint.limits[1] - link.joint.limits[0] if link.joint.limits else 1.0
    return (x - 1.1 * travel, z), (x, z)


def _scale(crane: Crane) -> float:
    """Length of all links together [m], for the size of what no link determines."""
    ends = [_ends(crane, i) for i in range(len(crane.links))]
    return sum(math.hypot(x1 - x0, z1 - z0) for (x0, z0), (x1, z1) in ends)


def _column(crane: Crane, link: Link, start: tuple[float, float], end: tuple[float, float]) -> Tube:
    diameter = max(0.075 * _scale(crane), 0.3 * abs(end[1] - start[1]))
    return Tube(
        name=link.name,
        start=(start[0], 0.0, start[1]),
        end=(end[0], 0.0, end[1]),
        diameter=diameter,
        end_diameter=0.75 * diameter,
        thickness=_THINNEST,
    )


def _girder(crane: Crane, link: Link, start: tuple[float, float], end: tuple[float, float]) -> Girder:
    """Deepest where its own cylinder pushes; a sliding section is slim and even."""
    length = end[0] - start[0]
    eye = next((c.eye.x for c in crane.cylinders if c.eye.link == link.name and c.moves == link.joint.name), None)
    slides = link.joint.kind == "prismatic"
    push = min(max((eye - start[0]) / length if eye is not None else 0.35, 0.2), 0.6)
    depth = min(length, 0.6 * _scale(crane)) * (0.6 if slides else 1.0)
    shape = (
        [(0.0, 0.028, 0.028), (1.0, 0.028, 0.028)]
        if slides
        else [
            (-0.03, 0.024, 0.024),
            (0.03, 0.034, 0.030),
            (push, 0.056, 0.034),
            (0.8, 0.046, 0.034),
            (1.0, 0.026, 0.026),
        ]
    )
    stations = []
    for along, top, bottom in shape:
        axis = start[1] + (end[1] - start[1]) * min(max(along, 0.0), 1.0)
        stations.append(
            Station(
                x=start[0] + along * length,
                top=axis + top * depth,
                bottom=axis - bottom * depth,
                width=0.075 * depth * (1.0 - 0.15 * max(along, 0.0)),
            )
        )
    return Girder(name=link.name, stations=tuple(stations), thickness=_THINNEST)


def _weighing(body: Girder | Tube, mass: float) -> Girder | Tube:
    """The body with plates as thick as makes it weigh `mass` [kg], as far as plates of cranes go."""
    smallest = (
        min(min(s.top - s.bottom, s.width) for s in body.stations)
        if isinstance(body, Girder)
        else min(body.diameter, body.end_diameter)
    )
    low, high = min(_THINNEST, 0.2 * smallest), min(_THICKEST, 0.4 * smallest)
    for _ in range(40):
        middle = 0.5 * (low + high)
        if of_part(msgspec.structs.replace(body, thickness=middle)).mass < mass:
            low = middle
        else:
            high = middle
    return msgspec.structs.replace(body, thickness=round(high, 6))


def _lugs(crane: Crane, link: Link, start: tuple[float, float], end: tuple[float, float]) -> Iterator[Lug]:
    for cylinder in crane.cylinders:
        for pin in (cylinder.base, cylinder.eye):
            if pin.link == link.name:
                for side in range(cylinder.count):
                    yield _lug(cylinder, pin, side, start, end)


def _lug(cylinder: Cylinder, pin: Attachment, side: int, start: tuple[float, float], end: tuple[float, float]) -> Lug:
    """Eye plates on the way from the pin to the nearest point of the link's axis."""
    root_x, root_z = _root(pin, start, end)
    gap = 1.1 * cylinder.bore
    number = "" if cylinder.count == 1 else f" {side + 1}"
    return Lug(
        name=f"{cylinder.name} {'base' if pin is cylinder.base else 'eye'}{number}",
        x=pin.x,
        z=pin.z,
        root_x=root_x,
        root_z=root_z,
        root_width=2.4 * cylinder.bore,
        radius=0.55 * cylinder.bore,
        hole=0.5 * cylinder.bore,
        thickness=0.12 * cylinder.bore,
        gap=gap,
        y=(side - 0.5 * (cylinder.count - 1)) * 1.6 * gap,
    )


def _root(pin: Attachment, start: tuple[float, float], end: tuple[float, float]) -> tuple[float, float]:
    """The point of the link's axis nearest to a pin."""
    dx, dz = end[0] - start[0], end[1] - start[1]
    along = ((pin.x - start[0]) * dx + (pin.z - start[1]) * dz) / math.hypot(dx, dz) ** 2
    along = min(max(along, 0.0), 1.0)
    return start[0] + along * dx, start[1] + along * dz


def _bearer(
    name: str, pin: Attachment, size: float, gap: float, start: tuple[float, float], end: tuple[float, float]
) -> Iterator[Lug]:
    """A plate to either side, from the link's axis to a pin of a sheave or drum of this size [m] that stands off it."""
    root_x, root_z = _root(pin, start, end)
    if math.hypot(pin.x - root_x, pin.z - root_z) > 0.6 * size:
        yield Lug(
            name=f"{name} bracket",
            x=pin.x,
            z=pin.z,
            root_x=root_x,
            root_z=root_z,
            root_width=1.8 * size,
            radius=0.4 * size,
            hole=0.25 * size,
            thickness=0.05 * size,
            gap=gap,
        )


def _rope(crane: Crane, link: Link, start: tuple[float, float], end: tuple[float, float]) -> Iterator[Part]:
    hoist = crane.hoist
    d = hoist.rope.diameter
    for number, pin in enumerate(hoist.sheaves, 1):
        if pin.link == link.name:
            yield Sheave(
                name=f"sheave {number}", x=pin.x, z=pin.z, radius=10 * d, groove=1.5 * d, width=2.2 * d, hole=2.5 * d
            )
            yield from _bearer(f"sheave {number}", pin, 10 * d, 3 * d, start, end)
    if hoist.drum.link == link.name:
        r = hoist.drum_radius
        yield from _bearer("drum", hoist.drum, r, 2.8 * r, start, end)
        yield Drum(
            name="drum", x=hoist.drum.x, z=hoist.drum.z, radius=r, length=2.6 * r, flange=1.5 * r, thickness=0.06 * r
        )


def _upper_works(crane: Crane, height: float) -> Iterator[Box]:
    """Cabin on the starboard side, machinery house behind."""
    size = min(max(0.06 * _scale(crane), 0.9), 2.2)
    yield Box(
        name="cabin",
        centre=(0.6 * size, -1.4 * size, 0.55 * height),
        size=(1.1 * size, 0.9 * size, 1.2 * size),
        thickness=0.006,
    )
    yield Box(
        name="machinery house",
        centre=(-1.5 * size, 0.0, 0.35 * height),
        size=(1.4 * size, 1.6 * size, 0.9 * size),
        thickness=0.006,
    )
