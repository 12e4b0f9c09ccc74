"""The ZIP archive of an FMU, treated as what a stranger sent."""

from __future__ import annotations

import shutil
import stat
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Final

from seacrane.errors import FmuError, Problem
from seacrane.fmi.xml import FILE, LARGEST

MiB: Final = 2**20
LARGEST_ARCHIVE: Final = 256 * MiB
LARGEST_UNPACKED: Final = 1024 * MiB
MOST_ENTRIES: Final = 10_000
MOST_EXPANSION: Final = 200
_MOST_SHOWN = 20


@contextmanager
def opened(path: Path, what: str = "an FMU") -> Iterator[zipfile.ZipFile]:
    """The archive of `what`, if it is one and keeps within the limits; `FmuError` with all that is wrong otherwise."""
    try:
        size = path.stat().st_size
        if not path.is_file():
            raise FmuError.at(str(path), "is not a file")
        with path.open("rb") as file:
            head = file.read(4)
    except OSError as error:
        raise FmuError.at(str(path), f"cannot be read: {error.strerror}") from None
    if size > LARGEST_ARCHIVE:
        raise FmuError.at(str(path), f"is larger than {LARGEST_ARCHIVE // MiB} MiB", value=size)
    if not zipfile.is_zipfile(path):
        if head.startswith(b"PK\x03\x04"):
            raise FmuError.at(str(path), "is a truncated ZIP archive", hint="Copy or download it again.")
        raise FmuError.at(str(path), f"is not a ZIP archive, so it is not {what}")
    try:
        with zipfile.ZipFile(path) as archive:
            problems = list(_problems(archive, size))
            if problems:
                raise FmuError(problems[:_MOST_SHOWN])
            yield archive
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, ValueError, OSError) as error:
        raise FmuError.at(str(path), f"is a damaged ZIP archive: {error}") from None


def _problems(archive: zipfile.ZipFile, size: int) -> Iterator[Problem]:
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        yield Problem("", f"the archive has {len(entries)} entries", allowed=f"at most {MOST_ENTRIES}")
    unpacked = sum(entry.file_size for entry in entries)
    if unpacked > LARGEST_UNPACKED:
        allowed = f"at most {LARGEST_UNPACKED // MiB} MiB"
        yield Problem("", f"the archive unpacks to {unpacked / MiB:.0f} MiB", allowed=allowed)
    elif unpacked > MOST_EXPANSION * size:
        yield Problem(
            "", f"the archive unpacks to {unpacked / size:.0f} times its size", allowed=f"{MOST_EXPANSION} times"
        )
    names = set()
    for entry in entries:
        name = entry.orig_filename
        parts = PurePosixPath(name).parts
        if "\\" in name or "\0" in name:
            yield Problem(name, "is a path with a character that the standard forbids", hint="FMI 2.0, section 2.3")
        elif name.startswith("/") or ".." in parts or (parts and ":" in parts[0]):
            yield Problem(name, "is a path that leads out of the archive")
        kind = stat.S_IFMT(entry.external_attr >> 16)
        if kind not in (0, stat.S_IFREG, stat.S_IFDIR):
            yield Problem(name, "is a link or a special file, which an FMU may not hold")
        if entry.flag_bits & 1:
            yield Problem(name, "is encrypted")
        if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
            yield Problem(name, "is compressed by another method than deflate", hint="FMI 2.0, section 2.3")
        if name in names:
            yield Problem(name, "is in the archive twice")
        names.add(name)


def description_text(archive: zipfile.ZipFile) -> bytes:
    """The bytes of modelDescription.xml."""
    if FILE not in archive.namelist():
        raise FmuError.at(FILE, "is not at the top of the archive, so it is not an FMU")
    return text_of(archive, FILE)


def text_of(archive: zipfile.ZipFile, name: str) -> bytes:
    """The bytes of an XML file that is in the archive, if it is not too large to be parsed."""
    entry = archive.getinfo(name)
    if entry.file_size > LARGEST:
        raise FmuError.at(name, f"is larger than {LARGEST // MiB} MiB", value=entry.file_size)
    return archive.read(entry)


def unpack(archive: zipfile.ZipFile, folder: Path) -> None:
    """All files of an archive that `opened` has let pass, into a folder of our own."""
    for entry in archive.infolist():
        target = folder.joinpath(*PurePosixPath(entry.filename).parts)
        if entry.is_dir():
            target.mkdir(parents=True, exist_ok=True)
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        with archive.open(entry) as source, target.open("xb") as copy:
            shutil.copyfileobj(source, copy, MiB)
