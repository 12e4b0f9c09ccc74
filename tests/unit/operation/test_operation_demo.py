"""The demo without a page: a report that says what ran, and clear refusals."""

import json

import pytest

from seacrane.cli import main
from seacrane.errors import ParameterError
from seacrane.operation import Sticks, demo
from seacrane.results import Recording

KEYS = {
    "simulated_s",
    "wall_s",
    "rtf",
    "macro_step_s",
    "slaves",
    "fmus",
    "energy_balance_error",
    "peak_power_residual_W",
    "joint_angles_deg",
    "cylinder_pressures_bar",
}


def test_a_headless_run_drives_the_recording_and_reports(tmp_path, capsys):
    report_file, csv = tmp_path / "report.json", tmp_path / "run.csv"
    assert main(["demo", "--headless", "--seconds", "10", "--report", str(report_file), "--csv", str(csv)]) == 0
    report = json.loads(report_file.read_text())
    assert set(report) >= KEYS
    assert report["simulated_s"] == pytest.approx(10.0)
    assert report["rtf"] == pytest.approx(report["wall_s"] / 10.0)
    assert len(report["fmus"]) == 4
    assert report["slaves"][0] == "ship"
    assert report["joint_angles_deg"]["luff"] > 51.0, "the recording raises the boom from 50 deg"
    assert "energy balance closes within" in capsys.readouterr().out
    recorded = Recording.read_csv(csv)
    assert recorded.time[-1] == pytest.approx(10.0)
    assert recorded["crane.luff"][-1] == pytest.approx(report["joint_angles_deg"]["luff"] * 3.141592653589793 / 180)


def test_a_paced_run_takes_the_time_it_simulates():
    report = demo.run_headless(demo.Settings(step=0.005), 1.0, realtime=True)
    assert report["wall_s"] == pytest.approx(1.0, abs=0.3)
    assert report["overruns"] >= 0
    assert report["late_ms_p99"] >= 0


def test_a_crane_of_another_type_has_its_own_axes_and_is_driven_by_the_recording_too():
    simulation = demo.Demo(crane="a-frame-30t", sea="calm")
    with simulation.execution:
        assert simulation.describe()["axes"] == ["frame", "leg", "hoist"]
        assert simulation.describe()["load"]["mass"] == pytest.approx(simulation.start.load)
    report = demo.run_headless(demo.Settings(crane="a-frame-30t", sea="calm"), 20.0)
    assert set(report["joint_angles_deg"]) == {"luff"}
    assert set(report["joint_slides_m"]) == {"telescope"}
    assert set(report["cylinder_pressures_bar"]) == {"frame_cylinder", "leg_cylinder"}
    assert abs(report["joint_slides_m"]["telescope"] - simulation.start.posture["telescope"]) > 0.01
    assert " m\n" in demo.summary(report)


def test_it_describes_itself_for_a_page():
    simulation = demo.Demo(sea="jonswap", hs=2.0)
    with simulation.execution as run:
        description = simulation.describe()
        json.dumps(description)
        names = [v["name"] for v in description["variables"]]
        assert len(description["sea"]["waves"]) == 200
        assert description["crane"]["name"] == "offshore-100t"
        assert {"crane.luff", "ship.qw", "boom_drive.cylinder.pressure_a", "boom_bond.residual"} <= set(names)
        run.start()
        assert len(run.values(names)) == len(names)
        pressure = next(v for v in description["variables"] if v["name"] == "boom_drive.cylinder.pressure_a")
        assert (pressure["unit"], pressure["shown"], pressure["factor"]) == ("Pa", "bar", 1e-5)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["--load", "-3"], "load: -3000 kg is out of range; allowed: 100 to 200000 kg"),
        (["--step", "50"], "step: 0.05 s is out of range"),
        (["--seconds", "0"], "seconds: must be a time above zero"),
        (["--crane", "offshore-10t"], "offshore-100t"),
    ],
)
def test_bad_input_is_refused_by_name_with_a_status_other_than_zero(arguments, says, capsys):
    assert main(["demo", "--headless", *arguments]) == 2
    assert says in capsys.readouterr().err


def test_a_recorded_joystick_repeats_and_is_checked():
    sticks = Sticks.shipped("manoeuvre")
    assert sticks.at(4.0) == sticks.at(4.0 + sticks.length)
    assert sticks.at(4.0)[0]["hoist"] == pytest.approx(0.6)
    assert sticks.at(4.0)[1]
    assert not sticks.at(59.0)[1]
    with pytest.raises(ParameterError, match="manoeuvre"):
        Sticks.shipped("maneuver")
    with pytest.raises(ParameterError, match="deadman: is not in the recording"):
        Sticks(Recording(sticks.recording.time, {n: s for n, s in sticks.recording.signals.items() if n != "deadman"}))
