"""What a user types, in a process of its own: bad input gets a clear error, a status, and leaves nothing behind."""

import json
import socket
import subprocess
import sys
import zipfile
from importlib import resources
from pathlib import Path

import pytest

from seacrane import fmi
from seacrane.library import signals
from seacrane.model import Diagram

SEACRANE = [str(Path(sys.executable).with_name("seacrane"))]


def seacrane(*arguments, cwd):
    return subprocess.run([*SEACRANE, *arguments], cwd=cwd, capture_output=True, text=True, timeout=120, check=False)


@pytest.fixture
def crane():
    text = (resources.files("seacrane.design") / "cranes" / "offshore-100t.json").read_text()
    return json.loads(text)


def test_every_fault_of_a_design_file_is_named_and_no_report_is_written(crane, tmp_path):
    crane["links"][2]["mass"] = "-24 t"
    crane["cylinders"][0]["bore"] = "420 kg"
    crane["cylinders"][1]["moves"] = "jibb"
    crane["hoist"]["colour"] = "red"
    del crane["links"][1]["joint"]
    (tmp_path / "bad.json").write_text(json.dumps(crane))
    run = seacrane("demo", "--headless", "--crane", "bad.json", "--report", "report.json", cwd=tmp_path)
    assert run.returncode == 2
    assert "Traceback" not in run.stderr
    for text in (
        "links[jib].mass: must be above 0",
        "cylinders[boom_cylinder].bore: cannot be given in 'kg'",
        "hoist.colour: is not a field here",
        "links[boom].joint: is missing",
    ):
        assert text in run.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["bad.json"]


def test_a_design_may_be_checked_by_itself(crane, tmp_path):
    (tmp_path / "crane.json").write_text(json.dumps(crane))
    run = seacrane("design", "check", "crane.json", cwd=tmp_path)
    assert (run.returncode, run.stdout.strip()) == (0, "crane.json: no problems")
    crane["cylinders"][1]["moves"] = "jibb"
    (tmp_path / "crane.json").write_text(json.dumps(crane))
    run = seacrane("design", "check", "crane.json", cwd=tmp_path)
    assert run.returncode == 1
    assert "Did you mean 'jib'?" in run.stdout
    assert "crane.json: 1 problem" in run.stdout


@pytest.fixture
def fmu(tmp_path):
    diagram = Diagram("constant")
    diagram.expose(y=diagram.add("source", signals.Constant(value=3.0)).y)
    return fmi.export(diagram, tmp_path / "constant.fmu")


def test_a_sound_fmu_has_no_problems(fmu, tmp_path):
    run = seacrane("fmu", "check", fmu.name, cwd=tmp_path)
    assert (run.returncode, run.stdout.strip()) == (0, "constant.fmu: no problems")


def test_what_is_no_fmu_says_why(fmu, tmp_path):
    (tmp_path / "text.fmu").write_text("hello")
    (tmp_path / "cut.fmu").write_bytes(fmu.read_bytes()[:-200])
    with zipfile.ZipFile(fmu) as whole, zipfile.ZipFile(tmp_path / "other.fmu", "w") as other:
        for name in whole.namelist():
            other.writestr(name.replace("linux64", "win64").replace(".so", ".dll"), whole.read(name))
    for name, says in (
        ("text.fmu", "is not a ZIP archive"),
        ("cut.fmu", "ZIP"),
        ("other.fmu", "linux64"),
        ("none.fmu", "cannot be read"),
    ):
        run = seacrane("fmu", "check", name, cwd=tmp_path)
        assert run.returncode == 1, name
        assert says in run.stdout, name
        assert "Traceback" not in run.stderr


def test_a_port_that_is_used_is_named_with_the_cure(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        run = seacrane("demo", "--port", str(taken.getsockname()[1]), "--tcp-port", "0", cwd=tmp_path)
    assert run.returncode == 2
    assert "is used by another program. End that program or choose another port" in run.stderr


def test_an_address_that_others_can_reach_needs_to_be_allowed(tmp_path):
    run = seacrane("demo", "--host", "0.0.0.0", cwd=tmp_path)
    assert run.returncode == 2
    assert "can be reached from other machines" in run.stderr


def test_a_report_that_cannot_be_written_is_refused_before_the_run(tmp_path):
    run = seacrane("demo", "--headless", "--report", "missing/report.json", cwd=tmp_path)
    assert run.returncode == 2
    assert "give a file in a folder that exists" in run.stderr
