"""The example that exports a crane: what it writes fits together, and runs coupled as the plant does."""

import runpy
from pathlib import Path

import pytest

from seacrane import fmi

EXAMPLE = Path(__file__).parents[2] / "examples" / "crane_fmus.py"


def test_every_power_bond_of_a_drive_has_its_like_at_the_crane(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runpy.run_path(str(EXAMPLE))["main"](["--out", str(tmp_path / "new"), "--version", "3.0"])
    fmus = {path.stem: fmi.read(path) for path in sorted((tmp_path / "new").iterdir())}
    assert list(fmus) == ["boom_drive", "crane", "jib_drive", "slew_drive", "winch_drive"]
    assert {d.fmi_version for d in fmus.values()} == {"3.0"}
    assert f"{tmp_path / 'new' / 'boom_drive.fmu'}: 11 states" in capsys.readouterr().out
    crane = {terminal.name: terminal for terminal in fmus["crane"].terminals}
    assert {"boom_cylinder", "jib_cylinder", "slew", "drum", "foot_x", "foot_rz"} <= crane.keys()
    for drive, place in (
        ("boom_drive", "boom_cylinder"), ("jib_drive", "jib_cylinder"), ("slew_drive", "slew"), ("winch_drive", "drum"),
    ):  # fmt: skip
        (terminal,) = fmus[drive].terminals
        assert (terminal.kind, terminal.members.keys()) == (crane[place].kind, crane[place].members.keys())
        given = {v.name for v in fmus[drive].inputs}
        taken = {v.name for v in fmus["crane"].inputs}
        for member, variable in terminal.members.items():
            assert (variable in given) != (crane[place].members[member] in taken), "one gives what the other takes"
