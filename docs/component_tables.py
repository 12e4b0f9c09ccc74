"""MkDocs hook: under each component of the library reference, its levels, parameters and ports, from the code."""

from __future__ import annotations

import dataclasses
import importlib
import inspect
import re
from collections.abc import Iterable
from typing import Any

from seacrane.model import Component, SignalIn, SignalOut

DIRECTIVE = re.compile(r"^::: (seacrane\.library\.[\w.]+)\.([A-Z]\w*)$", re.MULTILINE)


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Called by MkDocs for each page."""
    if page.file.src_uri != "reference/library.md":
        return markdown
    return DIRECTIVE.sub(
        lambda found: f"{found[0]}\n    options:\n      members: false\n\n{described(found[1], found[2])}", markdown
    )


def described(module: str, name: str) -> str:
    component = getattr(importlib.import_module(module), name)
    parts = [ports(component), parameters(component, component.declarations)]
    for level, cls in getattr(component, "levels", {}).items():
        own = [key for key in cls.declarations if key not in component.declarations]
        parts += [f"**Level `{level}`.** {inspect.getdoc(cls)}", parameters(cls, own)]
    return "\n\n".join(part for part in parts if part)


def ports(component: type[Component]) -> str:
    rows = []
    for name, port in component.ports.items():
        kind = {SignalIn: "signal in", SignalOut: "signal out"}.get(type(port), getattr(port, "domain", ""))
        unit = f" [{port.unit}]" if isinstance(port, SignalIn | SignalOut) else ""
        rows.append((f"`{name}`", kind + unit, port.about))
    return table(("port", "kind", ""), rows)


def parameters(component: type[Component], names: Iterable[str]) -> str:
    fields = {field.name: field for field in dataclasses.fields(component)}  # type: ignore[arg-type]
    rows = []
    for name in names:
        declaration, quantity = component.declarations[name]
        default = fields[name].default
        shown = "required" if default is dataclasses.MISSING else f"{getattr(default, 'default', default)}"
        if declaration.role in ("shared", "initial"):
            shown += f" ({declaration.role})"
        unit = quantity.unit if quantity else ""
        rows.append((f"`{name}`", declaration.about, unit, shown, declaration.allowed))
    return table(("parameter", "", "unit", "default", "allowed"), rows)


def table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    if not rows:
        return ""
    cells = [head, ("---",) * len(head), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in cells)
