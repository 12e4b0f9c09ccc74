"""The scenario of a stuck spool, on the crane that it is written for."""

from pathlib import Path

from seacrane import cosim, design, plant
from seacrane.units import deg

EXAMPLE = Path(__file__).parents[2] / "examples" / "stuck_spool.json"


def test_the_boom_with_a_stuck_spool_is_stopped_where_the_scenario_says(tmp_path):
    with cosim.Execution(plant.build(design.load("offshore-100t")), cosim.GaussSeidel(0.002)) as run:
        scenario = cosim.scenario.load(EXAMPLE, run.variables)
        run.follow(scenario)
        run.record_file(tmp_path / "boom.arrow", ["crane.luff", "crane.luff_rate", "boom_drive.spool"], every=0.01)
        run.advance(20.0)
        run.flush()
        recording = cosim.RecordedSlave(tmp_path / "boom.arrow")
    luff, rate, spool = recording.at(7.0)
    assert (50 * deg < luff < 58 * deg, rate > 0.5 * deg, spool) == (True, True, 0.6)
    luff, rate, spool = recording.at(20.0)
    # The oil and the load give a little after the spool has shut.
    assert abs(luff - 58 * deg) < 0.2 * deg
    assert (abs(rate) < 0.01 * deg, spool) == (True, 0.0)
