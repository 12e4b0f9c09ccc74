"""Reading and writing design files.

A design file is JSON. A quantity is a number in SI or a text with a unit, `"420 mm"`; a file written by `save` is in
SI throughout.
"""

from __future__ import annotations

import json
import os
import tempfile
from importlib import resources
from pathlib import Path
from typing import Any

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
    try:
        content = Path(text).read_bytes()
    except OSError as error:
        raise DesignError.at(text, f"cannot be read: {error.strerror or error}") from None
    return loads(content, origin=text)


def loads(content: bytes | str, origin: str = "design") -> Crane:
    """The crane in the JSON text of a design file; `origin` names it in errors."""
    data = _parsed(content, origin)
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


def _parsed(content: bytes | str, origin: str) -> Any:
    def without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        result = dict(pairs)
        if len(result) < len(pairs):
            keys = [key for key, _ in pairs]
            twice = ", ".join(sorted({repr(key) for key in keys if keys.count(key) > 1}))
            raise DesignError.at(origin, f"gives a field twice in one object: {twice}")
        return result

    try:
        text = content.decode("utf-8") if isinstance(content, bytes) else content
        return json.loads(text, object_pairs_hook=without_duplicates)
    except UnicodeDecodeError:
        raise DesignError.at(origin, "is not a text file in UTF-8") from None
    except json.JSONDecodeError as error:
        raise DesignError.at(origin, f"is not JSON: {error.msg} in line {error.lineno}, column {error.colno}") from None
    except (RecursionError, ValueError):
        raise DesignError.at(origin, "is not a design: nested too deeply, or with a number too long to read") from None


def to_json(crane: Crane) -> str:
    """The design file of a crane, in SI, which `loads` reads back equal. `DesignError` if it is not sound."""
    problems = check(crane)
    if problems:
        raise DesignError(problems)
    return json.dumps(_plain(crane), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def save(crane: Crane, path: str | os.PathLike[str]) -> None:
    """Write the design file; an existing file is replaced only once the new one is complete."""
    target = Path(path)
    content = to_json(crane)
    handle, beside = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent or Path())
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(content)
        os.chmod(beside, 0o666 & ~_umask())
        os.replace(beside, target)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


def _plain(value: Any) -> Any:
    """Dicts and lists without the absent values."""
    if hasattr(value, "__struct_fields__"):
        fields = {name: getattr(value, name) for name in value.__struct_fields__}
        return {name: _plain(field) for name, field in fields.items() if field is not None}
    if isinstance(value, tuple):
        return [_plain(item) for item in value]
    return value
