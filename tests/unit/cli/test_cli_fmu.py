"""`seacrane fmu export`: what it writes, says and refuses."""

from __future__ import annotations

import importlib.util
import zipfile
from pathlib import Path

import pytest
from fmpy.validation import validate_fmu

from seacrane import fmi
from seacrane.cli import main
from seacrane.fmi.platforms import this_platform
from seacrane.model import load
from seacrane.results import Recording

BOOM_DRIVE = Path(__file__).parents[3] / "examples" / "boom_drive.json"


def test_a_model_file_becomes_an_fmu_and_the_last_line_says_what_was_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "boom.fmu"
    assert main(["fmu", "export", str(BOOM_DRIVE), "--version", "3.0", "--sources", "--out", str(out)]) == 0
    said = capsys.readouterr()
    assert said.out.startswith(f"{out}: FMI 3.0 for co-simulation and model exchange; 3 inputs, 2 outputs, ")
    assert f"; {this_platform()}; C sources; " in said.out
    assert said.err.splitlines() == ["boom.fmu: writing the equations as C", "boom.fmu: compiling for this machine"]
    assert validate_fmu(str(out)) == [] == fmi.check(out)
    assert fmi.read(out).fmi_version == "3.0"
    assert main(["fmu", "info", str(out)]) == 0
    assert "sources    C\n" in capsys.readouterr().out


@pytest.mark.skipif(importlib.util.find_spec("ziglang") is None, reason="the extra `export` (ziglang) is not installed")
def test_only_the_platforms_of_a_list_are_written_and_no_sources(tmp_path: Path) -> None:
    out = tmp_path / "boom.fmu"
    platforms = "x86_64-linux,aarch64-linux"
    assert main(["fmu", "export", str(BOOM_DRIVE), "--platforms", platforms, "--out", str(out)]) == 0
    with zipfile.ZipFile(out) as archive:
        names = archive.namelist()
    assert sorted(n for n in names if n.startswith("binaries/")) == [
        "binaries/aarch64-linux/boom_drive.so",
        "binaries/linux64/boom_drive.so",
    ]
    assert not [n for n in names if n.startswith("sources/")]


def test_what_cannot_be_exported_is_refused_and_nothing_is_written(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "boom.fmu"
    assert main(["fmu", "export", str(BOOM_DRIVE), "--platforms", "x86_64-linx,amiga", "--out", str(out)]) == 2
    problems = capsys.readouterr().err
    assert "platforms: is none that can be exported for (got 'x86_64-linx')" in problems
    assert "allowed: host, all, or some of x86_64-linux" in problems
    assert "'amiga'" in problems
    assert main(["fmu", "export", str(tmp_path / "boom.json"), "--out", str(out)]) == 2
    assert "boom.json" in capsys.readouterr().err
    for wrong in (["--version", "1.0", "--out", str(out)], [], ["--out", str(tmp_path / "nowhere" / "x.fmu")]):
        with pytest.raises(SystemExit):
            main(["fmu", "export", str(BOOM_DRIVE), *wrong])
    assert list(tmp_path.iterdir()) == []


def test_a_plot_of_a_kind_that_cannot_be_drawn_is_refused_and_none_is_left(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "boom.fmu"
    main(["fmu", "export", str(BOOM_DRIVE), "--out", str(out)])
    command = ["fmu", "run", str(out), "--until", "0.1", "--plot", str(tmp_path / "boom.xyz")]
    with pytest.raises(SystemExit) as left:
        main(command)
    assert left.value.code == 2
    assert "boom.xyz' is of no kind of picture; give a name in .svg, .png or .pdf" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["boom.fmu"]


def test_start_values_are_taken_in_any_unit_of_their_kind_and_all_wrong_ones_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fmu, csv = tmp_path / "boom.fmu", tmp_path / "run.csv"
    fmi.export(load(BOOM_DRIVE), fmu)
    run = ["fmu", "run", str(fmu), "--until", "0.01", "--signals", "pump.pressure,spool", "--csv", str(csv)]
    assert main([*run, "--set", "pump.pressure=210 bar", "--set", "spool=40 %"]) == 0
    recording = Recording.read_csv(csv)
    assert (recording["pump.pressure"][-1], recording["spool"][-1]) == (210e5, 0.4)
    capsys.readouterr()
    assert main([*run, "--set", "pump.pressure=210 mm", "--set", "spol=1", "--set", "spool=half"]) == 2
    problems = capsys.readouterr().err
    assert "pump.pressure: a quantity in 'mm' cannot be given in 'Pa'" in problems
    assert "spol: no such variable. Did you mean 'spool'" in problems
    assert "(got 'half')" in problems
