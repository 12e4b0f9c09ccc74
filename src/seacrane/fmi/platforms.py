"""The platforms of FMI 2.0 and 3.0 and the names of their binaries (FMI 2.0, section 2.3; FMI 3.0, section 2.5)."""

from __future__ import annotations

import platform
import sys
from collections.abc import Iterable
from pathlib import PurePosixPath
from typing import Final

SUFFIXES: Final = {"linux": "so", "windows": "dll", "darwin": "dylib"}
"""Suffix of a shared library by operating system."""

_SYSTEMS: Final = {"linux": "linux", "win32": "windows", "darwin": "darwin"}
_SHORT: Final = {"linux": "linux", "windows": "win", "darwin": "darwin"}
_MACHINES: Final = {"amd64": "x86_64", "arm64": "aarch64"}


def this_platform() -> str:
    """The platform of this machine as FMI 3.0 calls it, for example "x86_64-linux"."""
    machine = platform.machine().lower()
    return f"{_MACHINES.get(machine, machine)}-{_SYSTEMS.get(sys.platform, sys.platform)}"


def folder_of(name: str, version: str = "2.0") -> tuple[str, str]:
    """Folder below `binaries` and file suffix for a platform named as in FMI 3.0, in this version of FMI."""
    machine, _, system = name.partition("-")
    suffix = SUFFIXES.get(system, "so")
    if version.startswith("3."):
        return name, suffix
    if machine == "x86_64" or system == "darwin":
        return f"{_SHORT.get(system, system)}64", suffix
    return name, suffix


def host(version: str = "2.0") -> tuple[str, str]:
    """Folder below `binaries` and file suffix for this machine: ("linux64", "so") in FMI 2, "x86_64-linux" in FMI 3."""
    return folder_of(this_platform(), version)


def binary_path(identifier: str, version: str = "2.0", name: str = "") -> str:
    """Where in the archive the binary for a platform, or for this machine, is."""
    folder, suffix = folder_of(name or this_platform(), version)
    return f"binaries/{folder}/{identifier}.{suffix}"


def platforms(names: Iterable[str]) -> list[str]:
    """The platforms for which an archive with these entries has a binary."""
    paths = (PurePosixPath(name) for name in names)
    return sorted({p.parts[1] for p in paths if len(p.parts) == 3 and p.parts[0] == "binaries" and p.suffix})


def has_sources(names: Iterable[str]) -> bool:
    """Whether an archive with these entries holds C sources."""
    return any(name.startswith("sources/") and name.endswith(".c") for name in names)
