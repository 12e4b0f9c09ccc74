"""The crane as an SSP archive: it runs as the plant it was made of, and other tools read it."""

import json
import runpy
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.ssd import find_components, read_ssd

from seacrane import cosim, design, plant
from seacrane.cli import main
from seacrane.results import Recording

EXAMPLE = Path(__file__).parents[2] / "examples" / "crane_ssp.py"
SIGNALS = ["crane.luff", "boom_drive.rod_force", "crane.rope.tension"]


@pytest.fixture(scope="module")
def archive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("crane") / "offshore-100t.ssp"
    runpy.run_path(str(EXAMPLE))["main"](["--out", str(path)])
    return path


def test_the_archive_runs_from_the_command_line_as_the_plant_does_in_python(archive: Path, capsys) -> None:
    file = archive.parent / "boom.csv"
    options = ["--until", "1", "--set", "spool.boom=0.5", "--signals", ",".join(SIGNALS), "--record", str(file)]
    assert main(["run", str(archive), *options]) == 0
    said = capsys.readouterr()
    assert "offshore-100t: 1 s simulated, gauss-seidel, 500 macro steps of 0.002 s" in said.out
    assert (
        "3 inputs are not connected and keep their start values: slew_drive.spool, jib_drive.spool, winch_drive.spool"
        in said.err
    )
    recording = Recording.read_csv(file)

    system = runpy.run_path(str(EXAMPLE))["without_operator"](plant.build(design.load("offshore-100t")))
    with cosim.Execution(system, cosim.GaussSeidel(0.002)) as run:
        run.set("boom_drive.spool", 0.5)
        recorder = run.record(SIGNALS)
        run.run(1.0)
        expected = recorder.recording()
    assert np.rad2deg(np.ptp(recording["crane.luff"])) > 0.5
    for name in SIGNALS:
        np.testing.assert_allclose(recording[name], expected[name], rtol=1e-9)


def test_the_bond_that_limits_the_step_is_found_from_the_command_line(archive: Path, tmp_path: Path, capsys) -> None:
    options = ["--until", "0.5", "--steps", "0.002,0.004,0.008", "--algorithms", "gauss-seidel,newton"]
    moved = ["--set", "spool.boom=0.5", "--set", "spool.winch=0.3"]
    files = ["--json", str(tmp_path / "d.json"), "--plot", str(tmp_path / "d.svg")]
    assert main(["diagnose", str(archive), *options, *moved, *files]) == 0
    said = capsys.readouterr().out
    assert "The bond winch_bond limits the step" in said
    assert "no power passed through foot_x" in said
    found = json.loads((tmp_path / "d.json").read_text())
    assert found["limiting_bond"] == "winch_bond"
    assert {t["algorithm"] for t in found["trials"]} == {"gauss-seidel", "newton"}
    assert (tmp_path / "d.svg").stat().st_size > 10_000

    assert main(["diagnose", str(archive), "--until", "0.5", "--algorithms", "newtn"]) == 2
    assert "Did you mean 'newton'?" in capsys.readouterr().err


def test_fmpy_finds_the_schema_kept_and_every_part_in_its_place(archive: Path) -> None:
    description = read_ssd(str(archive))
    names = ["boom_drive", "crane", "jib_drive", "ship", "slew_drive", "winch_drive"]
    assert sorted(c.name for c in find_components(description.system)) == names
    assert {c.name: c.kind for c in description.system.connectors} == {
        f"spool.{drive}": "input" for drive in ("slew", "boom", "jib", "winch")
    }
