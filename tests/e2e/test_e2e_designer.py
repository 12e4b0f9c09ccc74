"""The designer as its user meets it: the command, its page in a real browser, files out and in again."""

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
                found = re.search(r"http://\S+token=\S+", line)
                if found:
                    yield found.group()
                    break
            else:
                pytest.fail(f"the designer ended before it printed an address: {printed}")
        finally:
            designer.send_signal(signal.SIGINT)
            designer.communicate(timeout=30)


def test_a_designer_creates_drags_undoes_saves_and_exports_a_crane_in_a_real_browser(
    address: str, tmp_path: Path
) -> None:
    assert CHROMIUM, "needs Chromium; `make test` brings it"
    assert NODE, "needs Node 20"
    assert (WEB / "node_modules").is_dir(), "needs the page's packages; `make setup` brings them"
    environment = {**os.environ, "SEACRANE_URL": address, "CHROMIUM": CHROMIUM, "OUTPUT": str(tmp_path)}
    done = subprocess.run(
        [NODE, "e2e/designer.mjs"],
        check=False,
        cwd=WEB,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout + done.stderr
