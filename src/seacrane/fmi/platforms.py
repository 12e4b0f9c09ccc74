"""The platforms of FMI 2.0 and the names of their binaries (FMI 2.0.4, section 2.3)."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from pathlib import PurePosixPath
from typing import Final

_SYSTEMS: Final = {"linux": ("linux", "so"), "win32": ("win", "dll"), "darwin": ("darwin", "dylib")}


def host() -> tuple[str, str]:
    """Folder below `binaries` and file suffix for this machine, for example ("linux64", "so")."""
    system, suffix = _SYSTEMS.get(sys.platform, (sys.platform, "so"))
    if platform.machine().lower() in ("x86_64", "amd64") or system == "darwin":
        return f"{system}{'64' if sys.maxsize > 2**32 else '32'}", suffix
    return f"{platform.machine().lower()}-{system}", suffix


def binary_path(identifier: str) -> str:
    """Where in the archive the binary for this machine is."""
    folder, suffix = host()
    return f"binaries/{folder}/{identifier}.{suffix}"


def platforms(names: Iterable[str]) -> list[str]:
    """The platforms for which an archive with these entries has a binary."""
    paths = (PurePosixPath(name) for name in names)
    return sorted({p.parts[1] for p in paths if len(p.parts) == 3 and p.parts[0] == "binaries" and p.suffix})
