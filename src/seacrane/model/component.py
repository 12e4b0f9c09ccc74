"""Components: parameters, ports and one law.

A component is an *interface* (ports and the parameters every level needs) with *levels* behind it: sibling classes that
write the law at different fidelity. Swapping a level never changes a connection.

    class Orifice(Component):
        diameter: Diameter = parameter("bore of the orifice", above=0)
        ports = {"a": Hydraulic(), "b": Hydraulic()}

    class SharpEdgedOrifice(Orifice, level="sharp-edged"):
        def equations(self, m):
            yield m.a.q, ...
            yield m.a.q + m.b.q, 0

`Orifice(diameter=10 * mm)` makes the first level declared, `Orifice(level="...", diameter=10 * mm)` another. An
instance is frozen and holds SI floats, checked when it is made. While a diagram is compiled, `equations` runs on a
twin of the instance whose parameters are CasADi symbols, so that every parameter stays tunable in the compiled model.
"""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final, get_type_hints

from seacrane import units
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.units import UNITS, Quantity, compatible, in_unit, labelled, quantity_of, with_unit

from .dae import PowerBond
from .ports import Port
from .structure import BondGraph, Symbol

_ROLE: Final = "seacrane.role"


@dataclass(frozen=True)
class Declaration:
    """What `parameter`, `shared`, `initial` and `option` say about a field; `reason` is that of its default."""

    role: str
    about: str
    above: float | None = None
    below: float | None = None
    least: float | None = None
    most: float | None = None
    reason: str = ""

    @property
    def allowed(self) -> str:
        """The bounds in words, in SI."""
        parts = [
            f"{relation} {bound:g}"
            for relation, bound in (("above", self.above), (">=", self.least), ("below", self.below), ("<=", self.most))
            if bound is not None
        ]
        return " and ".join(parts)

    def admits(self, value: float) -> bool:
        return (
            (self.above is None or value > self.above)
            and (self.below is None or value < self.below)
            and (self.least is None or value >= self.least)
            and (self.most is None or value <= self.most)
        )


def _field(declaration: Declaration, default: Any) -> Any:
    metadata = {_ROLE: declaration}
    if default is dataclasses.MISSING:
        return dataclasses.field(metadata=metadata)
    return dataclasses.field(default=default, metadata=metadata)


def parameter(
    about: str,
    *,
    default: float | Any = dataclasses.MISSING,
    above: float | None = None,
    below: float | None = None,
    least: float | None = None,
    most: float | None = None,
    reason: str = "",
) -> Any:
    """A number of the law, in the SI unit of its type. Without a default it must be given.

    Give a default only to a value that is right nearly always, and say the `reason`, unless it is 0 or 1 and leaves
    something out.
    """
    return _field(Declaration("parameter", about, above, below, least, most, reason), default)


def shared(
    about: str,
    *,
    default: float,
    above: float | None = None,
    least: float | None = None,
    most: float | None = None,
    reason: str = "",
) -> Any:
    """A parameter that a whole diagram shares by its name (such as the density of the oil).

    A value given to the component wins over the diagram's, which wins over `default`.
    """
    declaration = Declaration("shared", about, above=above, least=least, most=most, reason=reason)
    return _field(declaration, _Shared(default))


def initial(about: str, *, default: float = 0.0, least: float | None = None, most: float | None = None) -> Any:
    """A start value of a state. It stays a number: a compiled model starts a state by the state's own name."""
    return _field(Declaration("initial", about, least=least, most=most), default)


def option(about: str, *, default: Any = dataclasses.MISSING) -> Any:
    """A choice that shapes the equations (a table, a name); it is not a number of the compiled model."""
    return _field(Declaration("option", about), default)


@dataclass(frozen=True)
class _Shared:
    """Marks a shared parameter left to the diagram, with the default of last resort."""

    default: float


def _fields(cls: type[Any]) -> tuple[dataclasses.Field[Any], ...]:
    return dataclasses.fields(cls)


REGISTRY: Final[list[type[Component]]] = []
"""Every concrete component (each level), in order of definition: documentation and property tests walk over it."""


class Component:
    """Base of all components; see the module."""

    ports: ClassVar[Mapping[str, Port]] = {}
    level: ClassVar[str | None] = None
    levels: ClassVar[dict[str, type[Component]]]
    declarations: ClassVar[dict[str, tuple[Declaration, Quantity | None]]] = {}
    sources: ClassVar[tuple[str, ...]] = ()
    bond_graph: ClassVar[BondGraph | None] = None
    partner: ClassVar[PowerBond | None] = None
    icon: ClassVar[Symbol | None] = None

    def __init_subclass__(cls, level: str | None = None, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        dataclass(init=False, frozen=True, kw_only=True, eq=True, repr=True)(cls)
        if level is None:
            cls.levels = {}
        else:
            cls.level = level
            cls.levels[level] = cls  # the interface's own dictionary, inherited by the level
        hints = get_type_hints(cls, include_extras=True)
        cls.declarations = {f.name: (f.metadata[_ROLE], quantity_of(hints[f.name])) for f in _fields(cls)}
        if "equations" in vars(cls):
            REGISTRY.append(cls)

    def __new__(cls, *, level: str | None = None, **_: Any) -> Component:
        if cls.levels and cls.level is None:
            if level is not None and level not in cls.levels:
                raise ParameterError.at(
                    cls.__name__,
                    f"has no level {level!r}",
                    allowed=", ".join(cls.levels),
                    hint=nearest(level, cls.levels),
                )
            return object.__new__(cls.levels[level] if level else next(iter(cls.levels.values())))
        if level is not None and level != cls.level:
            only = f"is the level {cls.level!r}, not {level!r}" if cls.level else f"has no levels, so no {level!r}"
            raise ParameterError.at(cls.__name__, only, hint="Leave `level` out.")
        return object.__new__(cls)

    def __init__(self, *, level: str | None = None, **parameters: Any) -> None:
        problems = []
        known = type(self).declarations
        for name in parameters:
            if name not in known:
                problems.append(Problem(self._place(name), "is not a parameter", hint=nearest(name, known)))
        for field in _fields(type(self)):
            declaration, quantity = known[field.name]
            if field.name not in parameters and field.default is dataclasses.MISSING:
                what = labelled(declaration.about, quantity.unit if quantity else "1")
                problems.append(Problem(self._place(field.name), f"is missing: {what}"))
                continue
            value = parameters.get(field.name, field.default)
            if declaration.role != "option" and not isinstance(value, _Shared):
                problem = check_value(self._place(field.name), value, declaration, quantity)
                if problem:
                    problems.append(problem)
            object.__setattr__(self, field.name, value)
        if not problems:
            problems = [dataclasses.replace(p, path=self._place(p.path)) for p in self.check()]
        if problems:
            raise ParameterError(problems)

    def check(self) -> Iterator[Problem]:
        """What is wrong with the parameters taken together (a rod thicker than the bore); each is sound by itself.

        The path of a problem is the name of the parameter.
        """
        yield from ()

    def interface(self) -> Mapping[str, Port]:
        """The ports of this instance. They are those of its class, unless an option shapes them (a signal's unit)."""
        return type(self).ports

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        """The law, as pairs (left, right); `m` is the `Equations` of this instance."""
        raise NotImplementedError

    def _place(self, name: str) -> str:
        """A parameter as the user has written it: of an interface at some level."""
        if self.level is None:
            return f"{type(self).__name__}.{name}"
        return f"{interface_of(type(self)).__name__}(level={self.level!r}).{name}"


def interface_of(component: type[Component]) -> type[Component]:
    """The interface of which this is a level; a component without levels is its own."""
    return next(base for base in component.__mro__ if issubclass(base, Component) and base.level is None)


def check_value(path: str, value: Any, declaration: Declaration, quantity: Quantity | None) -> Problem | None:
    """The problem with a parameter's value, if there is one: not a number, not finite, out of bounds, a unit slip."""
    unit = quantity.unit if quantity else "1"
    if isinstance(value, bool) or not hasattr(value, "__float__"):
        return Problem(
            path, f"must be {in_unit('a number', unit)}: {declaration.about}", value, hint=_spelt(value, unit)
        )
    try:
        number = float(value)
    except (TypeError, ValueError):  # an array of several, or of none
        return Problem(path, f"must be {in_unit('one number', unit)}: {declaration.about}", value)
    if not math.isfinite(number):
        return Problem(path, f"must be {in_unit('a finite number', unit)}: {declaration.about}", value)
    slip = quantity.slip(number) if quantity else None
    if not declaration.admits(number):
        shown = ""
        if quantity and quantity.display != quantity.unit:
            shown = f" = {number / UNITS[quantity.display].factor:g} {quantity.display}"
        given = with_unit(number, unit)
        return Problem(path, f"{given}{shown} is out of range", None, with_unit(declaration.allowed, unit), slip)
    if slip:
        return Problem(path, f"{slip} It is: {declaration.about}")
    return None


def _spelt(value: Any, unit: str) -> str | None:
    """How a quantity given as a text is written in Python."""
    match = re.fullmatch(r"\s*([-+.\deE]+)\s*(\S+)\s*", value) if isinstance(value, str) else None
    if match is None or match[2] not in UNITS or not compatible(match[2], unit):
        return None
    constant = match[2].replace("/", "_").replace(".", "")
    factor = constant if hasattr(units, constant) else f"{UNITS[match[2]].factor:g}"
    return f"Write {match[1]} * {factor}, with the constants of seacrane.units."


def symbolic_twin(component: Component, symbols: Mapping[str, Any]) -> Component:
    """A copy of `component` whose named fields are replaced by symbols, unchecked."""
    twin = object.__new__(type(component))
    for field in _fields(type(component)):
        object.__setattr__(twin, field.name, symbols.get(field.name, getattr(component, field.name)))
    return twin


def shared_default(component: Component, name: str) -> float | None:
    """The default of a shared parameter left to the diagram, or None if the component was given its own value."""
    value = getattr(component, name)
    return value.default if isinstance(value, _Shared) else None
