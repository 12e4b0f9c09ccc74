"""Rigidly tied stores, and loops that are torn, against the equations one writes down by hand."""

import casadi as ca
import numpy as np
import pytest
from parts import Chamber, Flywheel, MassBlock, Orifice, PressureSource, Push

from seacrane.errors import StructureError
from seacrane.model import Component, Diagram, Rotational, SignalIn, Translational, initial, parameter, simulate
from seacrane.units import AngularSpeed, Inertia, Length, Mass, Ratio, Torque, bar, l, mm


class Motor(Component):
    torque: Torque = parameter("torque of the motor", default=100.0)
    ports = {"shaft": Rotational()}

    def equations(self, m):
        yield m.shaft.T, -self.torque


class Spinning(Component):
    inertia: Inertia = parameter("inertia", above=0)
    speed: AngularSpeed = initial("speed at the start")
    ports = {"shaft": Rotational()}

    def equations(self, m):
        w = m.state("w", unit="rad/s", start=self.speed)
        yield m.shaft.w, w
        yield self.inertia * m.der(w), m.shaft.T


class Gear(Component):
    reduction: Ratio = parameter("reduction", above=0)
    ports = {"a": Rotational(), "b": Rotational()}

    def equations(self, m):
        yield m.a.w, self.reduction * m.b.w
        yield m.b.T, -self.reduction * m.a.T


class Drum(Component):
    radius: Length = parameter("radius", above=0)
    ports = {"shaft": Rotational(), "rope": Translational()}

    def equations(self, m):
        yield m.rope.v, self.radius * m.shaft.w
        yield m.shaft.T, -self.radius * m.rope.F


class Load(Component):
    mass: Mass = parameter("mass", above=0)
    ports = {"hook": Translational()}

    def equations(self, m):
        v = m.state("v", unit="m/s")
        yield m.hook.v, v
        yield self.mass * m.der(v), m.hook.F - self.mass * 9.81


class Lever(Component):
    """v_b = (arm_b / arm_a) v_a about a fixed pivot."""

    arm_a: Length = parameter("arm of a", above=0)
    arm_b: Length = parameter("arm of b", above=0)
    ports = {"a": Translational(), "b": Translational()}

    def equations(self, m):
        yield self.arm_a * m.b.v, self.arm_b * m.a.v
        yield self.arm_a * m.a.F + self.arm_b * m.b.F, 0


def rates_of(dae, **states):
    x = [states.get(v.name.replace(".", "_"), v.start) for v in dae.states]
    function = ca.Function("f", [dae.t, dae.x, dae.z, dae.u, dae.p], [dae.ode, dae.obs])
    ode, obs = (np.asarray(r).ravel() for r in function(0, x, [], [], [v.start for v in dae.parameters]))
    return dict(zip([v.name for v in (*dae.states, *dae.observables)], [*ode, *obs], strict=True))


def winch():
    diagram = Diagram("winch")
    parts = {
        "motor": Motor(torque=500.0),
        "rotor": Flywheel(inertia=2.0),
        "gear": Gear(reduction=50.0),
        "drum_inertia": Flywheel(inertia=500.0),
        "drum": Drum(radius=0.5),
        "load": Load(mass=2e4),
    }
    p = {name: diagram.add(name, part) for name, part in parts.items()}
    diagram.connect(p["motor"].shaft, p["rotor"].shaft, p["gear"].a)
    diagram.connect(p["gear"].b, p["drum_inertia"].shaft, p["drum"].shaft)
    diagram.connect(p["drum"].rope, p["load"].hook)
    return diagram


def test_a_rigid_winch_has_one_state_and_the_sum_of_its_inertias():
    dae = winch().compile()
    assert [v.name for v in dae.states] == ["rotor.w"]
    assert not dae.algebraics
    inertia = 2.0 + 500.0 / 50**2 + 2e4 * 0.5**2 / 50**2
    torque = 500.0 - 2e4 * 9.81 * 0.5 / 50
    found = rates_of(dae, rotor_w=100.0)
    assert found["rotor.w"] == pytest.approx(torque / inertia, rel=1e-12)
    assert found["drum_inertia.w"] == pytest.approx(2.0)
    assert found["load.v"] == pytest.approx(1.0)
    pull = 2e4 * (9.81 + torque / inertia * 0.5 / 50)
    assert found["load.hook.F"] == pytest.approx(pull, rel=1e-12)


def test_a_reduced_model_runs_in_c_and_shows_the_demoted_speed():
    run = simulate(winch(), 2.0)
    inertia = 2.0 + 500.0 / 50**2 + 2e4 * 0.5**2 / 50**2
    rate = (500.0 - 2e4 * 9.81 * 0.5 / 50) / inertia
    assert run["load.v"] == pytest.approx(rate * 0.5 / 50 * run.time, abs=1e-9)


def two_chambers(first=0.0, second=0.0):
    diagram = Diagram("filling")
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    orifice = diagram.add("orifice", Orifice(diameter=5 * mm))
    one = diagram.add("one", Chamber(volume=1 * l, pressure=first))
    two = diagram.add("two", Chamber(volume=3 * l, pressure=second))
    diagram.connect(pump.p, orifice.a)
    diagram.connect(orifice.b, one.a, two.a)
    return diagram


def test_two_chambers_on_one_node_fill_as_one_of_both_volumes():
    dae = two_chambers().compile()
    assert [v.name for v in dae.states] == ["one.p"]
    found = rates_of(dae, one_p=50e5)
    flow = 0.7 * np.pi / 4 * 0.005**2 * np.sqrt(2 / 870.0 * 150e5)
    assert found["one.p"] == pytest.approx(1e9 / 4e-3 * flow, rel=1e-5)
    assert found["two.p"] == 50e5
    assert found["two.a.q"] == pytest.approx(0.75 * flow, rel=1e-5)


def test_the_state_with_a_start_value_stays():
    dae = two_chambers(second=30 * bar).compile()
    assert [(v.name, v.start) for v in dae.states] == [("two.p", 30 * bar)]


def test_start_values_that_contradict_each_other_are_refused():
    two_chambers(30 * bar, 30 * bar).compile()
    with pytest.raises(StructureError) as caught:
        two_chambers(30 * bar, 20 * bar).compile()
    text = str(caught.value)
    assert "two.p: starts at 20 bar, but one.p, to which it is tied rigidly at" in text
    assert "gives it 30 bar. Give a start value to one of them" in text


def test_a_mass_on_a_rigid_lever_counts_with_the_square_of_the_arms():
    diagram = Diagram("lever")
    push = diagram.add("push", Push(force=1000.0))
    near, far = diagram.add("near", MassBlock(mass=50.0)), diagram.add("far", MassBlock(mass=20.0))
    lever = diagram.add("lever", Lever(arm_a=1.0, arm_b=3.0))
    diagram.connect(push.flange, near.flange, lever.a)
    diagram.connect(lever.b, far.flange)
    found = rates_of(diagram.compile())
    assert found["near.v"] == pytest.approx(1000.0 / (50.0 + 9 * 20.0), rel=1e-12)


class Glued(Component):
    """Two masses whose positions are equal: a tie of positions needs two differentiations."""

    mass_a: Mass = parameter("first mass", above=0)
    mass_b: Mass = parameter("second mass", above=0)
    ports = {"flange": Translational()}

    def equations(self, m):
        xa, xb = m.state("xa", unit="m"), m.state("xb", unit="m")
        va, vb = m.state("va", unit="m/s"), m.state("vb", unit="m/s")
        f = m.unknown("f", unit="N")
        yield m.der(xa), va
        yield m.der(xb), vb
        yield xa, xb
        yield m.flange.v, va
        yield self.mass_a * m.der(va), m.flange.F - f
        yield self.mass_b * m.der(vb), f


def test_tied_positions_are_differentiated_twice():
    diagram = Diagram("glue")
    push, glued = diagram.add("push", Push(force=30.0)), diagram.add("glued", Glued(mass_a=1.0, mass_b=2.0))
    diagram.connect(push.flange, glued.flange)
    dae = diagram.compile()
    assert [v.name for v in dae.states] == ["glued.xa", "glued.va"]
    found = rates_of(dae, glued_va=2.0)
    assert (found["glued.xa"], found["glued.va"]) == pytest.approx((2.0, 10.0))
    assert found["glued.vb"] == pytest.approx(2.0)
    assert found["glued.f"] == pytest.approx(20.0)


class Relative(Component):
    """b runs faster than a by a given speed."""

    ports = {"dv": SignalIn("m/s"), "a": Translational(), "b": Translational()}

    def equations(self, m):
        yield m.b.v, m.a.v + m.dv
        yield m.a.F + m.b.F, 0


def test_a_tie_that_an_input_moves_would_need_its_rate_and_is_refused():
    diagram = Diagram("d")
    one, two = diagram.add("one", MassBlock(mass=1.0)), diagram.add("two", MassBlock(mass=1.0))
    tie = diagram.add("tie", Relative())
    diagram.connect(one.flange, tie.a)
    diagram.connect(two.flange, tie.b)
    diagram.expose(dv=tie.dv)
    with pytest.raises(StructureError, match=r"the rate of change of the input dv would be needed.*at tie"):
        diagram.compile()


def series(count):
    diagram = Diagram("series")
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    port = pump.p
    for k in range(count):
        orifice = diagram.add(f"orifice{k}", Orifice(diameter=5 * mm))
        diagram.connect(port, orifice.a)
        port = orifice.b
    diagram.connect(port, diagram.add("chamber", Chamber(volume=1 * l)).a)
    return diagram


@pytest.mark.parametrize("count", [2, 3, 6])
def test_orifices_in_series_leave_one_pressure_between_neighbours_each(count):
    dae = series(count).compile()
    assert [v.unit for v in dae.algebraics] == ["Pa"] * (count - 1)
    # Equal orifices share the drop; the law is rounded near zero flow, which 200 bar are far from.
    shares = sorted(200e5 * (1 - (k + 1) / count) for k in range(count - 1))
    assert sorted(v.start for v in dae.algebraics) == pytest.approx(shares, rel=1e-4)


def test_the_report_says_what_follows_what_and_where():
    report = winch().report()
    assert report.states == ("rotor.w",)
    (tie,) = report.ties
    assert (tie.demoted, tie.kept) == (("drum_inertia.w", "load.v"), ("rotor.w",))
    assert "drum_inertia.w and load.v follow rotor.w, tied rigidly at" in str(report)
    assert "gear" in tie.where


def test_the_report_names_the_components_of_a_loop_and_what_is_iterated():
    report = series(2).report()
    (loop,) = report.loops
    assert loop.torn == ("orifice0.b.p",)
    assert "algebraic loop through orifice0, orifice1" in str(report)
    assert "the solver iterates on orifice0.b.p. A small volume at such a node opens the loop" in str(report)
