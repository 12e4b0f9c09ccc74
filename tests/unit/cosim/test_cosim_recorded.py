import numpy as np
import pytest

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, RecordedSlave, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable
from seacrane.results import Recording, Signal


def recording(times=(0.0, 0.5, 1.0), values=(0.0, 1.0, -1.0)) -> Recording:
    return Recording(
        np.array(times),
        {"pump.p": Signal("Pa", "bar", 1e5 * np.array(values)), "x": Signal("mm", "mm", np.array(values))},
    )


def played(slave, until=1.0, step=0.125, name="x", **options):
    with Execution(System("s", {"data": slave}), GaussSeidel(step), **options) as run:
        result = run.run(until)
    return result[f"data.{name}"].tolist()


@pytest.mark.parametrize("loop", ["c", "python"])
def test_linear_interpolation_lies_on_the_line_and_holding_on_the_earlier_row(loop):
    line = [0.0, 0.25, 0.5, 0.75, 1.0, 0.5, 0.0, -0.5, -1.0]
    assert played(RecordedSlave(recording()), loop=loop) == line
    held = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, -1.0]
    assert played(RecordedSlave(recording(), interpolation="hold"), loop=loop) == held


def test_a_row_is_met_exactly_whatever_the_step():
    times = 0.1 * np.arange(31)
    slave = RecordedSlave(recording(times, np.arange(31.0)), interpolation="hold")
    assert played(slave, until=3.0, step=0.1) == list(range(31))


def test_a_jump_is_two_rows_of_one_time():
    slave = RecordedSlave(recording((0.0, 0.5, 0.5, 1.0), (0.0, 0.0, 1.0, 1.0)))
    assert played(slave, step=0.25) == [0.0, 0.0, 1.0, 1.0, 1.0]


def test_outside_its_range_it_fails_or_holds_as_it_was_told():
    run = Execution(System("s", {"data": RecordedSlave(recording())}), GaussSeidel(0.25))
    with pytest.raises(CosimError) as caught:
        run.advance(2.0)
    assert str(caught.value) == (
        "data: failed in the step from t = 1 to 1.25 s: "
        "CosimError: 1.25 s lies outside the recording; allowed: 0 to 1 s"
    )
    assert played(RecordedSlave(recording(), outside="hold"), until=2.0, step=0.5) == [0.0, 1.0, -1.0, -1.0, -1.0]
    early = RecordedSlave(recording((1.0, 1.5, 2.0)), outside="hold")
    assert played(early, until=2.0, step=0.5) == [0.0, 0.0, 0.0, 1.0, -1.0]


def test_time_may_be_shifted():
    assert played(RecordedSlave(recording((10.0, 10.5, 11.0)), shift=10.0), step=0.5) == [0.0, 1.0, -1.0]


@pytest.mark.parametrize("name", ["data.csv", "data.parquet"])
def test_units_of_a_file_are_converted_at_the_connection(tmp_path, name):
    recording().to_csv(tmp_path / "data.csv")
    recording().to_parquet(tmp_path / "data.parquet")
    system = System("s", {"data": RecordedSlave(tmp_path / name, ["x"])})
    system.add("f", FunctionSlave(lambda t, h, u: u, [Variable("u", "m")], [Variable("y", "m")]))
    system.connect("data.x", "f.u")
    with Execution(system, GaussSeidel(0.5)) as run:
        assert run.run(1.0)["f.y"] == pytest.approx([0.0, 1e-3, -1e-3])


def test_what_a_run_recorded_drives_another_one(tmp_path):
    source = FunctionSlave(lambda t, h, u: [np.sin(t + h)], outputs=[Variable("y")])
    with Execution(System("s", {"f": source}), GaussSeidel(0.01)) as run:
        run.record_file(tmp_path / "run.arrow")
        run.advance(1.0)
        expected = run.values(["f.y"])[0]
    system = System("replay", {"data": RecordedSlave(tmp_path / "run.arrow")})
    with Execution(system, GaussSeidel(0.01)) as run:
        run.advance(1.0)
        assert run.values(["data.f.y"])[0] == expected


def test_all_that_is_wrong_is_told_at_once():
    bad = recording((0.0, 2.0, 1.0), (0.0, np.nan, 1.0))
    with pytest.raises(CosimError) as caught:
        RecordedSlave(bad, ["x", "y"], interpolation="cubic", outside="repeat")
    assert [str(p) for p in caught.value.problems] == [
        "interpolation: is none of these (got 'cubic'); allowed: linear, hold",
        "outside: is none of these (got 'repeat'); allowed: error, hold",
        "recording: time goes back from 2 to 1 s",
        "x: is not finite at 2 s (got nan)",
        "y: no such signal in the recording. Known: pump.p, x.",
    ]
    with pytest.raises(CosimError, match="the recording is empty"):
        RecordedSlave(recording((), ()), ["x"])
