"""The C sources of the core, and the system's C compiler to turn them into shared libraries on the user's machine."""

from __future__ import annotations

import hashlib
import os
import shlex
import shutil
import subprocess
import tempfile
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

    The cache is keyed by content, compiler and flags. A library appears in it complete or not at all, so that
    processes may build the same one at the same time. Raises `CompileError` with the command and its output.
    """
    command = [*compiler(), *FLAGS, *flags]
    efforts = sorted((file, _effort(text)) for file, text in sources.items())
    key = hashlib.sha256(repr((command, name, efforts, sorted(sources.items()))).encode()).hexdigest()
    target = cache_folder() / key[:32] / f"{name}.so"
    if target.exists():
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="seacrane-") as folder:
        for file, text in sources.items():
            (Path(folder) / file).write_text(text, encoding="utf-8")
        units = sorted((file for file in sources if file.endswith(".c")), key=lambda f: (-len(sources[f]), f))
        with ThreadPoolExecutor(os.cpu_count()) as pool:  # the longest first
            list(pool.map(lambda f: _run([*command, *_effort(sources[f]), "-c", f], folder), units))
        _run([*command, "-shared", "-o", target.name, *(f"{Path(f).stem}.o" for f in units), "-lm"], folder)
        partial = target.with_name(f".{name}.{os.getpid()}.so")
        shutil.copyfile(Path(folder) / target.name, partial)
        partial.replace(target)
    return target


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
