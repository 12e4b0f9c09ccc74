"""Reading and writing design files.

A design file is JSON. A quantity is a number in SI or a text with a unit, `"420 mm"`; a file written by `save` is in
SI throughout.
"""

from __future__ import annotations

import json
import os
from importlib import resources
from typing import Any

from seacrane import documents
from seacrane.design.crane import FORMAT, Crane
from seacrane.design.validation import check, examine
from seacrane.errors import DesignError, Problem, nearest


def names() -> list[str]:
    """The names of the designs that come with the package."""
    folder = resources.files("seacrane.design") / "cranes"
    return sorted(item.name.removesuffix(".json") for item in folder.iterdir() if item.name.endswith(".json"))


def load(source: str | os.PathLike[str]) -> Crane:
    """The crane of a design file, by the name of a shipped design or by a path.

    A text that ends in `.json` or has a separator is a path. `DesignError` lists everything that is wrong.
    """
    text = os.fspath(source)
    if isinstance(source, str) and not text.endswith(".json") and "/" not in text and os.sep not in text:
        if text not in names():
            hint = nearest(text, names()) + " A path ends in .json."
            raise DesignError.at(text, "is not a design that comes with the package", hint=hint)
        return loads((resources.files("seacrane.design") / "cranes" / f"{text}.json").read_bytes(), origin=text)
    return loads(documents.read(text, DesignError), origin=text)


def loads(content: bytes | str, origin: str = "design") -> Crane:
    """The crane in the JSON text of a design file; `origin` names it in errors."""
    data = documents.parsed(content, origin, DesignError)
    if not isinstance(data, dict):
        raise DesignError.at(origin, "does not hold a crane: the file must be a JSON object")
    written = data.get("format")
    if written != FORMAT:
        what = "names no format" if written is None else "is of a format that this version cannot read"
        raise DesignError.at(f"{origin}: format", what, value=written, allowed=repr(FORMAT))
    crane, problems = examine(data)
    if crane is None:
        raise DesignError(Problem(f"{origin}: {p.path}", p.message, p.value, p.allowed, p.hint) for p in problems)
    return crane


def to_json(crane: Crane) -> str:
    """The design file of a crane, in SI, which `loads` reads back equal. `DesignError` if it is not sound."""
    problems = check(crane)
    if problems:
        raise DesignError(problems)
    return json.dumps(_plain(crane), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def save(crane: Crane, path: str | os.PathLike[str]) -> None:
    """Write the design file; an existing file is replaced only once the new one is complete."""
    documents.write(to_json(crane), path)


def _plain(value: Any) -> Any:
    """Dicts and lists without the absent values."""
    if hasattr(value, "__struct_fields__"):
        fields = {name: getattr(value, name) for name in value.__struct_fields__}
        if value.__struct_config__.tag:
            fields = {"kind": value.__struct_config__.tag} | fields
        return {name: _plain(field) for name, field in fields.items() if field is not None}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value
