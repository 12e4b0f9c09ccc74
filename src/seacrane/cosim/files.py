"""Systems from files, whatever their format is."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Final

from seacrane.cosim.osp import read_osp
from seacrane.cosim.ssp import read_ssp
from seacrane.cosim.system import System
from seacrane.errors import CosimError

READERS: Final[dict[str, Callable[[Path], System]]] = {".ssp": read_ssp, ".ssd": read_ssp, ".xml": read_osp}
"""The reader of a file by its suffix."""


def load(path: str | Path) -> System:
    """The system in an SSP archive, a system structure description (.ssd), or OspSystemStructure.xml or its folder.

    Raises `CosimError` with all that is wrong with it.
    """
    path = Path(path)
    if path.is_dir():
        return read_osp(path)
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        allowed = ", ".join(READERS)
        raise CosimError.at(str(path), "is no file of a system", value=path.suffix, allowed=allowed)
    return reader(path)
