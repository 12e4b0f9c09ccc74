"""Whether the binaries of an FMU are what their places say, and whether the one for this machine knows its FMU."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path, PurePosixPath
from typing import Final

from seacrane.errors import Problem
from seacrane.fmi.description import ModelDescription
from seacrane.fmi.platforms import binary_path

_HEADS: Final = {
    ".so": ("an ELF library", (b"\x7fELF",)),
    ".dll": ("a DLL", (b"MZ",)),
    ".dylib": ("a Mach-O library", (b"\xcf\xfa\xed\xfe", b"\xce\xfa\xed\xfe", b"\xca\xfe\xba\xbe")),
}
"""What a shared library begins with, by its suffix."""

_ELF_MACHINES: Final = {0x03: "x86", 0x28: "arm", 0x3E: "x86_64", 0xB7: "aarch64"}
"""Processors by the number in the header of an ELF file."""

_FOLDERS: Final = {"linux64": "x86_64", "linux32": "x86"}
"""Processors of the folders of FMI 1.0 and 2.0; those of FMI 3.0 begin with theirs."""

PATIENCE: Final = 60.0
"""Wall time [s] after which an instance that is not made yet is given up."""

_TRIAL: Final = """
import sys
from seacrane import fmi
from seacrane.errors import SeacraneError
try:
    with fmi.Fmu(sys.argv[1]) as fmu:
        fmu.instantiate("check").close()
except SeacraneError as error:
    print("; ".join(problem.message for problem in error.problems))
"""


def binary_problems(path: Path, archive: zipfile.ZipFile, description: ModelDescription) -> Iterator[Problem]:
    """Binaries that are no libraries for their platform; and that of this machine, if it cannot be instantiated.

    It is tried where it does not hold the GUID (the instantiation token) as a text, in a process of its own: some FMUs
    read it from their model description, others were put together from two.
    """
    sound = set()
    for name in archive.namelist():
        place = PurePosixPath(name)
        if len(place.parts) == 3 and place.parts[0] == "binaries" and place.suffix in _HEADS:
            with archive.open(name) as file:
                message = _unlike(place, file.read(20))
            if message:
                yield Problem(name, message)
            else:
                sound.add(name)
    kind = description.co_simulation or description.model_exchange
    if kind is None or (own := binary_path(kind.model_identifier, description.fmi_version)) not in sound:
        return
    if description.guid.encode() not in archive.read(own) and _runs_here(description):
        message = _tried(path)
        if message:
            yield Problem(own, message)


def _unlike(place: PurePosixPath, head: bytes) -> str:
    """Why a file is not the library that its place says; empty if it is."""
    what, heads = _HEADS[place.suffix]
    if not head.startswith(heads):
        return f"is not {what}"
    folder = place.parts[1]
    expected = _FOLDERS.get(folder, folder.partition("-")[0])
    made_for = _ELF_MACHINES.get(int.from_bytes(head[18:20], "little"), "") if place.suffix == ".so" else ""
    if made_for and expected in _ELF_MACHINES.values() and made_for != expected:
        return f"is made for {made_for}, and lies where one for {expected} is looked for"
    return ""


def _runs_here(description: ModelDescription) -> bool:
    """Whether instances can be made here at all: not of what needs another tool, or is not supported."""
    kind = description.co_simulation or description.model_exchange
    clocked = any(v.type == "Clock" for v in description.inputs)
    old = description.fmi_version == "1.0" and description.co_simulation is None
    return kind is not None and not kind.needs_execution_tool and not clocked and not old


def _tried(path: Path) -> str:
    """What is said when an instance is made, and why there is none; empty if there is one."""
    try:
        done = subprocess.run(
            [sys.executable, "-c", _TRIAL, str(path)], capture_output=True, text=True, timeout=PATIENCE, check=False
        )
    except subprocess.TimeoutExpired:
        return f"does not come back from making an instance within {PATIENCE:g} s"
    if done.returncode:
        return f"ends the process in which an instance is made (exit code {done.returncode})"
    return done.stdout.strip() and f"does not hold the GUID of {path.name}, and {done.stdout.strip()}"
