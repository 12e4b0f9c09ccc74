"""Where the files of a system structure are, and that none outside is ever read."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Final
from urllib.parse import unquote, urlsplit

from seacrane.cosim.ssp.schema import MAIN
from seacrane.errors import CosimError, Problem
from seacrane.fmi.archive import opened, text_of, unpack
from seacrane.fmi.xml import LARGEST

DEEPEST: Final = 16
"""How deep files may refer to further ones: an archive that holds itself would have no end."""

MOST_PARTS: Final = 10_000
MOST_ARCHIVES: Final = 100
"""Elements and archives in one structure: a few that refer to one another twice or more would make billions."""


class Folder:
    """A private folder that is gone when nothing uses it any more."""

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="seacrane-ssp-"))
        self._remove = weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


@dataclass
class Findings:
    """What reading a structure has brought to light so far, whichever of its files it was in."""

    problems: list[Problem] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    parts: int = 0
    archives: int = 0

    def count(self, *, archive: bool = False) -> None:
        """One part more, or one archive; `CosimError` if there are too many."""
        self.parts += 1
        self.archives += archive
        if self.parts > MOST_PARTS or self.archives > MOST_ARCHIVES:
            allowed = f"at most {MOST_PARTS} elements and {MOST_ARCHIVES} archives"
            raise CosimError.at("", "is one too many in the system structure", allowed=allowed)


class Room:
    """A folder with one of its system structure descriptions; `kept` is what must live as long as its files do."""

    def __init__(self, folder: Path, main: str, depth: int = 0, kept: Folder | None = None) -> None:
        self.folder, self.main, self.depth, self.kept = folder, main, depth, kept
        if depth > DEEPEST:
            raise CosimError.at(main, f"system structures refer to one another more than {DEEPEST} deep")

    @classmethod
    def of(cls, path: Path, variant: str = "", depth: int = 0) -> Room:
        """An archive, unpacked into a private folder, or the folder of an .ssd. `FmuError` for a bad archive."""
        if path.suffix.lower() == ".ssd":
            return cls(path.parent, path.name, depth)
        kept = Folder()
        with opened(path, "an SSP") as archive:
            unpack(archive, kept.path)
        return cls(kept.path, variant or MAIN, depth, kept)

    def file(self, uri: str) -> Path:
        """The file of a relative URI; `CosimError` if it is no such, leads out of the folder or is not there."""
        address = urlsplit(uri)
        parts = PurePosixPath(unquote(address.path)).parts
        if address.scheme or address.netloc or not parts or parts[0] == "/" or "\\" in uri or "\0" in unquote(uri):
            raise CosimError.at("", "is no file of the system structure", value=uri, allowed="a relative path")
        path = self.folder.joinpath(*parts)
        if ".." in parts or not path.resolve().is_relative_to(self.folder.resolve()):
            raise CosimError.at("", "leads out of the folder of the system structure", value=uri)
        if not path.is_file():
            raise CosimError.at("", "is not there", value=uri)
        return path

    def text(self, uri: str) -> bytes:
        """The bytes of an XML file, if it is not too large to be parsed."""
        path = self.file(uri)
        if path.stat().st_size > LARGEST:
            raise CosimError.at("", f"is larger than {LARGEST // 2**20} MiB", value=uri)
        return path.read_bytes()

    def text_in(self, archive: str, name: str) -> bytes:
        """The bytes of an XML file in an FMU or in another archive."""
        with opened(self.file(archive), "an archive") as opened_archive:
            if name not in opened_archive.namelist():
                raise CosimError.at("", f"is not in {archive!r}", value=name)
            return text_of(opened_archive, name)
