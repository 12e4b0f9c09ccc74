"""The C sources of the core, and the system's C compiler to turn them into shared libraries on the user's machine."""

from __future__ import annotations

import hashlib
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from seacrane.errors import CompileError

FOLDER = Path(__file__).parent
"""Where the C sources of the package lie."""

FLAGS = (
    "-std=c11", "-O2", "-fPIC", "-ffp-contract=off", "-fno-math-errno", "-fvisibility=hidden",
    "-DCASADI_SYMBOL_EXPORT=",
)  # fmt: skip
"""Of every compiler. Products and sums are rounded one by one, which makes results the same on all machines."""

LARGE = 500_000
"""Characters from which on a C file is large: the equations of some fifty states."""


def source(*names: str) -> dict[str, str]:
    """The texts of C files of this package, by name."""
    return {name: (FOLDER / name).read_text(encoding="utf-8") for name in names}


def compiler() -> list[str]:
    """The command of the C compiler: what `CC` says, or the first of cc, gcc and clang that is installed."""
    chosen = os.environ.get("CC")
    if chosen:
        command = shlex.split(chosen)
        if shutil.which(command[0]):
            return command
        raise CompileError.at("CC", f"the C compiler {command[0]!r} was not found", hint="Set CC to one, or unset it.")
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    raise CompileError.at(
        "",
        "no C compiler was found; models are compiled on this machine",
        allowed="cc, gcc or clang on the PATH, or the command in the environment variable CC",
        hint="On Debian and Ubuntu: apt install gcc libc6-dev",
    )


def cache_folder() -> Path:
    """Where compiled models are kept: `seacrane` in `XDG_CACHE_HOME`, or in `~/.cache`."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "seacrane"


def build_library(name: str, sources: Mapping[str, str], flags: Sequence[str] = ()) -> Path:
    """The shared library compiled from C `sources` (file name to text; headers included), from the cache if there.

    The cache is keyed by content, compiler and flags, and holds each compiled file too: of a model with other start
    values, only these are compiled. What is in it appears complete or not at all, so that processes may build the same
    library at the same time. Raises `CompileError` with the command and its output.
    """
    command = [*compiler(), *FLAGS, *flags]
    efforts = sorted((file, _effort(text)) for file, text in sources.items())
    target = cache_folder() / _key(command, name, efforts, sorted(sources.items())) / f"{name}.so"
    if target.exists():
        return target
    with tempfile.TemporaryDirectory(prefix="seacrane-") as folder:
        for file, text in sources.items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        units = sorted((file for file in sources if file.endswith(".c")), key=lambda f: (-len(sources[f]), f))
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # the longest first
            objects = list(pool.map(lambda f: _object(f, sources, command, folder), units))
        _run([*command, "-shared", "-o", target.name, *map(str, objects), "-lm"], folder)
        _keep(Path(folder) / target.name, target)
    return target


def _object(unit: str, sources: Mapping[str, str], command: Sequence[str], folder: str) -> Path:
    """One compiled C file, from the cache if it and all that it includes are the same."""
    command = [*command, *_effort(sources[unit])]
    target = cache_folder() / "objects" / f"{_key(command, _with_included(unit, sources))}.o"
    if not target.exists():
        compiled = f"{Path(unit).stem}.o"
        _run([*command, "-c", "-o", compiled, unit], folder)
        _keep(Path(folder) / compiled, target)
    return target


_INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)


def _with_included(unit: str, sources: Mapping[str, str]) -> list[tuple[str, str]]:
    """Names and texts of a C file and of those of `sources` that it includes, through others too."""
    found: dict[str, str] = {}
    open_files = [unit]
    while open_files:
        file = open_files.pop()
        if file in sources and file not in found:
            found[file] = sources[file]
            open_files += _INCLUDE.findall(sources[file])
    return sorted(found.items())


def _key(*content: object) -> str:
    return hashlib.sha256(repr(content).encode()).hexdigest()[:32]


def _keep(file: Path, target: Path) -> None:
    """Put a file into the cache, whole at once."""
    target.parent.mkdir(parents=True, exist_ok=True)
    partial = target.with_name(f".{target.stem}.{os.getpid()}.{threading.get_ident()}{target.suffix}")
    shutil.copyfile(file, partial)
    partial.replace(target)


def _effort(text: str) -> list[str]:
    """What is compiled with less effort: the equations of a large model take half the time, and run as fast to 10 %."""
    return ["-O1"] if len(text) > LARGE else []


def _run(command: list[str], folder: str) -> None:
    try:
        finished = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    except OSError as error:
        raise CompileError.at(command[0], f"the C compiler could not be started: {error}") from None
    if finished.returncode != 0:
        raise CompileError.at(
            command[0], f"the C compiler failed: {shlex.join(command)}\n{(finished.stderr + finished.stdout).strip()}"
        )
