"""The dissertation's figures, by the scripts that a user runs."""

import importlib.util
import sys
from pathlib import Path

import numpy as np
import pytest

from seacrane.results import Recording
from seacrane.units import bar

EXAMPLES = Path(__file__).parents[2] / "examples" / "dissertation"


def script(name):
    if str(EXAMPLES) not in sys.path:
        sys.path.insert(0, str(EXAMPLES))  # where a script finds its siblings
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def manipulation(tmp_path_factory):
    module = script("manual_manipulation")
    folder = tmp_path_factory.mktemp("figures")
    module.main(["--out", str(folder)])
    return module, folder, Recording.read_csv(folder / "manual_manipulation.csv")


def test_the_figures_are_written(manipulation):
    module, folder, recording = manipulation
    for name in module.FIGURES:
        assert (folder / f"{name}.svg").read_text().lstrip().startswith("<?xml")
    assert recording.time[-1] == pytest.approx(40.0)


def test_piston_speed_follows_the_sign_of_the_stick(manipulation):
    module, _, r = manipulation
    inside = (r["actual displacement"] > 0.01) & (r["actual displacement"] < module.Drive().stroke - 0.01)
    pushed = inside & (np.abs(r["gain"]) > 0.15)
    # The spool needs some 20 ms to follow: right at a reversal the piston still goes the old way.
    agree = np.sign(r["actual speed"][pushed]) == np.sign(r["gain"][pushed])
    assert pushed.sum() > 2000
    assert agree.mean() > 0.99


def test_the_piston_stops_in_its_bumper_while_the_stick_is_still_positive(manipulation):
    module, _, r = manipulation
    d = module.Drive()
    first, second = module.stops(r, d)
    assert first[0] == pytest.approx(8.0, abs=1.0)
    assert second[0] == pytest.approx(35.0, abs=1.0)
    assert r["actual displacement"].max() == pytest.approx(d.stroke + d.bumper, abs=0.001)
    for begin, end in (first, second):
        settled = r.between(begin + 0.5, end - 0.2)
        assert settled["piston-side pressure"] == pytest.approx(np.full(len(settled), d.supply), rel=0.01)
        assert np.abs(settled["rod-side pressure"]).max() < 1 * bar
        assert np.abs(settled["actual speed"]).max() < 1e-3


def test_reference_and_actual_motion_agree_within_the_coupling_error(manipulation):
    _, _, r = manipulation
    assert np.abs(r["reference displacement"] - r["actual displacement"]).max() < 1e-3
