"""The compiled load chart of the designer's page."""

import importlib.util
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the extra `export` (ziglang) is not installed")
@pytest.mark.skipif(shutil.which("make") is None, reason="make is not installed")
def test_the_module_in_the_repository_is_what_its_source_compiles_to(tmp_path: Path) -> None:
    subprocess.run(["make", "-s", "load-chart", f"CHART={tmp_path}/fresh"], cwd=ROOT, check=True, capture_output=True)
    kept = ROOT / "web/core/design/loadChart.wasm"
    assert (tmp_path / "fresh.wasm").read_bytes() == kept.read_bytes(), "run `make load-chart` and commit the result"
