"""What the designer page asks its server for, in a real browser: the search for better designs, and meshes as parts."""

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

WEB = Path(__file__).parents[2] / "web"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
NODE = shutil.which("node")


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """The address that a running designer prints."""
    command = [sys.executable, "-u", "-m", "seacrane.cli", "designer", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as designer:
        assert designer.stdout is not None
        printed = ""
        try:
            for line in designer.stdout:
                printed += line
                if found := re.search(r"http://\S+token=\S+", line):
                    yield found.group()
                    break
            else:
                pytest.fail(f"the designer ended before it printed an address: {printed}")
        finally:
            designer.send_signal(signal.SIGINT)
            designer.communicate(timeout=30)


def test_a_designer_searches_takes_a_design_of_the_front_and_undoes_it(address: str, tmp_path: Path) -> None:
    run("optimise.mjs", address, tmp_path)


def test_a_mesh_of_another_program_becomes_a_part_in_its_unit_or_is_refused(address: str, tmp_path: Path) -> None:
    run("mesh.mjs", address, tmp_path)


def run(script: str, address: str, output: Path) -> None:
    """Run a script of web/e2e in a browser against the server."""
    assert CHROMIUM, "needs Chromium; `make test` brings it"
    assert NODE, "needs Node 20"
    assert (WEB / "node_modules").is_dir(), "needs the page's packages; `make setup` brings them"
    environment = {**os.environ, "SEACRANE_URL": address, "CHROMIUM": CHROMIUM, "OUTPUT": str(output)}
    done = subprocess.run(
        [NODE, f"e2e/{script}"],
        check=False,
        cwd=WEB,
        env=environment,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stdout + done.stderr
