"""Reading and writing the files of the package: no field of a JSON object twice, no half-written file."""

from __future__ import annotations

import json
import os
import tempfile
from pathlib import Path
from typing import Any

from seacrane.errors import SeacraneError


def read(path: str | os.PathLike[str], error: type[SeacraneError]) -> bytes:
    """The content of a file, or `error` with the reason."""
    try:
        return Path(path).read_bytes()
    except OSError as failure:
        raise error.at(os.fspath(path), f"cannot be read: {failure.strerror or failure}") from None


def parsed(content: bytes | str, origin: str, error: type[SeacraneError]) -> Any:
    """The value of a JSON text. What is not JSON, or gives a field twice, is an `error` that names `origin`."""

    def without_duplicates(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        result = dict(pairs)
        if len(result) < len(pairs):
            keys = [key for key, _ in pairs]
            twice = ", ".join(sorted({repr(key) for key in keys if keys.count(key) > 1}))
            raise error.at(origin, f"gives a field twice in one object: {twice}")
        return result

    try:
        text = content.decode("utf-8-sig") if isinstance(content, bytes) else content
        return json.loads(text, object_pairs_hook=without_duplicates)
    except UnicodeDecodeError:
        raise error.at(origin, "is not a text file in UTF-8") from None
    except json.JSONDecodeError as fault:
        raise error.at(origin, f"is not JSON: {fault.msg} in line {fault.lineno}, column {fault.colno}") from None
    except (RecursionError, ValueError):
        raise error.at(origin, "cannot be read: nested too deeply, or with a number too long") from None


def write(content: str | bytes, path: str | os.PathLike[str]) -> None:
    """Write a file, text as UTF-8; an existing file is replaced only once the new one is complete."""
    target = Path(path)
    handle, beside = tempfile.mkstemp(prefix=f".{target.name}.", dir=target.parent or Path())
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
        os.chmod(beside, 0o666 & ~_umask())
        os.replace(beside, target)
    except BaseException:
        Path(beside).unlink(missing_ok=True)
        raise


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
