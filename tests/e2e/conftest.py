"""Servers as a user starts them, and scripts of web/e2e that drive a real browser against them."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

WEB = Path(__file__).parents[2] / "web"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
NODE = shutil.which("node")


@contextmanager
def serving(*arguments: str) -> Iterator[str]:
    """The address that `seacrane` prints with these arguments, while it runs."""
    command = [sys.executable, "-u", "-m", "seacrane.cli", *arguments]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as server:
        assert server.stdout is not None
        printed = ""
        try:
            for line in server.stdout:
                printed += line
                if found := re.search(r"http://\S+token=\S+", line):
                    yield found.group()
                    break
            else:
                pytest.fail(f"`seacrane {arguments[0]}` ended before it printed an address: {printed}")
        finally:
            server.send_signal(signal.SIGINT)
            server.communicate(timeout=30)


@pytest.fixture(scope="module")
def designer() -> Iterator[str]:
    """The address of a running designer."""
    with serving("designer", "--port", "0") as address:
        yield address


@pytest.fixture(scope="module")
def demo() -> Iterator[str]:
    """The address of a running demo."""
    with serving("demo", "--port", "0", "--tcp-port", "0") as address:
        yield address


@pytest.fixture
def browse(tmp_path: Path) -> Callable[..., Any]:
    """Runs a script of web/e2e against an address and gives what it saw (None if it writes nothing).

    Further arguments go to the script; its downloads and screenshots to `tmp_path`.
    """

    def run(script: str, address: str, *arguments: str) -> Any:
        assert CHROMIUM, "needs Chromium; `make test` brings it"
        assert NODE, "needs Node 20"
        assert (WEB / "node_modules").is_dir(), "needs the page's packages; `make setup` brings them"
        done = subprocess.run(
            [NODE, f"e2e/{script}", *arguments],
            check=False,
            cwd=WEB,
            env={**os.environ, "SEACRANE_URL": address, "CHROMIUM": CHROMIUM, "OUTPUT": str(tmp_path)},
            capture_output=True,
            text=True,
            timeout=600,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        seen = tmp_path / "seen.json"
        return json.loads(seen.read_text()) if seen.exists() else None

    return run
