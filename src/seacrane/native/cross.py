"""Shared libraries for other platforms, and WebAssembly modules, from this machine and offline.

Their compiler comes with the optional extra `export`: `ziglang` is the Zig compiler as a Python package, and its
`zig cc` is clang with the C libraries of many systems.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Final

from seacrane.errors import CompileError
from seacrane.native import FLAGS, cache_folder, source


@dataclass(frozen=True)
class Target:
    """A platform to compile for: what zig calls it, and the suffix of its shared libraries."""

    triple: str
    suffix: str


TARGETS: Final = {
    "x86_64-linux": Target("x86_64-linux-gnu.2.17", "so"),
    "aarch64-linux": Target("aarch64-linux-gnu.2.17", "so"),
    "x86_64-windows": Target("x86_64-windows-gnu", "dll"),
    "x86_64-darwin": Target("x86_64-macos.11.0", "dylib"),
    "aarch64-darwin": Target("aarch64-macos.11.0", "dylib"),
}
"""The platforms that can be exported for, by their names in FMI 3.0; Linux with a C library of 2012 or later."""

_WINDOWS_LIBRARY: Final = (
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "asinh", "acosh", "atanh", "exp",
    "log", "log10", "log1p", "expm1", "pow", "sqrt", "fabs", "floor", "ceil", "fmod", "fmin", "fmax", "hypot",
    "copysign", "erf", "erfc", "cbrt", "round", "trunc", "calloc", "malloc", "free", "memcpy", "memset", "memmove",
    "memcmp", "strlen", "strcmp", "__stdio_common_vsprintf",
)  # fmt: skip
"""What the models and the core use of ucrtbase.dll."""


def build_all(
    platforms: Iterable[str], name: str, sources: Mapping[str, str], flags: Iterable[str] = ()
) -> dict[str, Path]:
    """The library `name` for each platform, from the cache or compiled, two at a time.

    Raises `CompileError` if the extra `export` is not installed, or with the first command that failed.
    """
    _require_zig("platforms")
    names = list(platforms)
    with ThreadPoolExecutor(2) as pool:
        return dict(zip(names, pool.map(lambda p: _build(p, name, sources, tuple(flags)), names), strict=True))


def build_module(name: str, sources: Mapping[str, str], exports: Iterable[str], flags: Iterable[str]) -> Path:
    """The WebAssembly module `name` that exports these C functions and its memory and imports nothing.

    Raises `CompileError` if the extra `export` is not installed, or with the command that failed.
    """
    _require_zig("wasm")
    files = {**sources, **source("wasm.c")}
    file = f"{name}.wasm"
    # Small, as it is loaded over a network; measured, it is no slower than -O2. A reactor is a module without
    # main, which asks nothing of the system.
    command = ["cc", "-target", "wasm32-wasi", *(f for f in FLAGS if f != "-fPIC"), *flags, "-Os", "-flto", "-g0", "-s"]
    command += ["-Dvsnprintf=seacrane_format", "-mexec-model=reactor", "-Wl,-z,stack-size=65536"]
    command += [*(f"-Wl,--export={function}" for function in exports), "-o", file]
    return _compiled(file, files, [[*command, *sorted(f for f in files if f.endswith(".c"))]])


def _require_zig(wanted: str) -> None:
    if importlib.util.find_spec("ziglang") is None:
        raise CompileError.at(
            wanted,
            "compiling for other platforms needs the package ziglang, which is not installed",
            hint="pip install seacrane[export]",
        )


def _build(platform: str, name: str, sources: Mapping[str, str], flags: tuple[str, ...]) -> Path:
    target = TARGETS[platform]
    files = dict(sources)
    file = f"{name}.{target.suffix}"
    command = ["cc", "-target", target.triple, *FLAGS, *flags, "-g0", "-s", "-shared", "-o", file]
    commands = [command]
    units = sorted(f for f in files if f.endswith(".c"))
    if platform.endswith("windows"):
        files |= source("windows.c")
        files["system.def"] = "LIBRARY ucrtbase.dll\nEXPORTS\n" + "\n".join(_WINDOWS_LIBRARY) + "\n"
        command.remove("-fPIC")
        # zig would first build a C library, for minutes: link to the system's through a list of its functions.
        command += [*units, "windows.c", "system.a", "-nostdlib", "-fno-stack-protector", "-fno-builtin"]
        command += ["-Wl,--entry=DllMainCRTStartup", "-isystem", str(_windows_headers())]
        commands.insert(0, ["dlltool", "-m", "i386:x86-64", "-d", "system.def", "-D", "ucrtbase.dll", "-l", "system.a"])
    else:
        command += [*units, "-lm"]
    if platform.endswith("darwin"):
        command.append(f"-Wl,-install_name,@rpath/{file}")  # otherwise the path on this machine
    return _compiled(file, files, commands)


def _compiled(file: str, files: Mapping[str, str], commands: list[list[str]]) -> Path:
    """What zig's `commands` make of `files`, from the cache or made; it appears there complete or not at all."""
    key = hashlib.sha256(repr((version("ziglang"), commands, sorted(files.items()))).encode()).hexdigest()
    result = cache_folder() / key[:32] / file
    if result.exists():
        return result
    result.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="seacrane-") as folder:
        for each, text in files.items():
            (Path(folder) / each).write_text(text, encoding="utf-8")
        for command in commands:
            _zig(command, folder)
        partial = result.with_name(f".{file}.{os.getpid()}")
        partial.write_bytes((Path(folder) / file).read_bytes())
        partial.replace(result)
    return result


def _windows_headers() -> Path:
    """The headers of Windows' C library in zig; `-nostdlib` leaves them out."""
    found = importlib.util.find_spec("ziglang")
    assert found is not None  # build_all has looked
    assert found.origin is not None
    return Path(found.origin).parent / "lib" / "libc" / "include" / "any-windows-any"


def _zig(arguments: list[str], folder: str) -> None:
    command = [sys.executable, "-m", "ziglang", *arguments]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        said = (done.stderr + done.stdout).strip()
        raise CompileError.at(arguments[0], f"the compiler failed: zig {' '.join(arguments)}\n{said[-4000:]}")
