"""The demo as its user meets it: the command, its page in a real browser, keys, plots and downloads."""

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
    """The address that a running demo prints."""
    command = [sys.executable, "-u", "-m", "seacrane.cli", "demo", "--port", "0", "--tcp-port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as demo:
        assert demo.stdout is not None
        printed = ""
        try:
            for line in demo.stdout:
                printed += line
                found = re.search(r"http://\S+token=\S+", line)
                if found:
                    yield found.group()
                    break
            else:
                pytest.fail(f"the demo ended before it printed an address: {printed}")
        finally:
            demo.send_signal(signal.SIGINT)
            demo.communicate(timeout=30)


def test_an_operator_drives_plots_and_downloads_in_a_real_browser(address: str) -> None:
    assert CHROMIUM, "needs Chromium; `make test` brings it"
    assert NODE, "needs Node 20"
    assert (WEB / "node_modules").is_dir(), "needs the page's packages; `make setup` brings them"
    environment = {**os.environ, "SEACRANE_URL": address, "CHROMIUM": CHROMIUM}
    done = subprocess.run(
        [NODE, "e2e/operate.mjs"],
        check=False,
        cwd=WEB,
        env=environment,
        capture_output=True,
        text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stdout + done.stderr
