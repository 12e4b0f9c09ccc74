"""Reading and writing the files of the package: no field of a JSON object twice, no half-written file."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
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
    """Write a file, text as UTF-8, as `whole` does."""
    with whole(path) as part:
        part.write_bytes(content.encode() if isinstance(content, str) else content)


@contextmanager
def whole(path: str | os.PathLike[str]) -> Iterator[Path]:
    """The file to write in place of `path`, with its suffix: it replaces what is there once the block has ended well.

    What is no file, such as a pipe or a device, is then written to. `OSError` with the name of `path`.
    """
    given = Path(path)
    device = given.exists() and not given.is_file()
    target = given if device else given.resolve()
    try:
        handle, name = tempfile.mkstemp(
            prefix=f".{target.stem}.", suffix=target.suffix, dir=None if device else target.parent
        )
        os.close(handle)
        part = Path(name)
        try:
            yield part
            with part.open("rb") as file:
                os.fsync(file.fileno())
                if device:
                    with target.open("wb") as into:
                        shutil.copyfileobj(file, into)
            if not device:
                part.chmod(0o666 & ~_umask())
                part.replace(target)
        finally:
            part.unlink(missing_ok=True)
    except OSError as failure:
        if failure.filename and not Path(failure.filename).name.startswith(f".{target.stem}."):
            raise  # of another file, which the block was reading
        raise OSError(failure.errno, failure.strerror or str(failure), os.fspath(path)) from failure


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
