"""Linearised models against closed forms."""

from math import pi

import numpy as np
import pytest
from parts import Lag, MassBlock, Spring, Wall

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.model import Diagram, linearise, simulate, sweep
from seacrane.units import bar


def lag():
    diagram = Diagram("following")
    part = diagram.add("lag", Lag(rate=2.0))
    diagram.expose(u=part.u, y=part.y)
    return diagram


def oscillator():
    diagram = Diagram("oscillator")
    wall, spring = diagram.add("wall", Wall()), diagram.add("spring", Spring(stiffness=4e4))
    block = diagram.add("block", MassBlock(mass=100.0))
    diagram.connect(wall.flange, spring.b)
    diagram.connect(spring.a, block.flange)
    return diagram


def locked_cylinder(mass=20e3, extension=0.7):
    """A cylinder with both ports plugged: its oil columns are springs. The plugged port pressures are algebraic."""
    diagram = Diagram("locked", bulk_modulus=1.0e9)
    cylinder = diagram.add(
        "cylinder",
        hyd.DoubleActingCylinder(
            level="extended",
            bore=0.28,
            rod=0.2,
            stroke=1.4,
            extension=extension,
            pressure_a=50 * bar,
            pressure_b=9 * bar,
        ),
    )
    load = diagram.add("mass", mech.Mass(mass=mass))
    diagram.connect(cylinder.rod, load.flange)
    for side in ("a", "b"):
        plug = diagram.add(f"plug_{side}", hyd.Plug())
        diagram.connect(getattr(cylinder, side), plug.a)
    return diagram


def test_a_lag_has_its_matrices_pole_and_corner():
    linear = linearise(lag())
    assert pytest.approx(np.array([[-2.0]])) == linear.A
    assert pytest.approx(np.array([[2.0]])) == linear.B
    assert pytest.approx(np.array([[1.0]])) == linear.C
    assert pytest.approx(np.array([[0.0]])) == linear.D
    assert [v.name for v in (*linear.states, *linear.inputs, *linear.outputs)] == ["lag.level", "u", "y"]
    (mode,) = linear.modes()
    assert mode.eigenvalue == pytest.approx(-2.0)
    assert mode.damping == pytest.approx(1.0)
    corner = linear.response([1 / pi], "u", "y")[0]  # 2 rad/s
    assert 20 * np.log10(abs(corner)) == pytest.approx(-3.0103, abs=1e-3)
    assert np.rad2deg(np.angle(corner)) == pytest.approx(-45.0)


def test_a_step_response_is_that_of_the_model_itself():
    step = linearise(lag()).step("u", 2.0, size=3.0, every=0.01)
    assert step["y"] == pytest.approx(3 * (1 - np.exp(-2 * step.time)), abs=1e-12)
    run = simulate(lag(), 2.0, inputs={"u": 3.0}, tolerance=1e-9)
    assert step.rmse(run, "y") < 1e-7
    assert step.signal("y").unit == "m"


def test_a_spring_and_a_mass_swing_at_the_root_of_stiffness_over_mass():
    linear = linearise(oscillator(), outputs=["block.v"])
    (mode,) = linear.modes()
    assert mode.natural_frequency == pytest.approx(np.sqrt(4e4 / 100.0) / (2 * pi), rel=1e-12)
    assert mode.damping == pytest.approx(0.0, abs=1e-12)
    assert dict(mode.states) == pytest.approx({"spring.f": 0.5, "block.v": 0.5})


@pytest.mark.parametrize("extension", [0.1, 0.7, 1.2])
def test_a_load_on_locked_oil_swings_at_the_hydraulic_natural_frequency(extension):
    a, b, h = pi / 4 * 0.28**2, pi / 4 * (0.28**2 - 0.2**2), 0.03
    stiffness = 1e9 * (a / (h + extension) + b / (h + 1.4 - extension))
    expected = np.sqrt(stiffness / 20e3) / (2 * pi)
    modes = linearise(locked_cylinder(extension=extension)).modes()
    (swing,) = [m for m in modes if m.eigenvalue.imag > 1.0]
    assert swing.natural_frequency == pytest.approx(expected, rel=0.005)
    assert swing.states[0][0] == "mass.speed"
    assert {name for name, _ in swing.states} <= {"mass.speed", "cylinder.pressure_a", "cylinder.pressure_b"}


def test_the_nonlinear_drive_swings_at_that_frequency_too():
    (swing,) = [m for m in linearise(locked_cylinder()).modes() if m.eigenvalue.imag > 1.0]
    start = {"mass.speed": 1e-4, "cylinder.pressure_b": 50e5 * 0.28**2 / (0.28**2 - 0.2**2)}
    run = simulate(locked_cylinder(), 1.0, every=1e-4, record=["mass.speed"], parameters=start, tolerance=1e-9)
    v = run["mass.speed"] - run["mass.speed"].mean()
    up = np.flatnonzero((v[:-1] < 0) & (v[1:] >= 0))
    crossings = run.time[up] - v[up] * 1e-4 / (v[up + 1] - v[up])
    assert 1 / np.diff(crossings).mean() == pytest.approx(swing.natural_frequency, rel=0.005)


def test_a_model_is_linearised_where_it_has_been_run_to():
    diagram = Diagram("emptying")
    volume = diagram.add("volume", hyd.ControlVolume(volume=1e-3, pressure=100 * bar))
    tank = diagram.add("tank", hyd.Tank())
    valve = diagram.add("valve", hyd.ReliefValve(crack=10 * bar, full=200 * bar, flow=1e-3))
    diagram.connect(volume.a, valve.a)
    diagram.connect(valve.b, tank.p)
    here, later = linearise(diagram), linearise(diagram, at=0.05)
    assert later.time == pytest.approx(0.05)
    run = simulate(diagram, 0.05, tolerance=1e-8)
    assert later.point["volume.pressure"] == pytest.approx(run["volume.pressure"][-1], rel=1e-5)
    given = linearise(diagram, at={"volume.pressure": later.point["volume.pressure"]})
    assert pytest.approx(later.A) == given.A
    assert abs(here.A[0, 0]) != pytest.approx(abs(later.A[0, 0]), rel=0.01)


def test_a_bode_plot_has_magnitude_over_phase():
    magnitude, phase = linearise(lag()).bode("u", frequency=[0.01, 1 / pi, 100.0]).axes
    assert magnitude.lines[0].get_ydata()[:2] == pytest.approx([0.0, -3.0103], abs=0.01)
    assert phase.lines[0].get_ydata()[1] == pytest.approx(-45.0)
    assert magnitude.get_legend_handles_labels()[1] == ["y [m] / u [m]"]


def test_unknown_names_get_the_nearest_ones():
    with pytest.raises(ParameterError, match=r"Did you mean 'lag.level'"):
        linearise(lag(), outputs=["lag.levle"])
    with pytest.raises(ParameterError, match="no input 'v'"):
        linearise(lag()).step("v", 1.0)


def test_a_sweep_runs_each_value():
    found = sweep(lag(), "lag.rate", [1.0, 2.0, 4.0], 1.0, inputs={"u": 1.0}, every=0.1)
    assert found.measure(lambda run: run["y"][-1]) == pytest.approx(1 - np.exp([-1.0, -2.0, -4.0]), abs=1e-5)
    figure = found.plot("y", unit="mm")
    assert figure.axes[0].get_ylabel() == "y [mm]"
    assert figure.axes[0].get_legend_handles_labels()[1] == ["1 1/s", "2 1/s", "4 1/s"]
    with pytest.raises(ParameterError, match=r"Did you mean 'lag.rate'"):
        sweep(lag(), "lag.rat", [1.0], 1.0)
