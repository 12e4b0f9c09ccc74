"""Changes that keep a crane whole: a longer link, another pin, a bore with the stroke that it then needs."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import Final

import msgspec

from seacrane.design.crane import Attachment, Crane, Cylinder, Link
from seacrane.design.geometry import cylinder_range
from seacrane.errors import DesignError, nearest

_PATH: Final = re.compile(r"(links|cylinders)\[([^\]]+)\]\.(length|bore|rod|base\.x|base\.z|eye\.x|eye\.z)")

PATHS: Final = "links[NAME].length, cylinders[NAME].bore|rod|base.x|base.z|eye.x|eye.z"
"""What can be changed, by its path in the design."""


def changed(crane: Crane, values: Mapping[str, float]) -> Crane:
    """The crane with new values [m] by path, see `PATHS`; the strokes of its cylinders are then made to fit.

    A rod keeps its share of the bore unless it is given. `DesignError` with the nearest paths for one that is unknown.
    """
    # a longer link takes its outer pins along, a wider bore its rod: what is given itself is set after them
    for path, value in sorted(values.items(), key=_rank):
        crane = _set(crane, path, value)
    return fitted(crane)


def value(crane: Crane, path: str) -> float:
    """What stands at a path now [m]."""
    group, name, field = _parsed(crane, path)
    if group == "links":
        return length(crane, name)
    cylinder = crane.cylinder(name)
    if "." in field:
        end, axis = field.split(".")
        return float(getattr(getattr(cylinder, end), axis))
    return float(getattr(cylinder, field))


def length(crane: Crane, link: str) -> float:
    """Length of a link along its x: to the next joint, or to the tip sheave [m]."""
    index = [item.name for item in crane.links].index(link)
    if index + 1 < len(crane.links):
        return crane.links[index + 1].joint.origin[0]
    return crane.hoist.sheaves[-1].x


def fitted(crane: Crane) -> Crane:
    """The crane with each cylinder's stroke as long as its joint's limits ask for, and its closed length open."""

    def fit(cylinder: Cylinder) -> Cylinder:
        shortest, longest = cylinder_range(crane, cylinder)
        return msgspec.structs.replace(cylinder, stroke=max(longest - shortest, 1e-3) * (1 + 1e-9), retracted=None)

    return msgspec.structs.replace(crane, cylinders=tuple(fit(cylinder) for cylinder in crane.cylinders))


def lengthened(crane: Crane, name: str, new: float) -> Crane:
    """The crane with one link longer or shorter along its x [m], of the same section.

    What is beyond the middle of the link moves with its end; mass grows with the length, the centre of mass stays at
    its share of it, moments of inertia across the link grow with its cube. Parts are left out: they are made anew.
    """
    old = length(crane, name)
    if not (old > 0 and new > 0):
        raise DesignError.at(f"links[{name}].length", "can be changed only for a link along its x", value=new)
    ratio = new / old

    def moved(at: Attachment) -> Attachment:
        far = at.link == name and at.x > 0.5 * old
        return msgspec.structs.replace(at, x=at.x + new - old) if far else at

    def grown(link: Link) -> Link:
        x, y, z = link.com
        along, across, up = link.inertia
        return msgspec.structs.replace(
            link,
            mass=link.mass * ratio,
            com=(x * ratio, y, z),
            inertia=(along * ratio, across * ratio**3, up * ratio**3),
            parts=(),
        )

    links, before = [], None
    for link in crane.links:
        if before == name:
            _, y, z = link.joint.origin
            link = msgspec.structs.replace(link, joint=msgspec.structs.replace(link.joint, origin=(new, y, z)))
        links.append(grown(link) if link.name == name else link)
        before = link.name
    cylinders = tuple(msgspec.structs.replace(c, base=moved(c.base), eye=moved(c.eye)) for c in crane.cylinders)
    hoist = msgspec.structs.replace(
        crane.hoist, drum=moved(crane.hoist.drum), sheaves=tuple(moved(sheave) for sheave in crane.hoist.sheaves)
    )
    return msgspec.structs.replace(crane, links=tuple(links), cylinders=cylinders, hoist=hoist)


def _rank(change: tuple[str, float]) -> int:
    path, _ = change
    return 0 if path.endswith(".length") else 1 if path.endswith(".bore") else 2


def _parsed(crane: Crane, path: str) -> tuple[str, str, str]:
    match = _PATH.fullmatch(path)
    if match is None:
        raise DesignError.at(path, "is not a size that can be changed", allowed=PATHS)
    group, name, field = match.groups()
    known = [item.name for item in (crane.links if group == "links" else crane.cylinders)]
    if name not in known:
        raise DesignError.at(path, f"the crane has no such {group[:-1]}", value=name, hint=nearest(name, known))
    return group, name, field


def _set(crane: Crane, path: str, new: float) -> Crane:
    group, name, field = _parsed(crane, path)
    if group == "links":
        return lengthened(crane, name, new)
    return msgspec.structs.replace(
        crane, cylinders=tuple(_resized(c, field, new) if c.name == name else c for c in crane.cylinders)
    )


def _resized(cylinder: Cylinder, field: str, new: float) -> Cylinder:
    replace: Callable[..., Cylinder] = msgspec.structs.replace
    if field == "bore":
        return replace(cylinder, bore=new, rod=cylinder.rod * new / cylinder.bore)
    if field == "rod":
        return replace(cylinder, rod=new)
    end, axis = field.split(".")
    pin = msgspec.structs.replace(getattr(cylinder, end), **{axis: new})
    return replace(cylinder, **{end: pin})
