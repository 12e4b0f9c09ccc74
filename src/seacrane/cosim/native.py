"""The C master loop: compiled by the system's compiler on first use, then loaded from the cache."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import os
import shutil
import subprocess
import tempfile
from importlib import resources
from pathlib import Path

from seacrane.errors import CompileError

FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-ffp-contract=off")


@functools.cache
def library() -> ctypes.CDLL:
    """The compiled loop; `CompileError` if there is no compiler."""
    source = (resources.files("seacrane") / "native" / "master.c").read_text(encoding="utf-8")
    lib = ctypes.CDLL(str(_compiled(source)))
    lib.seacrane_run.argtypes = [ctypes.c_void_p, ctypes.c_int64]
    lib.seacrane_watch.argtypes = [ctypes.c_void_p]
    return lib


def _compiled(source: str) -> Path:
    folder = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "seacrane"
    target = folder / f"master-{hashlib.sha256((source + repr(FLAGS)).encode()).hexdigest()[:24]}.so"
    if target.exists():
        return target
    compiler = os.environ.get("CC") or shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    if compiler is None:
        raise CompileError.at("master.c", "no C compiler was found", hint="Install gcc or clang, or set CC.")
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as private:
        here = Path(private)
        (here / "master.c").write_text(source, encoding="utf-8")
        command = [compiler, *FLAGS, "-o", str(here / "master.so"), str(here / "master.c"), "-lm"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise CompileError.at("master.c", f"the compiler refused it: {done.stderr.strip()[-2000:]}")
        (here / "master.so").replace(target)
    return target
