"""The platforms of FMI and the names of their binaries (FMI 2.0.4, section 2.3; FMI 3.0.1, section 2.5)."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from pathlib import PurePosixPath
from typing import Final

_SYSTEMS: Final = {"linux": ("linux", "so"), "win32": ("win", "dll"), "darwin": ("darwin", "dylib")}


def host(version: str = "2.0") -> tuple[str, str]:
    """Folder below `binaries` and file suffix of this machine: ("linux64", "so"); in FMI 3.0 ("x86_64-linux", "so")."""
    system, suffix = _SYSTEMS.get(sys.platform, (sys.platform, "so"))
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    if version != "2.0":
        return f"{machine}-{'windows' if system == 'win' else system}", suffix
    if machine == "x86_64" or system == "darwin":
        return f"{system}{'64' if sys.maxsize > 2**32 else '32'}", suffix
    return f"{machine}-{system}", suffix


def binary_path(identifier: str, version: str = "2.0") -> str:
    """Where in the archive the binary for this machine is."""
    folder, suffix = host(version)
    return f"binaries/{folder}/{identifier}.{suffix}"


def platforms(names: Iterable[str]) -> list[str]:
    """The platforms for which an archive with these entries has a binary."""
    paths = (PurePosixPath(name) for name in names)
    return sorted({p.parts[1] for p in paths if len(p.parts) == 3 and p.parts[0] == "binaries" and p.suffix})
