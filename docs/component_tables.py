"""MkDocs hook: the library reference, all components of a module with levels, parameters and ports, from the code."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import re
from collections.abc import Iterable
from typing import Any

from seacrane.model import REGISTRY, Component, SignalIn, SignalOut
from seacrane.units import labelled

MARKER = re.compile(r"^<!-- components of ([\w.]+) -->$", re.MULTILINE)


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Called by MkDocs for each page."""
    return MARKER.sub(lambda found: "\n\n".join(described(c) for c in components(found[1])), markdown)


def components(module: str) -> list[type[Component]]:
    """The interfaces of a module's public components, in order of definition."""
    public = vars(importlib.import_module(module))
    interfaces = [next(c for c in cls.__mro__ if issubclass(c, Component) and c.level is None) for cls in REGISTRY]
    return [c for c in dict.fromkeys(interfaces) if public.get(c.__name__) is c and not c.__name__.startswith("_")]


def described(component: type[Component]) -> str:
    parts = [
        f"::: {component.__module__}.{component.__name__}\n    options:\n      members: false",
        ports(component),
        parameters(component, component.declarations),
    ]
    for level, cls in getattr(component, "levels", {}).items():
        own = [key for key in cls.declarations if key not in component.declarations]
        other_ports = ports(cls) if cls.ports != component.ports else ""
        parts += [f"**Level `{level}`.** {inspect.getdoc(cls)}", other_ports, parameters(cls, own)]
    return "\n\n".join(part for part in parts if part)


def ports(component: type[Component]) -> str:
    rows = []
    for name, port in component.ports.items():
        kind = {SignalIn: "signal in", SignalOut: "signal out"}.get(type(port), getattr(port, "domain", ""))
        unit = port.unit if isinstance(port, SignalIn | SignalOut) else "1"
        rows.append((f"`{name}`", labelled(kind, unit), port.about))
    return table(("port", "kind", ""), rows)


def parameters(component: type[Component], names: Iterable[str]) -> str:
    fields = {field.name: field for field in dataclasses.fields(component)}  # type: ignore[arg-type]
    rows = []
    for name in names:
        declaration, quantity = component.declarations[name]
        default = fields[name].default
        value = getattr(default, "default", default)
        shown = (
            "required" if default is dataclasses.MISSING else f"{value:g}" if isinstance(value, float) else f"{value}"
        )
        if declaration.role in ("shared", "initial"):
            shown += f" ({declaration.role})"
        if declaration.reason:
            shown += f": {declaration.reason}"
        unit = quantity.unit if quantity and quantity.unit != "1" else ""
        rows.append((f"`{name}`", declaration.about, unit, shown, declaration.allowed))
    return table(("parameter", "", "unit", "default", "allowed"), rows)


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    if not rows:
        return ""
    cells = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in cells)
