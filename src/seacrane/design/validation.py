"""What makes a design a crane: every check in one place, for files and for designs built in Python alike.

`examine` walks the data by the types of `seacrane.design.crane`: it turns texts with units into SI by the `Quantity`
of the field and holds every value to the constraints written there. It collects problems and goes on; what it could
not read is left out, and the checks between parts work with what is there.
"""

from __future__ import annotations

import functools
import itertools
import math
import operator
import types
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Final, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from seacrane.design.crane import Crane, Joint
from seacrane.design.geometry import cylinder_range, retracted_length
from seacrane.errors import Problem, UnitError, nearest
from seacrane.units import UNITS, Length, Quantity, compatible, parse

_UNREAD: Final = object()
Tree = dict[str, Any]


def check(crane: Crane) -> list[Problem]:
    """All that is wrong with a crane built in Python; empty if it is sound.

    The same checks as on reading a file, except that every quantity must be a number in SI.
    """
    return examine(_tree(crane), texts=False)[1]


def examine(data: object, *, texts: bool = True) -> tuple[Crane | None, list[Problem]]:
    """The crane in `data` (plain dicts, lists, numbers, texts) and all problems found; no crane if there are any."""
    walk = _Walk(texts)
    tree = walk.value(data, Crane, "")
    problems = walk.problems
    if tree is _UNREAD:
        return None, problems
    skeleton = _duplicates(tree) + _strangers(tree) + _axes(tree)
    problems += skeleton + _parts(tree)
    if skeleton or not walk.complete:
        return None, problems  # there is no chain whose geometry could be looked at
    crane = _build(Crane, tree)
    problems += _strokes(crane)
    return (None, problems) if problems else (crane, [])


def _tree(value: Any) -> Any:
    if isinstance(value, msgspec.Struct):
        return {name: _tree(getattr(value, name)) for name in value.__struct_fields__}
    if isinstance(value, list | tuple):
        return [_tree(item) for item in value]
    return value


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return {name: hint for name, hint in get_type_hints(kind, include_extras=True).items() if name in _fields(kind)}


@functools.cache
def _fields(kind: type) -> dict[str, Any]:
    return {f.name: f for f in msgspec.structs.fields(kind)}


def _peel(annotation: Any) -> tuple[Any, list[Any], bool]:
    """The bare type, all that is annotated on it, and whether None is allowed."""
    extras: list[Any] = []
    optional = False
    while True:
        if get_origin(annotation) is Annotated:
            annotation, *more = get_args(annotation)
            extras += more
        elif get_origin(annotation) in (Union, types.UnionType):
            annotation = next(a for a in get_args(annotation) if a is not type(None))
            optional = True
        else:
            return annotation, extras, optional


def _build(annotation: Any, tree: Any) -> Any:
    kind, _, _ = _peel(annotation)
    if tree is None:
        return None
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        return kind(**{name: _build(_hints(kind)[name], value) for name, value in tree.items()})
    if get_origin(kind) is tuple:
        inner = get_args(kind)
        return tuple(_build(inner[0], item) for item in tree)  # a design has only tuples of one type
    return tree


class _Walk:
    """One pass over the data: SI tree out, problems collected."""

    def __init__(self, texts: bool) -> None:
        self.texts = texts
        self.problems: list[Problem] = []
        self.complete = True

    def unread(self, path: str, message: str, **more: Any) -> object:
        self.problems.append(Problem(path, message, **more))
        self.complete = False
        return _UNREAD

    def value(self, raw: Any, annotation: Any, path: str) -> Any:
        kind, extras, optional = _peel(annotation)
        if raw is None and optional:
            return None
        if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
            return self.record(raw, kind, path)
        if get_origin(kind) is tuple:
            return self.series(raw, kind, extras, path)
        if get_origin(kind) is Literal:
            allowed = get_args(kind)
            if raw not in allowed:
                return self.unread(path, "is none of the known values", value=raw, allowed=", ".join(allowed))
            return raw
        if kind is str:
            return self.text(raw, extras, path)
        return self.number(raw, kind, extras, path)

    def record(self, raw: Any, kind: type[msgspec.Struct], path: str) -> Any:
        if not isinstance(raw, Mapping):
            return self.unread(path, f"must be an object with the fields of a {kind.__name__.lower()}", value=raw)
        hints = dict(_hints(kind))
        if kind is Joint and raw.get("kind") == "prismatic":
            hints["limits"] = tuple[Length, Length] | None
        result: Tree = {}
        for name in raw:
            if name not in hints:
                self.unread(_join(path, str(name)), "is not a field here", hint=nearest(str(name), hints))
        for name, hint in hints.items():
            if name in raw:
                value = self.value(raw[name], hint, _join(path, name))
                if value is not _UNREAD:
                    result[name] = value
            elif _fields(kind)[name].required:
                self.unread(_join(path, name), "is missing" + _about(hint))
        return result

    def series(self, raw: Any, kind: Any, extras: list[Any], path: str) -> Any:
        inner = get_args(kind)
        if not isinstance(raw, Sequence) or isinstance(raw, str):
            return self.unread(path, "must be a list", value=raw)
        if inner[-1] is not Ellipsis and len(raw) != len(inner):
            return self.unread(path, f"must have {len(inner)} entries", value=list(raw))
        least = next((e.min_length for e in extras if isinstance(e, msgspec.Meta) and e.min_length), 0)
        if len(raw) < least:
            return self.unread(path, f"must have at least {least} entry")
        values = [self.value(item, inner[0], f"{path}[{_label(item, i)}]") for i, item in enumerate(raw)]
        fixed = inner[-1] is not Ellipsis
        return _UNREAD if fixed and _UNREAD in values else [v for v in values if v is not _UNREAD]

    def text(self, raw: Any, extras: list[Any], path: str) -> Any:
        if not isinstance(raw, str):
            return self.unread(path, "must be a text", value=raw)
        if any(isinstance(e, msgspec.Meta) and e.min_length for e in extras) and not raw.strip():
            return self.unread(path, "must not be empty")
        return raw

    def number(self, raw: Any, kind: type, extras: list[Any], path: str) -> Any:
        quantity = next((e for e in extras if isinstance(e, Quantity)), Quantity("1"))
        value: float
        if isinstance(raw, str) and self.texts and kind is float:
            try:
                value = parse(raw, quantity.unit, path)
            except UnitError as error:
                return self.refused(error.problems[0], raw, quantity, extras)
        elif isinstance(raw, bool) or not isinstance(raw, int if kind is int else int | float):
            needed = "a whole number" if kind is int else f"a number in {quantity.unit}"
            return self.unread(path, f"must be {needed}" + _about_extras(extras), value=raw)
        else:
            try:
                value = raw if kind is int else float(raw)
            except OverflowError:
                value = math.inf
        if not math.isfinite(value):
            return self.unread(path, "must be a finite number", value=str(raw))
        self.bounds(value, raw, extras, path)
        question = quantity.slip(value)
        if question is not None:
            self.problems.append(Problem(path, "is implausible", value=raw, hint=question))
        return value

    def refused(self, problem: Problem, raw: str, quantity: Quantity, extras: list[Any]) -> object:
        symbol = raw.strip().lstrip("+-.0123456789eE").strip()
        message = problem.message
        if symbol in UNITS and not compatible(symbol, quantity.unit):
            message = f"cannot be given in {symbol!r}" + _about_extras(extras)
        return self.unread(problem.path, message, value=raw, allowed=problem.allowed, hint=problem.hint)

    def bounds(self, value: float, raw: Any, extras: list[Any], path: str) -> None:
        for meta in (e for e in extras if isinstance(e, msgspec.Meta)):
            for limit, holds, words in (
                (meta.gt, operator.gt, "above"),
                (meta.ge, operator.ge, "at least"),
                (meta.lt, operator.lt, "below"),
                (meta.le, operator.le, "at most"),
            ):
                if limit is not None and not holds(value, limit):
                    self.problems.append(Problem(path, f"must be {words} {limit:g}" + _about_extras(extras), value=raw))


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name


def _label(item: Any, index: int) -> str:
    name = item.get("name") if isinstance(item, Mapping) else None
    return name if isinstance(name, str) and name else str(index)


def _about(annotation: Any) -> str:
    return _about_extras(_peel(annotation)[1])


def _about_extras(extras: list[Any]) -> str:
    words = next((e.description for e in extras if isinstance(e, msgspec.Meta) and e.description), "")
    quantity = next((e for e in extras if isinstance(e, Quantity)), None)
    symbol = f"[{quantity.unit}]" if quantity is not None and quantity.unit != "1" else ""
    text = " ".join(part for part in (words, symbol) if part)
    return f": {text}" if text else ""


# ---------------------------------------------------------------- between the parts
def _named(tree: Tree, group: str) -> Iterator[tuple[str, Tree]]:
    for index, item in enumerate(tree.get(group, ())):
        yield f"{group}[{_label(item, index)}]", item


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
    return [
        Problem(group, f"{name!r} is the name of two {kind}")
        for group, kind, names in (
            ("links", "links", links),
            ("links", "joints", joints),
            ("cylinders", "cylinders", cylinders),
        )
        for name in sorted(set(names))
        if names.count(name) > 1
    ]


def _strangers(tree: Tree) -> list[Problem]:
    """Names that lead nowhere: attachments on unknown links, cylinders and slewing on unknown joints."""
    links, joints = _names(tree)
    found = [
        Problem(
            f"{path}.link",
            "is on a link that the crane does not have",
            value=at["link"],
            hint=nearest(at["link"], links),
        )
        for path, at in _references(tree)
        if "link" in at and at["link"] not in links
    ]
    moved = [(f"{path}.moves", cylinder.get("moves")) for path, cylinder in _named(tree, "cylinders")]
    moved.append(("slew.joint", tree.get("slew", {}).get("joint")))
    found += [
        Problem(path, "moves a joint that the crane does not have", value=joint, hint=nearest(joint, joints))
        for path, joint in moved
        if joint is not None and joint not in joints
    ]
    return found


def _axes(tree: Tree) -> list[Problem]:
    joints = ((f"{path}.joint.axis", link.get("joint", {}).get("axis")) for path, link in _named(tree, "links"))
    return [
        Problem(path, "has no direction", value=axis, allowed="any vector but zero")
        for path, axis in joints
        if axis is not None and not any(axis)
    ]


def _parts(tree: Tree) -> list[Problem]:
    problems: list[Problem] = []
    for path, link in _named(tree, "links"):
        problems += _inertia(f"{path}.inertia", link.get("inertia"))
        problems += _joint(f"{path}.joint", link.get("joint", {}))
    for path, cylinder in _named(tree, "cylinders"):
        if cylinder.get("rod", 0.0) >= cylinder.get("bore", math.inf):
            problems.append(
                Problem(
                    f"{path}.rod", "must be thinner than the bore", cylinder["rod"], f"below {cylinder['bore']:g} m"
                )
            )
        problems += _between(tree, path, cylinder)
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
        symbol = "m" if joint.get("kind") == "prismatic" else "rad"
        return [
            Problem(
                f"{path}.limits",
                f"the lower limit must be below the upper [{symbol}]",
                limits,
                hint="Are they reversed?",
            )
        ]
    return []


def _between(tree: Tree, path: str, cylinder: Tree) -> list[Problem]:
    """A cylinder turns the joint it moves only if that joint lies between its two pins."""
    chain = [(link.get("name"), link.get("joint", {}).get("name")) for _, link in _named(tree, "links")]
    place = {name: i for i, (name, _) in enumerate(chain)}
    base, eye = (place.get(cylinder.get(end, {}).get("link")) for end in ("base", "eye"))
    moved = next((i for i, (_, joint) in enumerate(chain) if joint == cylinder.get("moves")), None)
    if moved is None or base is None or eye is None:
        return []
    spanned = [joint for _, joint in chain[min(base, eye) + 1 : max(base, eye) + 1]]
    if chain[moved][1] in spanned:
        return []
    return [
        Problem(
            f"{path}.moves",
            "the pins are not on both sides of the joint it moves",
            value=cylinder["moves"],
            allowed=", ".join(map(str, spanned)) or "none: both pins are on one link",
        )
    ]


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
        shortest, longest = cylinder_range(crane, cylinder)
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
