"""Values of all types to and from an instance, by the names of variables and of elements of arrays."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Mapping, Sequence
from ctypes import c_double, c_size_t, c_uint32, c_void_p
from typing import Any, Final

import numpy as np

from seacrane.errors import FmuError, Problem, nearest
from seacrane.fmi.api import FMI3, Api
from seacrane.fmi.component import Component
from seacrane.fmi.description import INTEGERS, REALS, ModelDescription, Variable

WHOLE: Final = 1e-6
"""How far from a whole number a value may be that is set to an integer."""

_ELEMENT: Final = re.compile(r"(.+)\[([0-9]+(?:, ?[0-9]+)*)\]", re.DOTALL)

Name = str | int


def element_of(name: str, variables: Mapping[str, Variable]) -> tuple[Variable, int] | None:
    """The array and the place (from 0, in row-major order) of the element that `x[2,3]` names, None if there is none.

    Subscripts count from 1, one for each dimension.
    """
    found = _ELEMENT.fullmatch(name)
    v = variables.get(found.group(1)) if found else None
    if found is None or v is None or not v.dimensions:
        return None
    subscripts = [int(n) for n in found.group(2).split(",")]
    if len(subscripts) != len(v.shape) or not all(1 <= n <= s for n, s in zip(subscripts, v.shape, strict=True)):
        return None
    return v, int(np.ravel_multi_index([n - 1 for n in subscripts], v.shape))


class Values:
    """Sets and gets of one instance."""

    def __init__(self, component: Component, api: Api, description: ModelDescription) -> None:
        self._instance = component.log.name
        self._api = api
        self._call = component.call
        self._by_name = description.by_name
        self._by_reference = {
            v.value_reference: v for v in reversed(description.variables) if v.type in ("Real", "Float64")
        }
        self._found: dict[Name, tuple[Variable, int | None]] = {}
        self._given: dict[str, Any] = {}
        self._started = False
        self._reals: dict[tuple[Name, ...], Any] = {}

    def find(self, names: Sequence[Name]) -> list[tuple[Variable, int | None]]:
        """The variable of each name, and the element if the name is that of one. `FmuError` with all unknown ones."""
        problems = []
        for name in names:
            if name in self._found:
                continue
            whole = self._by_name.get(name) if isinstance(name, str) else self._by_reference.get(name)
            found = (whole, None) if whole else element_of(name, self._by_name) if isinstance(name, str) else None
            if found is None:
                hint = nearest(str(name), self._by_name)
                problems.append(Problem(self._instance, f"has no variable {name!r}", hint=hint))
            elif found[0].type == "Clock":
                message = f"{found[0].name} is a clock, and clocks are not supported"
                problems.append(Problem(self._instance, message))
            else:
                self._found[name] = found
        if problems:
            raise FmuError(problems)
        return [self._found[name] for name in names]

    def set(self, names: Sequence[Name], values: Sequence[Any]) -> None:
        """Sets variables, all elements of an array, or single elements of one, whose others stay."""
        references = self._references(names)
        if references is not None and all(isinstance(value, float) for value in values):
            array, count = (c_double * len(references))(*values), [len(references)] if self._api is FMI3 else []
            self._call("SetFloat64" if count else "SetReal", references, len(references), array, *count)
            return
        given: dict[str, tuple[Variable, Any]] = {}
        for (v, element), value in zip(self.find(names), values, strict=True):
            if element is None:
                given[v.name] = v, value
            else:
                elements = _flat(given[v.name][1]) if v.name in given else self._present(v)
                elements[element] = value
                given[v.name] = v, elements
        groups: dict[str, list[tuple[Variable, list[Any]]]] = {}
        for v, value in given.values():
            groups.setdefault(self._api.of_type(v.type), []).append((v, self._elements(v, value)))
        for kind, members in groups.items():
            self._set(kind, [v for v, _ in members], [item for _, items in members for item in items])
        if not self._started:
            self._given |= {v.name: value for v, value in given.values() if v.dimensions}

    def get(self, names: Sequence[Name]) -> tuple[list[Any], bool]:
        """The values, an array for each array, and whether all of them are real scalars."""
        references = self._references(names)
        if references is not None:
            array, count = (c_double * len(references))(), [len(references)] if self._api is FMI3 else []
            self._call("GetFloat64" if count else "GetReal", references, len(references), array, *count)
            return list(array), True
        found = self.find(names)
        values: list[Any] = [None] * len(found)
        groups: dict[str, list[int]] = {}
        for i, (v, _) in enumerate(found):
            groups.setdefault(self._api.of_type(v.type), []).append(i)
        for kind, places in groups.items():
            read = self._get(kind, [found[i][0] for i in places])
            start = 0
            for i in places:
                v, element = found[i]
                part = read[start : start + v.count]
                start += v.count
                if not v.dimensions:
                    value = _negated(part[0]) if v.negated else part[0]
                    values[i] = value.item() if isinstance(value, np.generic) else value
                elif element is None:
                    values[i] = np.array(part).reshape(v.shape)
                else:
                    values[i] = part[element].item() if isinstance(part, np.ndarray) else part[element]
        return values, all(v.type in REALS and (not v.dimensions or e is not None) for v, e in found)

    def _references(self, names: Sequence[Name]) -> Any:
        """The value references of real scalars, which go the short way; None if any of these is something else."""
        key = tuple(names)
        if key not in self._reals:
            variables = [v for v, _ in self.find(names)]
            short = all(v.type in ("Real", "Float64") and not v.dimensions and not v.negated for v in variables)
            self._reals[key] = (c_uint32 * len(variables))(*(v.value_reference for v in variables)) if short else None
        return self._reals[key]

    def started(self, now: bool) -> None:
        """Told when the instance has been initialised, and may be asked, or reset."""
        self._started = now
        self._given.clear()

    def _present(self, v: Variable) -> list[Any]:
        """The elements of an array, flat; before the instance may be asked, those given to it or its start values."""
        known = self._given.get(v.name, v.start)
        if self._started:
            known = self.get([v.name])[0][0]
        elif known is None:
            message = f"{v.name} has no start values, so that it can only be set as a whole"
            raise FmuError.at(self._instance, message)
        elements = _flat(known)
        return elements * v.count if len(elements) == 1 else elements

    def _elements(self, v: Variable, value: Any) -> list[Any]:
        if not v.dimensions:
            value = value.item() if isinstance(value, np.ndarray) and value.size == 1 else value
            return [to_c(v, _negated(value) if v.negated else value)]
        elements = _flat(value)
        if len(elements) != v.count:
            message = f"{v.name} has {v.count} elements and cannot take {len(elements)} values"
            raise FmuError.at(self._instance, message)
        return [to_c(v, element) for element in elements]

    def _set(self, kind: str, variables: Sequence[Variable], flat: list[Any]) -> None:
        references = (c_uint32 * len(variables))(*(v.value_reference for v in variables))
        if kind == "Binary":
            kept = [ctypes.create_string_buffer(value, len(value) or 1) for value in flat]
            blocks = (c_void_p * len(flat))(*(ctypes.addressof(block) for block in kept))
            sizes = (c_size_t * len(flat))(*(len(value) for value in flat))
            self._call("SetBinary", references, len(variables), sizes, blocks, len(flat))
            return
        array = (self._api.types[kind] * len(flat))(*flat)
        count = [len(flat)] if self._api is FMI3 else []
        self._call(f"Set{kind}", references, len(variables), array, *count)

    def _get(self, kind: str, variables: Sequence[Variable]) -> Any:
        total = sum(v.count for v in variables)
        references = (c_uint32 * len(variables))(*(v.value_reference for v in variables))
        array = (self._api.types[kind] * total)()
        count = [total] if self._api is FMI3 else []
        if kind == "Binary":
            sizes = (c_size_t * total)()
            self._call("GetBinary", references, len(variables), sizes, array, total)
            return [ctypes.string_at(p, n) if p else b"" for p, n in zip(array, sizes, strict=True)]
        self._call(f"Get{kind}", references, len(variables), array, *count)
        if kind == "String":
            return [(text or b"").decode(errors="replace") for text in array]
        read = np.ctypeslib.as_array(array) if total else np.zeros(0)
        return read.astype(bool) if kind == "Boolean" else read


def _flat(value: Any) -> list[Any]:
    """The elements of what was given for an array, in row-major order."""
    return [value] if isinstance(value, (str, bytes)) else list(np.asarray(value, dtype=object).ravel())


def to_c(v: Variable, value: Any) -> Any:
    """A value as the C type of a variable takes it; `FmuError` if it is none of its type or range.

    An enumeration takes the name of an item or its number. What stands for an integer or a truth may come as a number
    that is whole to 1e-6.
    """
    try:
        if v.type in REALS:
            return float(value)
        if v.type == "String":
            return _text(value)
        if v.type == "Binary":
            return _bytes(value)
        if v.items and isinstance(value, str):
            return v.items[value]
        number = float(value) if isinstance(value, (float, np.floating)) else int(value)
        whole = round(number)
        low, high = INTEGERS.get(v.type, (0, 1))
        fits = whole in v.items.values() if v.items else low <= whole <= high
        if fits and abs(whole - number) <= WHOLE and not isinstance(value, str):
            return whole
    except (TypeError, ValueError, KeyError, OverflowError):
        pass
    raise FmuError.at(v.name, f"a value does not fit the type {v.type}", value=value, allowed=_allowed(v))


def _allowed(v: Variable) -> str:
    if v.items:
        return ", ".join(f"{name} ({value})" for name, value in list(v.items.items())[:20])
    if v.type in INTEGERS:
        return "a whole number from {} to {}".format(*INTEGERS[v.type])
    return {"Boolean": "true or false", "String": "a text", "Binary": "bytes"}.get(v.type, "a number")


def _text(value: Any) -> bytes:
    if not isinstance(value, str) or "\0" in value:
        raise TypeError(value)
    return value.encode()


def _bytes(value: Any) -> bytes:
    if not isinstance(value, (bytes, bytearray, memoryview)):
        raise TypeError(value)
    return bytes(value)


def _negated(value: Any) -> Any:
    return not value if isinstance(value, (bool, np.bool_)) else -value
