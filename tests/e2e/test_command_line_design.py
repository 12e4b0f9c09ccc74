"""`seacrane design` as a user runs it."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from seacrane.cli import main


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
    assert front.read_bytes() == kept
