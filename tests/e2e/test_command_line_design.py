"""`seacrane design` as a user runs it."""

from __future__ import annotations

import csv
import signal
import subprocess
import sys
import time
from pathlib import Path

import msgspec
import pytest

from seacrane import design, studies
from seacrane.cli import main
from seacrane.design import chart


def test_the_load_chart_goes_to_csv_with_the_published_loads(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "chart.csv"
    assert main(["design", "chart", "gunnerus-pk65", "--csv", str(out)]) == 0
    with out.open() as file:
        rows = {(row["mode"], float(row["radius_m"])): float(row["swl_t"]) for row in csv.DictReader(file)}
    assert rows["harbour", 4.0] == pytest.approx(15.1, rel=0.05)
    assert rows["hs2.0", 4.0] < rows["hs1.0", 4.0] < rows["harbour", 4.0]
    assert f"{out}: {len(rows)} rows" in capsys.readouterr().out


def test_the_load_chart_of_given_radii(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "chart.csv"
    command = ["design", "chart", "gunnerus-pk65", "--mode", "harbour", "--csv", str(out), "--radii"]
    assert main([*command, "20.3,4,90"]) == 0
    with out.open() as file:
        rows = [(float(row["radius_m"]), float(row["swl_t"])) for row in csv.DictReader(file)]
    assert rows == [(4.0, pytest.approx(15.1, rel=0.05)), (20.3, pytest.approx(2.1, rel=0.05))]
    for wrong in ("4;5", "", "-3", "inf"):
        with pytest.raises(SystemExit):
            main([*command, wrong])
        assert "are no radii; give numbers in m above 0, such as 4,20.3" in capsys.readouterr().err


def test_charts_are_printed_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "chart", "offshore-100t", "--mode", "harbour"]) == 0
    printed = capsys.readouterr().out
    assert "harbour    15.0 m" in printed
    assert "Not a certified load chart." in printed
    files = [tmp_path / "curves.svg", tmp_path / "section.png"]
    assert main(["design", "chart", "offshore-100t", "--plot", str(files[0]), "--section", str(files[1])]) == 0
    assert files[0].read_text().startswith("<?xml")
    assert files[1].read_bytes().startswith(b"\x89PNG")


def test_an_exported_design_is_checked_and_shown_like_any_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "a.zip"
    assert main(["design", "export", "a-frame-30t", "--out", str(out)]) == 0
    assert main(["design", "check", str(out)]) == 0
    assert main(["design", "show", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "design SHA-256" in printed
    assert "no problems" in printed
    assert "joint luff" in printed


def test_a_mode_that_is_not_there_is_an_error_with_the_modes(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "chart", "offshore-100t", "--mode", "hs9"]) == 2
    assert "allowed: harbour, hs1.0" in capsys.readouterr().err


def test_a_search_is_resumed_from_its_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec, front = tmp_path / "spec.json", tmp_path / "front.json"
    spec.write_text('{"variables": [{"path": "links[jib].length"}], "goals": [{"kind": "reach"}, {"kind": "weight"}]}')
    command = ["design", "optimise", "offshore-100t", "--front", str(front), "--population", "8"]
    assert main([*command, "--generations", "1"]) == 2
    assert "--spec: is needed to begin a search" in capsys.readouterr().err
    assert main([*command, "--spec", str(spec), "--generations", "1"]) == 0
    assert main([*command, "--generations", "2"]) == 0
    told = capsys.readouterr()
    assert "generation 2 of 2" in told.err
    assert "designs that none beats in every goal" in told.out
    kept = front.read_bytes()
    assert main(["design", "optimise", "a-frame-30t", "--front", str(front), "--generations", "3"]) == 2
    assert "is the front of another design (got 'offshore-100t'); allowed: a-frame-30t" in capsys.readouterr().err
    spec.write_text(spec.read_text().replace("reach", "weight"))
    assert main([*command, "--spec", str(spec), "--generations", "3"]) == 2
    assert "is the front of a search for other sizes or goals than --spec has" in capsys.readouterr().err
    for option, value, words in (
        ("--population", "9", "is the front of a search with another population (got 8)"),
        ("--seed", "2", "is the front of a search with another seed (got 1)"),
        ("--generations", "1", "has been passed by the front (got 1); allowed: 2 on"),
    ):
        assert main(["design", "optimise", "offshore-100t", "--front", str(front), option, value]) == 2
        assert words in capsys.readouterr().err
    assert front.read_bytes() == kept


def test_the_designs_of_a_front_are_written_and_lift_what_is_printed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    spec, folder = tmp_path / "spec.json", tmp_path / "found"
    spec.write_text(
        '{"variables": [{"path": "cylinders[boom_cylinder].bore", "low": "380 mm", "high": "450 mm"}],'
        ' "goals": [{"kind": "weight"}, {"kind": "capacity", "radius": 20}]}'
    )
    command = ["design", "optimise", "offshore-100t", "--spec", str(spec), "--front", str(tmp_path / "front.json")]
    assert main([*command, "--generations", "2", "--population", "6", "--designs", str(folder)]) == 0
    head, start, *rows, _, _ = capsys.readouterr().out.splitlines()
    assert head.split("  ")[-3:] == ["cylinders[boom_cylinder].bore [m]", "weight [t]", "capacity at 20 m, harbour [t]"]
    assert start.split()[:2] == ["start", "0.420"]
    assert len(list(folder.iterdir())) == len(rows) >= 2
    for row in rows:
        number, bore, _, load = row.split()
        crane = design.load(folder / f"{number}.json")
        assert crane.cylinder("boom_cylinder").bore == pytest.approx(float(bore), abs=5e-4)
        assert chart.curve(crane, radii=[20.0])[0].swl / 1e3 == pytest.approx(float(load), rel=0.01)


def test_a_search_in_which_nothing_can_be_built_says_why(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = tmp_path / "spec.json"
    spec.write_text(
        '{"variables": [{"path": "cylinders[boom_cylinder].bore", "low": 4, "high": 8}],'
        ' "goals": [{"kind": "weight"}, {"kind": "reach"}]}'
    )
    command = ["design", "optimise", "offshore-100t", "--spec", str(spec), "--front", str(tmp_path / "front.json")]
    assert main([*command, "--generations", "1", "--population", "4"]) == 1
    told = capsys.readouterr().out
    assert "none of the 4 candidates can be built" in told
    assert "boom_cylinder: its pins are" in told


def test_a_search_that_is_killed_or_interrupted_goes_on_to_the_same_end(tmp_path: Path) -> None:
    spec, whole, part = (tmp_path / name for name in ("spec.json", "whole.json", "part.json"))
    spec.write_text('{"variables": [{"path": "links[jib].length"}], "goals": [{"kind": "reach"}, {"kind": "weight"}]}')

    def command(front: Path, generations: int) -> list[str]:
        options = ["--spec", str(spec), "--front", str(front), "--generations", str(generations), "--population", "6"]
        return [sys.executable, "-m", "seacrane.cli", "design", "optimise", "offshore-100t", *options]

    for end in (signal.SIGKILL, signal.SIGINT):
        before = part.read_bytes() if part.exists() else b""
        with subprocess.Popen(command(part, 1000), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as search:
            patience = time.monotonic() + 120
            while not part.exists() or part.read_bytes() == before:
                assert time.monotonic() < patience, "no generation is written"
                time.sleep(0.02)
            search.send_signal(end)
            _, told = search.communicate(timeout=60)
        assert search.returncode != 0, "it was ended half-way"
    assert "has what was found; the same command goes on from there" in told
    generations = studies.read(part).generation + 2
    for front in (part, whole):
        subprocess.run(command(front, generations), check=True, capture_output=True, timeout=300)
    assert part.read_bytes() == whole.read_bytes()


def test_a_check_warns_of_what_is_hard_to_build_and_passes_what_is_shipped(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in design.names():
        assert main(["design", "check", name]) == 0
    assert capsys.readouterr().out == "".join(f"{name}: no problems\n" for name in design.names())
    crane = design.load("offshore-100t")
    thin = msgspec.structs.replace(crane.cylinder("boom_cylinder"), rod=0.12)
    design.save(msgspec.structs.replace(crane, cylinders=(thin, *crane.cylinders[1:])), tmp_path / "thin.json")
    assert main(["design", "check", str(tmp_path / "thin.json")]) == 0
    warning, verdict = capsys.readouterr().out.splitlines()
    assert warning.startswith("hard to build: boom_cylinder: it is only ")
    assert "against buckling" in warning
    assert verdict.endswith("thin.json: no problems")


@pytest.mark.skipif(not Path("/dev/full").is_char_device(), reason="there is no full device")
def test_a_chart_for_a_full_disk_is_an_error_in_words(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["design", "chart", "a-frame-30t", "--csv", "/dev/full"]) == 2
    assert capsys.readouterr().err == "seacrane: /dev/full: No space left on device\n"
