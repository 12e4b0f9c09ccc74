"""What makes a design a crane: every check in one place, for files and for designs built in Python alike.

Three passes, which together report all there is to mend: `walk` holds every value to its type, unit and bounds; the
checks between parts (names, inertia, limits, capacity) work with what could be read; the geometry of the cylinders is
looked at last, on a whole crane.
"""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Iterable, Iterator
from typing import Final

import numpy as np

from seacrane.design import mass
from seacrane.design.crane import FOOT, Crane
from seacrane.design.geometry import cylinder_range, retracted_length
from seacrane.design.mesh import decoded, open_edges
from seacrane.design.walk import UNREAD, Tree, Walk, build, label, plain
from seacrane.errors import Problem, nearest
from seacrane.units import deg

_FARTHEST: Final = 1000.0
"""A chain of links longer than this [m] is no crane."""

_SHORTEST_AXIS: Final = 1e-6
"""An axis shorter than this, or longer than its inverse, is a mistake rather than a direction."""


def check(crane: Crane) -> list[Problem]:
    """All that is wrong with a crane built in Python; empty if it is sound.

    The same checks as on reading a file, except that every quantity must be a number in SI.
    """
    return examine(plain(crane), texts=False)[1]


def examine(data: object, *, texts: bool = True) -> tuple[Crane | None, list[Problem]]:
    """The crane in `data` (plain dicts, lists, numbers, texts) and all problems found; no crane if there are any."""
    walk = Walk(texts)
    tree = walk.value(data, Crane, "")
    problems = walk.problems
    if tree is UNREAD:
        return None, problems
    skeleton = _duplicates(tree) + _strangers(tree) + _axes(tree)
    problems += skeleton + _parts(tree)
    if skeleton or not walk.complete:
        return None, problems  # there is no chain whose geometry could be looked at
    crane = build(Crane, tree)
    problems += _strokes(crane)
    return (None, problems) if problems else (crane, [])


# ---------------------------------------------------------------- between the parts
def _named(tree: Tree, group: str) -> Iterator[tuple[str, Tree]]:
    for index, item in enumerate(tree.get(group, ())):
        yield f"{group}[{label(item, index)}]", item


def _names(tree: Tree) -> tuple[list[str], list[str]]:
    links = [link for _, link in _named(tree, "links")]
    return (
        [link["name"] for link in links if "name" in link],
        [link["joint"]["name"] for link in links if "name" in link.get("joint", {})],
    )


def _references(tree: Tree) -> Iterator[tuple[str, Tree]]:
    """Every attachment with its path."""
    for path, cylinder in _named(tree, "cylinders"):
        for end in ("base", "eye"):
            yield f"{path}.{end}", cylinder.get(end, {})
    hoist = tree.get("hoist", {})
    yield "hoist.drum", hoist.get("drum", {})
    for index, sheave in enumerate(hoist.get("sheaves", ())):
        yield f"hoist.sheaves[{index}]", sheave


def _duplicates(tree: Tree) -> list[Problem]:
    links, joints = _names(tree)
    cylinders = [c["name"] for _, c in _named(tree, "cylinders") if "name" in c]
    return [Problem("links", f"{FOOT!r} is the ship's side of the first joint and cannot be a link")] * (
        FOOT in links
    ) + [
        Problem(group, f"{name!r} is the name of two {kind}")
        for group, kind, names in (
            ("links", "links", links),
            ("links", "joints", joints),
            ("cylinders", "cylinders", cylinders),
        )
        for name in _twice(names)
    ]


def _twice(names: Iterable[str]) -> list[str]:
    return sorted(name for name, count in Counter(names).items() if count > 1)


def _strangers(tree: Tree) -> list[Problem]:
    """Names that lead nowhere: attachments on unknown links, cylinders and slewing on unknown joints."""
    if "links" not in tree:
        return []  # that they cannot be read is said already
    links, joints = _names(tree)
    found = [
        Problem(
            f"{path}.link",
            "is on a link that the crane does not have",
            value=at["link"],
            hint=nearest(at["link"], links),
        )
        for path, at in _references(tree)
        if "link" in at and at["link"] not in (FOOT, *links)
    ]
    moved = [(f"{path}.moves", cylinder.get("moves")) for path, cylinder in _named(tree, "cylinders")]
    moved.append(("slew.joint", (tree.get("slew") or {}).get("joint")))
    found += [
        Problem(path, "moves a joint that the crane does not have", value=joint, hint=nearest(joint, joints))
        for path, joint in moved
        if joint is not None and joint not in joints
    ]
    found += [
        Problem(
            f"rating.{path}.joint",
            "is not a joint of the crane",
            value=item["joint"],
            hint=nearest(item["joint"], joints),
        )
        for path, item in _named(tree.get("rating") or {}, "structure")
        if "joint" in item and item["joint"] not in joints
    ]
    return found


def _axes(tree: Tree) -> list[Problem]:
    joints = ((f"{path}.joint.axis", link.get("joint", {}).get("axis")) for path, link in _named(tree, "links"))
    return [
        Problem(path, "has no direction", value=axis, allowed="any vector but zero, best of length 1")
        for path, axis in joints
        if axis is not None and not _SHORTEST_AXIS <= math.hypot(*axis) <= 1 / _SHORTEST_AXIS
    ]


def _parts(tree: Tree) -> list[Problem]:
    problems: list[Problem] = []
    moved: list[str] = []
    for path, link in _named(tree, "links"):
        problems += _inertia(f"{path}.inertia", link.get("inertia"))
        problems += _joint(f"{path}.joint", link.get("joint", {}))
        problems += _shapes(path, link)
    for path, cylinder in _named(tree, "cylinders"):
        if cylinder.get("rod", 0.0) >= cylinder.get("bore", math.inf):
            problems.append(
                Problem(
                    f"{path}.rod", "must be thinner than the bore", cylinder["rod"], f"below {cylinder['bore']:g} m"
                )
            )
        misplaced = _between(tree, path, cylinder)
        problems += misplaced
        if not misplaced and "moves" in cylinder:
            moved.append(cylinder["moves"])
    problems += [
        # How two sets would share the moment of one joint is not statically determined.
        Problem("cylinders", f"{joint!r} is moved by two sets", hint="Cylinders side by side are one, with a `count`.")
        for joint in _twice(moved)
    ]
    problems += _reach(tree)
    for name in _twice(f"hs{height:.1f}" for height in (tree.get("rating") or {}).get("wave_heights") or ()):
        problems.append(Problem("rating.wave_heights", f"two of them are the mode {name!r}"))
    sheaves = tree.get("hoist", {}).get("sheaves") or [{}]
    links, _ = _names(tree)
    if links and sheaves[-1].get("link", links[-1]) in links[:-1]:
        problems.append(
            Problem(
                "hoist.sheaves",
                "the last sheave is the tip and must be on the last link",
                sheaves[-1]["link"],
                links[-1],
            )
        )
    radii = [point["radius"] for point in tree.get("capacity", ()) if "radius" in point]
    if any(b <= a for a, b in itertools.pairwise(radii)):
        problems.append(Problem("capacity", "the radius must grow from point to point", value=radii))
    return problems


def _inertia(path: str, inertia: list[float] | None) -> list[Problem]:
    if inertia is None:
        return []
    if min(inertia) <= 0:
        return [Problem(path, "every moment of inertia must be above 0 kg.m2", value=inertia)]
    smallest, middle, largest = sorted(inertia)
    if largest > (smallest + middle) * (1 + 1e-9):
        return [
            Problem(
                path,
                "no body has these moments of inertia: the largest exceeds the sum of the others",
                value=inertia,
                allowed=f"largest at most {smallest + middle:g} kg.m2",
            )
        ]
    return []


def _joint(path: str, joint: Tree) -> list[Problem]:
    limits = joint.get("limits")
    if limits is not None and limits[0] >= limits[1]:
        unit, symbol = (1.0, "m") if joint.get("kind") == "prismatic" else (deg, "deg")
        shown = f"{limits[0] / unit:.6g} to {limits[1] / unit:.6g} {symbol}"
        return [Problem(f"{path}.limits", "the lower limit must be below the upper", shown, hint="Are they reversed?")]
    return []


def _shapes(path: str, link: Tree) -> Iterator[Problem]:
    """Parts that cannot be built as they are drawn: plates thicker than the part, eyes wider than their plate."""
    for name in _twice(part["name"] for _, part in _named(link, "parts") if "name" in part):
        yield Problem(f"{path}.parts", f"{name!r} is the name of two parts")
    for at, part in _named(link, "parts"):
        for field, most, what in _bounds_of(part):
            value = part.get(field)
            if value is not None and math.isfinite(most) and not value < most:
                yield Problem(f"{path}.{at}.{field}", f"must be less than {what}", value, f"below {most:.4g} m")
        stations = part.get("stations", ())
        places = [s["x"] for s in stations if "x" in s]
        if any(b <= a for a, b in itertools.pairwise(places)):
            yield Problem(f"{path}.{at}.stations", "x must grow from station to station", value=places)
        for number, station in enumerate(stations):
            if station.get("top", math.inf) <= station.get("bottom", -math.inf):
                yield Problem(f"{path}.{at}.stations[{number}].top", "must be above the bottom", station["top"])
        if part.get("start") is not None and part.get("start") == part.get("end"):
            yield Problem(f"{path}.{at}.end", "is where the tube starts", value=part["end"])
        if part.get("kind") == "mesh" and "surface" in part:
            yield from _surface(f"{path}.{at}.surface", part["surface"])
        if min(part.get("size", (1.0,))) <= 0:
            yield Problem(f"{path}.{at}.size", "must be above 0 m along every axis", value=part["size"])


def _surface(path: str, surface: str) -> Iterator[Problem]:
    try:
        shape = decoded(surface)
    except ValueError:
        yield Problem(path, "is not a binary STL in base64")
        return
    if not (len(shape.faces) and np.isfinite(shape.vertices).all()):
        yield Problem(path, "has no triangles, or corners that are not finite")
    elif edges := open_edges(shape):
        yield Problem(path, f"is not closed, so it has no mass: {edges} edges are open or turned the wrong way")
    elif not 0 < mass.volume(shape) < math.inf:
        yield Problem(path, "is inside out or encloses no volume, so it has no mass")


def _bounds_of(part: Tree) -> Iterator[tuple[str, float, str]]:
    """Fields of a part with what they must stay below, and its name."""
    nan = math.nan
    kind = part.get("kind")
    if kind == "girder":
        sizes = [s.get("width", nan) for s in part.get("stations", ())]
        sizes += [s.get("top", nan) - s.get("bottom", nan) for s in part.get("stations", ())]
        yield "thickness", 0.5 * min(sizes, default=nan), "half of the narrowest section"
        places = [s.get("x", nan) for s in part.get("stations", ())]
        yield "thickness", 0.5 * (places[-1] - places[0]) if places else nan, "half of the length"
    elif kind == "tube":
        yield "thickness", 0.5 * min(part.get("diameter", nan), part.get("end_diameter", nan)), "the radius"
    elif kind == "lug":
        yield "hole", 2 * part.get("radius", nan), "the plate about it"
    elif kind == "sheave":
        yield "groove", part.get("radius", nan) - 0.5 * part.get("hole", nan), "what is left about the pin"
        yield "hole", 2 * part.get("radius", nan), "the sheave"
    elif kind == "drum":
        yield (
            "thickness",
            min(part.get("radius", nan), 0.5 * part.get("length", nan)),
            "the barrel's radius, half its length",
        )
        yield "radius", part.get("flange", nan), "that of the flanges"
    elif kind == "box":
        yield "thickness", 0.5 * min(part.get("size", (nan,))), "half of the shortest side"


def _between(tree: Tree, path: str, cylinder: Tree) -> list[Problem]:
    """A cylinder moves one joint: the only one between its two pins.

    Over several joints its length would depend on all of them, and so would what it bears of each.
    """
    chain = [(link.get("name"), link.get("joint", {}).get("name")) for _, link in _named(tree, "links")]
    place = {FOOT: -1} | {name: i for i, (name, _) in enumerate(chain)}
    base, eye = (place.get(cylinder.get(end, {}).get("link")) for end in ("base", "eye"))
    moved = next((i for i, (_, joint) in enumerate(chain) if joint == cylinder.get("moves")), None)
    if moved is None or base is None or eye is None:
        return []
    spanned = [joint for _, joint in chain[min(base, eye) + 1 : max(base, eye) + 1]]
    if spanned == [chain[moved][1]]:
        return []
    if chain[moved][1] in spanned:
        across = ", ".join(map(str, spanned))
        return [
            Problem(
                path,
                f"has more than one joint between its pins: {across}",
                allowed=f"only {cylinder['moves']}",
                hint="Put both pins on the links that this joint connects.",
            )
        ]
    return [
        Problem(
            f"{path}.moves",
            "the pins are not on both sides of the joint it moves",
            value=cylinder["moves"],
            allowed=", ".join(map(str, spanned)) or "none: both pins are on one link",
        )
    ]


def _reach(tree: Tree) -> list[Problem]:
    """The chain stretched out, with every slide at its farther end."""
    joints = [link.get("joint", {}) for _, link in _named(tree, "links")]
    length = sum(math.hypot(*joint.get("origin", ())) for joint in joints)
    slides = (joint.get("limits") for joint in joints if joint.get("kind") == "prismatic")
    length += sum(max(map(abs, limits)) for limits in slides if limits)
    tip = (tree.get("hoist", {}).get("sheaves") or [{}])[-1]
    length += math.hypot(tip.get("x", 0.0), tip.get("z", 0.0))
    if length <= _FARTHEST:
        return []
    return [Problem("links", "are longer together than any crane", f"{length:.4g} m", f"at most {_FARTHEST:g} m")]


def _strokes(crane: Crane) -> list[Problem]:
    """Whether each cylinder can follow its joint from limit to limit, and be built."""
    problems = []
    joints = {joint.name: joint for joint in crane.joints}
    for cylinder in crane.cylinders:
        path = f"cylinders[{cylinder.name}]"
        limits = joints[cylinder.moves].limits
        if limits is None:
            problems.append(
                Problem(
                    f"{path}.moves", "a cylinder cannot move an endless joint", cylinder.moves, "a joint with limits"
                )
            )
            continue
        if limits[0] >= limits[1]:
            continue  # said already
        with np.errstate(over="ignore", invalid="ignore"):
            shortest, longest = cylinder_range(crane, cylinder)
        if not math.isfinite(longest - shortest):
            problems.append(Problem(path, "its pins are too far apart for any crane"))
            continue
        if longest - shortest < 1e-9:
            continue  # both pins on one side of the joint: said already
        travel = f"the pins are {shortest:.4g} to {longest:.4g} m apart over the joint's limits"
        if longest - shortest > cylinder.stroke:
            problems.append(
                Problem(
                    f"{path}.stroke",
                    f"is too short for the joint's limits: {travel}",
                    value=cylinder.stroke,
                    allowed=f"at least {longest - shortest:.4g} m",
                    hint="Give a longer stroke, narrower limits of the joint, or other pins.",
                )
            )
            continue
        retracted = retracted_length(crane, cylinder)
        least, most = longest - cylinder.stroke, shortest
        if not least - 1e-9 <= retracted <= most + 1e-9:
            problems.append(
                Problem(
                    f"{path}.retracted",
                    f"does not let the joint reach its limits: {travel}",
                    value=retracted,
                    allowed=f"{least:.4g} to {most:.4g} m",
                )
            )
        if retracted < cylinder.stroke + cylinder.bore:
            problems.append(
                Problem(
                    f"{path}.retracted",
                    "cannot be built: piston, head and eyes need about one bore beyond the stroke",
                    value=round(retracted, 4),
                    allowed=f"at least {cylinder.stroke + cylinder.bore:.4g} m",
                )
            )
    return problems
