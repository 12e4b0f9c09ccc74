"""Reading plain data by the types of the design: units, constraints and shapes, problem by problem.

The types say everything: the `Quantity` of a field its unit, the `msgspec.Meta` beside it its bounds and what it is.
"""

from __future__ import annotations

import functools
import math
import operator
import re
import types
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Literal, Union, get_args, get_origin, get_type_hints

import msgspec

from seacrane.design.crane import Joint
from seacrane.errors import Problem, UnitError, nearest
from seacrane.units import UNITS, Length, Quantity, compatible, in_unit, labelled, parse, with_unit

_KIND: Final = "kind"
"""The field that says which of several records one is."""

MOST_ITEMS: Final = 1000
"""Longest list, unless its field says otherwise."""

_BEYOND: Final = 1e15
"""No number of a crane in SI is as large."""

_NO_TEXT: Final = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")
"""Characters that are not for reading, and that XML cannot hold."""

UNREAD: Final = object()
"""Stands for what could not be read."""

Tree = dict[str, Any]
"""What could be read of a record: its fields in SI, in dicts and lists."""


def plain(value: Any) -> Any:
    """Records as dicts and tuples as lists, as they would stand in a file."""
    if isinstance(value, msgspec.Struct):
        tag = {_KIND: value.__struct_config__.tag} if value.__struct_config__.tag else {}
        return tag | {name: plain(getattr(value, name)) for name in value.__struct_fields__}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value


def _tag(record: type[msgspec.Struct]) -> str:
    return str(record.__struct_config__.tag)


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
            some = [a for a in get_args(annotation) if a is not type(None)]
            optional = len(some) < len(get_args(annotation))
            if len(some) > 1:
                return {_tag(record): record for record in some}, extras, optional
            annotation = some[0]
        else:
            return annotation, extras, optional


def build(annotation: Any, tree: Any) -> Any:
    """The value of this type from what was read completely."""
    kind, _, _ = _peel(annotation)
    if tree is None:
        return None
    if isinstance(kind, dict):
        kind = kind[tree[_KIND]]
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        hints = _hints(kind)
        return kind(**{name: build(hints[name], value) for name, value in tree.items() if name in hints})
    if get_origin(kind) is tuple:
        inner = get_args(kind)
        return tuple(build(inner[0], item) for item in tree)  # a design has only tuples of one type
    return tree


class Walk:
    """One pass over the data. It leaves out what it cannot read, notes every problem and goes on.

    `complete` stays true while everything could be read, be it out of bounds.
    """

    def __init__(self, texts: bool) -> None:
        self.texts = texts
        self.problems: list[Problem] = []
        self.complete = True

    def unread(self, path: str, message: str, **more: Any) -> object:
        self.problems.append(Problem(path, message, **more))
        self.complete = False
        return UNREAD

    def value(self, raw: Any, annotation: Any, path: str) -> Any:
        """`raw` read as a value of the annotated type, in SI; `UNREAD` if that cannot be."""
        kind, extras, optional = _peel(annotation)
        if raw is None and optional:
            return None
        if isinstance(kind, dict):
            return self.variant(raw, kind, path)
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
                if value is not UNREAD:
                    result[name] = value
            elif _fields(kind)[name].required:
                self.unread(_join(path, name), "is missing" + _about(hint))
        return result

    def variant(self, raw: Any, kinds: dict[str, type[msgspec.Struct]], path: str) -> Any:
        """A record that says by its `kind` which of several it is."""
        if not isinstance(raw, Mapping):
            return self.unread(path, f"must be an object with a {_KIND!r}", value=raw, allowed=", ".join(kinds))
        tag = raw.get(_KIND)
        if not isinstance(tag, str) or tag not in kinds:
            what = "is missing" if tag is None else "is none of the known values"
            hint = nearest(tag, kinds) if isinstance(tag, str) else None
            return self.unread(_join(path, _KIND), what, value=tag, allowed=", ".join(kinds), hint=hint)
        tree = self.record({name: value for name, value in raw.items() if name != _KIND}, kinds[tag], path)
        return tree if tree is UNREAD else {_KIND: tag, **tree}

    def series(self, raw: Any, kind: Any, extras: list[Any], path: str) -> Any:
        inner = get_args(kind)
        if not isinstance(raw, Sequence) or isinstance(raw, str):
            return self.unread(path, "must be a list", value=raw)
        if inner[-1] is not Ellipsis and len(raw) != len(inner):
            return self.unread(path, f"must have {len(inner)} entries", value=list(raw))
        least = next((e.min_length for e in extras if isinstance(e, msgspec.Meta) and e.min_length), 0)
        most = next((e.max_length for e in extras if isinstance(e, msgspec.Meta) and e.max_length), MOST_ITEMS)
        if len(raw) < least:
            return self.unread(path, f"must have at least {least} entry")
        if len(raw) > most:
            return self.unread(path, f"must have at most {most} entries", value=len(raw))
        values = [self.value(item, inner[0], f"{path}[{label(item, i)}]") for i, item in enumerate(raw)]
        fixed = inner[-1] is not Ellipsis
        return UNREAD if fixed and UNREAD in values else [v for v in values if v is not UNREAD]

    def text(self, raw: Any, extras: list[Any], path: str) -> Any:
        if not isinstance(raw, str):
            return self.unread(path, "must be a text", value=raw)
        if any(isinstance(e, msgspec.Meta) and e.min_length for e in extras) and not raw.strip():
            return self.unread(path, "must not be empty")
        most = next((e.max_length for e in extras if isinstance(e, msgspec.Meta) and e.max_length), None)
        if most is not None and (len(raw) > most or any(c in raw for c in "\r\n\t")):
            return self.unread(path, f"must be one line of at most {most} characters", value=raw[:24])
        if strange := _NO_TEXT.search(raw):
            return self.unread(path, "has a character that cannot be printed", value=f"U+{ord(strange[0]):04X}")
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
            needed = "a whole number" if kind is int else in_unit("a number", quantity.unit)
            return self.unread(path, f"must be {needed}" + _about_extras(extras), value=raw)
        else:
            try:
                value = float(raw)
            except OverflowError:
                value = math.inf
        if not math.isfinite(value):
            return self.unread(path, "must be a finite number", value=f"{raw}"[:24])
        self.bounds(value, raw, extras, path)
        question = quantity.slip(value)
        beyond = quantity.plausible[1] if quantity.plausible else _BEYOND
        if question is not None:
            self.problems.append(Problem(path, "is implausible", value=raw, hint=question))
        elif abs(value) > beyond:
            allowed = f"at most {with_unit(beyond, quantity.unit)}"
            self.problems.append(Problem(path, "is beyond any crane", value=raw, allowed=allowed))
        return int(value) if kind is int else value

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


def label(item: Any, index: int) -> str:
    """How an entry of a list is called in a path: by its name if it has one that can be read."""
    name = item.get("name") if isinstance(item, Mapping) else None
    return name if isinstance(name, str) and name and not _NO_TEXT.search(name) else str(index)


def _about(annotation: Any) -> str:
    return _about_extras(_peel(annotation)[1])


def _about_extras(extras: list[Any]) -> str:
    words = next((e.description for e in extras if isinstance(e, msgspec.Meta) and e.description), "")
    quantity = next((e for e in extras if isinstance(e, Quantity)), None)
    text = labelled(words, quantity.unit if quantity is not None else "1").strip()
    return f": {text}" if text else ""
