"""A run that fails says when, where and why, proposes a cure that works, and keeps what it has computed."""

import casadi as ca
import pytest
from parts import Chamber

from seacrane.cosim import Execution, GaussSeidel, ModelSlave, System
from seacrane.errors import CosimError, SolveError
from seacrane.library.hydraulics import (
    DirectionalValve43,
    DoubleActingCylinder,
    FlowInput,
    Orifice,
    SingleActingCylinder,
    Tank,
    VariableOrifice,
)
from seacrane.library.mechanics import Mass
from seacrane.model import (
    SOLVERS,
    Component,
    Diagram,
    Hydraulic,
    RungeKutta4,
    SignalIn,
    build,
    parameter,
    simulate,
    trim,
)
from seacrane.model.dae import Dae, Variable
from seacrane.units import Ratio, bar, l, l_min, mm


def boom(**valve):
    """A load on a lossless cylinder behind a proportional valve."""
    diagram = Diagram("boom")
    cylinder = diagram.add("cylinder", DoubleActingCylinder(bore=100 * mm, rod=60 * mm, stroke=1.0, extension=0.5))
    spool = diagram.add("valve", DirectionalValve43(flow=100 * l_min, at=35 * bar, **valve))
    pump, tank = diagram.add("pump", Tank(pressure=100 * bar)), diagram.add("tank", Tank())
    load = diagram.add("load", Mass(mass=1000.0))
    diagram.connect(pump.p, spool.p)
    diagram.connect(tank.p, spool.t)
    diagram.connect(spool.a, cylinder.a)
    diagram.connect(spool.b, cylinder.b)
    diagram.connect(cylinder.rod, load.flange)
    diagram.expose(spool=spool.x)
    return diagram


def failure(*arguments, **settings):
    with pytest.raises(SolveError) as caught:
        simulate(*arguments, **settings)
    return caught.value, str(caught.value)


# ---------------------------------------------------------------- equations that lose their unknown
def test_the_report_names_what_a_closed_valve_leaves_undetermined():
    report = boom(leakage=0.0).report()
    assert [p.path for p in report.undetermined] == ["cylinder.a.p", "cylinder.b.p"]
    text = str(report)
    assert "nothing determines it at the start values (joined: valve.a.p" in text
    assert "It is determined if valve.leakage or valve.float_centre is above 0" in text
    assert "a small volume (ControlVolume)" in text


@pytest.mark.parametrize("cure", [{"leakage": 1e-4}, {"leakage": 0.0, "float_centre": 0.1}])
def test_the_proposed_cures_work(cure):
    assert boom(**cure).report().undetermined == ()
    assert simulate(boom(**cure), 0.1)["cylinder.extension"][-1] == pytest.approx(0.5, abs=0.01)


def test_a_run_that_starts_behind_a_closed_valve_says_so():
    _, text = failure(boom(leakage=0.0), 1.0)
    assert "boom: the algebraic equations are singular or not finite at t = 0 s" in text
    assert "cylinder.b.p: nothing determines it at t = 0 s (joined: valve.b.p" in text


@pytest.mark.parametrize("solver", [s for s in SOLVERS if s not in ("explicit-euler", "rk4")])
def test_a_valve_that_closes_in_a_run_is_told_with_its_time_and_the_jump_that_closed_it(solver):
    steps = {"spool": ([0.0, 0.5], [0.5, 0.0])}
    error, text = failure(boom(leakage=0.0), 1.0, inputs=steps, solver=solver)
    assert "t = 0.5 s" in error.problems[0].message
    assert "cylinder.a.p: nothing determines it at t = 0.5 s" in text
    assert "valve.leakage" in text
    assert "spool: jumps from 0.5 to 0 at t = 0.5 s" in text
    assert "RateLimit" in text
    assert error.results.time[-1] == pytest.approx(0.5, abs=0.011)
    assert error.results["cylinder.extension"][-1] > 0.52


class Laminar(Component):
    """A valve whose flow is linear in the pressure drop: such an equation is solved in closed form."""

    conductance: Ratio = parameter("flow per pressure, open", default=1e-10, above=0)
    leakage: Ratio = parameter("opening when closed", default=0.0, least=0)
    ports = {"k": SignalIn("1"), "a": Hydraulic(), "b": Hydraulic()}

    def equations(self, m):
        yield m.a.q, (m.k + self.leakage) * self.conductance * (m.a.p - m.b.p)
        yield m.a.q + m.b.q, 0


def pushing(**valve):
    diagram = Diagram("jack")
    tank, valve = diagram.add("tank", Tank(pressure=50 * bar)), diagram.add("valve", Laminar(**valve))
    cylinder = diagram.add("cylinder", SingleActingCylinder(bore=100 * mm, stroke=1.0, extension=0.5))
    load = diagram.add("load", Mass(mass=1000.0))
    diagram.connect(tank.p, valve.a)
    diagram.connect(valve.b, cylinder.a)
    diagram.connect(cylinder.rod, load.flange)
    diagram.expose(k=valve.k)
    return diagram


def test_a_coefficient_that_vanishes_in_a_closed_form_is_found_too():
    diagram = pushing()
    assert diagram.compile().algebraics == ()
    (problem,) = diagram.report().undetermined
    assert "valve should" in problem.message
    assert "valve.leakage or k is above 0" in problem.hint
    _, text = failure(diagram, 1.0, inputs={"k": 0.0})
    assert "nothing determines it at t = 0 s" in text
    assert pushing(leakage=1e-4).report().undetermined == ()
    assert len(simulate(diagram, 0.1, inputs={"k": 1.0})) == 11


def test_a_closed_variable_orifice_is_found():
    diagram = Diagram("jack")
    tank, valve = diagram.add("tank", Tank(pressure=50 * bar)), diagram.add("valve", VariableOrifice(diameter=5 * mm))
    cylinder = diagram.add("cylinder", SingleActingCylinder(bore=100 * mm, stroke=1.0, extension=0.5))
    load = diagram.add("load", Mass(mass=1000.0))
    diagram.connect(tank.p, valve.a)
    diagram.connect(valve.b, cylinder.a)
    diagram.connect(cylinder.rod, load.flange)
    diagram.expose(k=valve.k)
    assert "It is determined if k is above 0" in str(diagram.report())


def test_trimming_behind_a_closed_valve_names_what_is_undetermined():
    with pytest.raises(SolveError) as caught:
        trim(pushing(), inputs={"k": 0.0})
    assert "valve.b.p: nothing determines it at the start values" in str(caught.value)
    assert "valve.leakage" in str(caught.value)


# ---------------------------------------------------------------- values that leave the range of a law
class GasThrottle(Component):
    """Flow of a gas: its density, and with it the flow, falls with the absolute pressure."""

    ports = {"a": Hydraulic(), "b": Hydraulic()}

    def equations(self, m):
        yield m.a.q, 1e-12 * ca.sqrt(m.b.p + 1.01325e5) * (m.a.p - m.b.p)
        yield m.a.q + m.b.q, 0


def sucked():
    diagram = Diagram("suction")
    tank, throttle = diagram.add("tank", Tank()), diagram.add("throttle", GasThrottle())
    chamber, pump = diagram.add("chamber", Chamber(volume=1 * l)), diagram.add("pump", FlowInput())
    diagram.connect(tank.p, throttle.a)
    diagram.connect(throttle.b, chamber.a, pump.p)
    diagram.expose(flow=pump.set)
    return diagram


def test_a_pressure_that_falls_below_vacuum_is_told_with_the_valve_that_lets_oil_in():
    error, text = failure(sucked(), 1.0, inputs={"flow": -1e-4}, every=1e-4)
    assert "chamber.p: is at -1.01" in text
    assert "at or below vacuum" in text
    assert "AnticavitationValve" in text
    assert -1.02e5 < error.results["chamber.p"][-1] < -0.5e5


def pushed(speed, **stop):
    """A load that a supply of 100 bar pushes through an orifice, near the end of the stroke."""
    diagram = Diagram("hit")
    jack = SingleActingCylinder(level="extended", bore=100 * mm, stroke=1.0, extension=0.99, pressure=20 * bar, **stop)
    cylinder, load = diagram.add("cylinder", jack), diagram.add("load", Mass(mass=1000.0, speed=speed))
    orifice, supply = diagram.add("orifice", Orifice(diameter=10 * mm)), diagram.add("supply", Tank(pressure=100 * bar))
    diagram.connect(supply.p, orifice.a)
    diagram.connect(orifice.b, cylinder.a)
    diagram.connect(cylinder.rod, load.flange)
    return diagram


def test_an_explicit_step_too_long_for_an_end_stop_is_told_with_what_was_hit():
    error, text = failure(pushed(2.0, stop_stiffness=1e11), 1.0, solver=RungeKutta4(1e-3))
    assert "too long a step" in text
    assert "beyond its stroke of 0 to 1 m" in text
    assert "cylinder.stop_stiffness" in text
    assert "an implicit solver such as 'rodas4'" in text
    assert len(error.results) > 3


def test_the_step_that_is_proposed_to_an_explicit_method_is_stable():
    diagram = pushed(2.0, stop_stiffness=1e11)
    _, text = failure(diagram, 1.0, solver=RungeKutta4(1e-3))
    proposed = float(text.partition("Take a step below ")[2].partition(" s")[0])
    run = simulate(diagram, 1.0, solver=RungeKutta4(proposed))
    exact = simulate(diagram, 1.0, tolerance=1e-9)
    assert run["cylinder.extension"][-1] == pytest.approx(exact["cylinder.extension"][-1], abs=1e-3)


# ---------------------------------------------------------------- runs that end, and should not be believed
def test_a_cylinder_without_end_stops_that_runs_beyond_its_stroke_is_doubted_with_the_time():
    run = simulate(boom(), 20.0, inputs={"spool": 1.0})
    (doubt,) = run.doubts
    assert doubt.path == "cylinder.extension"
    reached = run.time[run["cylinder.extension"] > 1.001][0]
    beyond = run["cylinder.extension"].max() - 1.0
    assert f"beyond its stroke of 0 to 1 m from t = {reached:g} s on, by up to {beyond:.4g} m" in doubt.message
    assert "take the level 'extended'" in doubt.hint


def test_a_start_beyond_the_stroke_given_to_a_run_is_doubted_from_its_beginning():
    (doubt,) = simulate(boom(), 0.1, parameters={"cylinder.extension": 1.2}).doubts
    assert "from t = 0 s on, by up to 0.2 m" in doubt.message
    assert simulate(boom(), 0.1, parameters={"cylinder.extension": 1.2, "cylinder.stroke": 1.5}).doubts == ()


def test_an_end_stop_that_yields_as_it_should_is_not_doubted():
    run = simulate(pushed(0.5), 1.0)
    assert run["cylinder.extension"].max() > 1.0
    assert run.doubts == ()


def test_a_line_that_is_sucked_below_vacuum_is_doubted():
    diagram = Diagram("suction")
    chamber, pump = diagram.add("chamber", Chamber(volume=1 * l)), diagram.add("pump", FlowInput())
    diagram.connect(chamber.a, pump.p)
    diagram.expose(flow=pump.set)
    (doubt,) = simulate(diagram, 0.1, inputs={"flow": -1e-5}).doubts
    assert "chamber.p: is at or below vacuum from t = 0.02 s on, down to -10 bar" in str(doubt)
    assert simulate(diagram, 0.1, inputs={"flow": 1e-5}).doubts == ()


def test_an_input_out_of_its_range_is_doubted():
    (doubt,) = simulate(boom(), 0.1, inputs={"spool": ([0.0, 0.05], [0.0, -28.0])}).doubts
    assert str(doubt) == "spool: is -28 at t = 0.05 s, outside its range; allowed: -1 to 1"


# ---------------------------------------------------------------- where nothing in particular stands out
class Escape(Component):
    """dx/dt = x^2 + k: from 1 on it is infinite after one second, for no reason that the diagram would show."""

    gain: Ratio = parameter("gain", default=1.0)
    ports = {"k": SignalIn("1")}

    def equations(self, m):
        x = m.state("level", unit="m", start=1.0, about="level in the tank")
        yield m.der(x), self.gain * x * x + m.k


@pytest.mark.parametrize("solver", ["rodas4", "bdf", "lsoda"])
def test_where_nothing_else_stands_out_the_state_at_fault_is_told_with_its_component_and_the_tolerance(solver):
    diagram = Diagram("runaway")
    diagram.expose(k=diagram.add("tank", Escape()).k)
    error, text = failure(diagram, 2.0, solver=solver, tolerance=1e-7)
    assert "tank.level: is at " in text
    assert "(level in the tank)" in text
    assert "Look at the parameters of tank" in text
    assert "another tolerance than 1e-07" in text
    assert error.results.time[-1] == pytest.approx(1.0, abs=0.02)


def test_a_step_that_fails_says_what_a_failing_run_says_and_so_does_a_system():
    diagram = Diagram("runaway")
    diagram.expose(k=diagram.add("tank", Escape()).k)
    _, told = failure(diagram, 2.0, tolerance=1e-7)
    with build(diagram.compile()).instantiate("runaway") as run:
        run.set("solver.tolerance", 1e-7)
        run.initialize(0.0)
        with pytest.raises(SolveError) as caught:
            run.step(0.0, 2.0)
    assert caught.value.problems[1].path == "tank.level"
    for text in ("(level in the tank)", "Look at the parameters of tank", "another tolerance than 1e-07"):
        assert text in str(caught.value)
        assert text in told
    for loop in ("native", "python"):
        system = System()
        system.add("drive", ModelSlave(diagram, {"solver.tolerance": 1e-7}))
        with pytest.raises(CosimError, match=r"(?s)drive.*tank.level: is at .*Look at the parameters of tank"):
            Execution(system, GaussSeidel(0.5), loop=loop).run(2.0)


@pytest.mark.parametrize("step", [0.0, 1e-2], ids=["rodas4", "implicit-euler"])
def test_a_singular_matrix_is_told_with_the_unknown_that_it_leaves_open(step):
    t, x, z, none = ca.SX.sym("t"), ca.SX.sym("x"), ca.SX.sym("z", 2), ca.SX(0, 1)
    alg = ca.vertcat(z[0] - x, z[1] * ca.fmax(0.5 - t, 0))  # nothing determines z1 from half a second on
    names = (Variable("first"), Variable("second"))
    dae = Dae("lost", (Variable("x"),), names, (), (), (), (), t, x, z, none, none, ca.SX(1.0), alg, none, none)
    with build(dae).instantiate() as run:
        run.set("solver.fixed_step", step)
        run.initialize(0.0)
        for k in range(50):
            run.step(k * 0.01, 0.01)
        with pytest.raises(SolveError, match=r"the matrix of the solver is singular at t = 0.\d+ s: nothing .* second"):
            run.step(0.5, 0.01)


class Root(Component):
    ports = {"k": SignalIn("1")}
    scale: Ratio = parameter("scale", default=1.0)

    def equations(self, m):
        x = m.state("level", unit="m", start=1.0)
        yield m.der(x), -self.scale * ca.sqrt(m.k)


def test_an_equation_without_a_finite_value_is_told_with_its_components():
    diagram = Diagram("draining")
    diagram.expose(k=diagram.add("tank", Root()).k)
    error, text = failure(diagram, 2.0, inputs={"k": ([0.0, 1.0], [1.0, -1.0])})
    assert "k: jumps from 1 to -1 at t = 1 s" in text
    assert "t = 1 s; first is the one of tank.level" in text
    assert error.results["tank.level"][-1] == pytest.approx(0.0, abs=1e-6)
    _, text = failure(diagram, 2.0, inputs={"k": -1.0})
    assert "tank.level: has no finite rate there; tank take part in it" in text
    assert "a root or logarithm of what has become negative" in text
