import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seacrane.errors import ParameterError, UnitError
from seacrane.results import Recording, Signal
from seacrane.units import bar


def oscillation() -> Recording:
    t = np.linspace(0, 1, 11)
    return Recording(
        t,
        {
            "pump.p": Signal("Pa", "bar", 1e5 * (100 + np.sin(t))),
            "tank.p": Signal("Pa", "", 1e5 * np.ones(11)),
            "pump.q": Signal("m3/s", "", 1e-3 * t),
        },
    )


def test_values_are_read_by_name_and_cannot_be_changed_by_accident():
    recording = oscillation()
    assert recording["pump.q"][-1] == 1e-3
    with pytest.raises(ValueError, match="read-only"):
        recording["pump.q"][0] = 1.0


def test_an_unknown_name_is_answered_with_the_nearest():
    with pytest.raises(ParameterError, match=r"pump\.pp: no such signal in the recording\. Did you mean 'pump\.p'"):
        oscillation()["pump.pp"]


def test_all_unknown_names_are_told_at_once():
    with pytest.raises(ParameterError) as caught:
        oscillation().select("pump.p", "x", "y")
    assert [problem.path for problem in caught.value.problems] == ["x", "y"]


def test_a_signal_needs_one_value_for_each_time():
    with pytest.raises(ParameterError, match="x: has 2 values for 3 times"):
        Recording(np.arange(3), {"x": Signal("m", "", np.zeros(2))})


def test_interpolation_is_linear_between_samples_and_refused_outside():
    recording = oscillation()
    assert recording.at([0.25])["pump.q"] == pytest.approx([0.25e-3], rel=1e-14)
    with pytest.raises(ParameterError, match=r"is outside the recording .*allowed: 0 to 1 s"):
        recording.at([1.5])


def test_resampling_keeps_both_ends_of_a_whole_number_of_intervals():
    coarse = oscillation().resample(0.25)
    assert coarse.time == pytest.approx([0, 0.25, 0.5, 0.75, 1.0])
    assert coarse["pump.q"] == pytest.approx(1e-3 * coarse.time)


def test_rmse_of_a_shift_is_the_shift_whatever_the_unit_of_the_other():
    t = np.linspace(0, 1, 5)
    ours = Recording(t, {"x": Signal("m", "", t)})
    theirs = Recording(np.linspace(-1, 2, 31), {"y": Signal("mm", "mm", 1e3 * np.linspace(-1, 2, 31) + 3.0)})
    assert ours.rmse(theirs, "x", "y") == pytest.approx(3e-3)
    with pytest.raises(UnitError, match="a signal in 'm' cannot be compared with one in 'Pa'"):
        ours.rmse(oscillation(), "x", "pump.p")


def test_a_part_in_time_has_all_signals():
    part = oscillation().between(0.2, 0.55)
    assert part.time == pytest.approx([0.2, 0.3, 0.4, 0.5])
    assert part.names == oscillation().names


@given(st.lists(st.tuples(st.floats(), st.floats(), st.floats()), max_size=20))
def test_a_csv_file_gives_back_every_bit(tmp_path_factory, rows):
    table = np.array(rows).reshape(-1, 3)
    path = tmp_path_factory.mktemp("csv") / "run.csv"
    before = Recording(table[:, 0], {"a.x": Signal("m", "", table[:, 1]), "b, odd": Signal("1", "", table[:, 2])})
    before.to_csv(path)
    after = Recording.read_csv(path)
    assert after.names == before.names
    assert np.array_equal(after.time, before.time, equal_nan=True)
    for name in before:
        assert np.array_equal(after[name], before[name], equal_nan=True)
        assert after.signal(name).unit == before.signal(name).unit


def test_the_csv_header_names_each_column_with_its_unit(tmp_path):
    oscillation().to_csv(tmp_path / "run.csv", ["pump.q", "pump.p"])
    assert (tmp_path / "run.csv").read_text().splitlines()[:2] == [
        "time [s],pump.q [m3/s],pump.p [Pa]",
        "0.0,0.0,10000000.0",
    ]
    assert [p.name for p in tmp_path.iterdir()] == ["run.csv"]


def test_a_row_that_was_being_written_in_a_crash_is_left_out(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("time [s],x [m]\n0.0,1.0\n0.1,2.0\n0.2,3.")
    assert Recording.read_csv(path)["x"].tolist() == [1.0, 2.0]


def test_a_file_that_is_no_recording_is_refused_with_all_that_is_wrong(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text("t,x [furlong],y,z [m],z [m]\n0,1,2,3,4\n")
    with pytest.raises(ParameterError) as caught:
        Recording.read_csv(path)
    assert [p.message for p in caught.value.problems] == [
        "the first column is not the time",
        "column 'x' has an unknown unit",
        "a column has no unit",
        "a column appears twice",
    ]
    path.write_text("time [s],x [m]\n0.0,hello\n")
    with pytest.raises(ParameterError, match="is not a table of numbers"):
        Recording.read_csv(path)
    path.write_text("time [s],x [m]\n0.0,1.0,2.0\n")
    with pytest.raises(ParameterError, match="has 3 values in a row for 2 columns"):
        Recording.read_csv(path)


def test_a_plot_has_one_axes_for_each_unit_in_engineering_units(tmp_path):
    figure = oscillation().plot()
    pressure, flow = figure.axes
    assert [line.get_label() for line in pressure.lines] == ["pump.p", "tank.p"]
    assert (pressure.get_ylabel(), flow.get_ylabel()) == ("[bar]", "pump.q [l/min]")
    assert flow.get_xlabel() == "time [s]"
    assert flow.lines[0].get_ydata()[-1] == pytest.approx(60.0)
    figure.savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").stat().st_size > 10_000


def test_a_plot_takes_another_unit_as_symbol_or_constant():
    for unit in (bar, "bar"):
        assert oscillation().plot("tank.p", unit=unit).axes[0].lines[0].get_ydata()[0] == pytest.approx(1.0)
    with pytest.raises(UnitError, match="a quantity in 'Pa' cannot be given in 'm'"):
        oscillation().plot("tank.p", unit="m")
    with pytest.raises(UnitError, match="no unit for a quantity in 'Pa' has this factor"):
        oscillation().plot("tank.p", unit=3.0)
