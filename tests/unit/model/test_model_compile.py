"""Diagrams become the equations that one would write down by hand."""

import casadi as ca
import numpy as np
import pytest
from parts import (
    Chamber,
    Flywheel,
    InMillimetre,
    Lag,
    LinearOrifice,
    MassBlock,
    Orifice,
    PressureSource,
    Push,
    Spring,
    TurbulentOrifice,
    Wall,
)

from seacrane.errors import StructureError
from seacrane.model import Component, Diagram, SignalIn, initial, parameter
from seacrane.units import Length, bar, l, mm


def evaluate(dae, x=(), z=(), u=(), p=None):
    """Rates, residuals, and outputs and observables by name."""
    function = ca.Function("f", [dae.t, dae.x, dae.z, dae.u, dae.p], [dae.ode, dae.alg, dae.out, dae.obs])
    p = [v.start for v in dae.parameters] if p is None else p
    ode, alg, out, obs = (np.asarray(r).ravel() for r in function(0, list(x), list(z), list(u), p))
    named = dict(zip([v.name for v in dae.outputs + dae.observables], [*out, *obs], strict=True))
    return dict(zip([v.name for v in dae.states], ode, strict=True)), alg, named


def filling(**shared):
    diagram = Diagram("filling", **shared)
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    orifice = diagram.add("orifice", Orifice(diameter=5 * mm))
    chamber = diagram.add("chamber", Chamber(volume=1 * l, pressure=10 * bar))
    diagram.connect(pump.p, orifice.a)
    diagram.connect(orifice.b, chamber.a)
    return diagram


def test_a_filled_chamber_follows_the_orifice_law():
    dae = filling(density=860.0).compile()
    rates, _, named = evaluate(dae, x=[50e5])
    flow = 0.7 * np.pi / 4 * 0.005**2 * np.sqrt(2 / 860.0 * 150e5)
    assert rates["chamber.p"] == pytest.approx(1e9 / 1e-3 * flow, rel=1e-5)
    assert named["chamber.a.q"] == pytest.approx(flow, rel=1e-5)
    assert named["pump.p.q"] == pytest.approx(-flow, rel=1e-5)
    assert dae.states[0].start == 10 * bar


def test_flows_sum_to_zero_at_a_node_of_three():
    diagram = filling()
    second = diagram.add("second", LinearOrifice(diameter=5 * mm))
    tank = diagram.add("tank", PressureSource(pressure=1 * bar))
    diagram.connect(diagram.parts["chamber"].a, second.a)
    diagram.connect(second.b, tank.p)
    _, _, named = evaluate(diagram.compile(), x=[50e5])
    assert named["orifice.b.q"] + named["chamber.a.q"] + named["second.a.q"] == pytest.approx(0, abs=1e-18)
    assert named["second.a.q"] == pytest.approx(1e-11 * 49e5)


def test_a_shared_parameter_is_one_parameter_of_the_whole_diagram():
    dae = filling().compile()
    names = [v.name for v in dae.parameters]
    assert "density" in names
    assert "orifice.density" not in names
    own = filling()
    own.add("extra", Orifice(diameter=5 * mm, density=900.0))
    own.connect(own.parts["chamber"].a, own.parts["extra"].a, own.parts["extra"].b)
    assert "extra.density" in [v.name for v in own.compile().parameters]


def test_a_level_is_swapped_without_touching_a_connection():
    assert isinstance(Orifice(diameter=1 * mm), TurbulentOrifice)
    assert isinstance(Orifice(diameter=1 * mm, level="linear"), LinearOrifice)


def test_two_orifices_in_series_stay_as_an_algebraic_block_with_the_right_root():
    diagram = Diagram("series")
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    first = diagram.add("first", Orifice(diameter=5 * mm))
    second = diagram.add("second", Orifice(diameter=5 * mm))
    chamber = diagram.add("chamber", Chamber(volume=1 * l))
    diagram.connect(pump.p, first.a)
    diagram.connect(first.b, second.a)
    diagram.connect(second.b, chamber.a)
    dae = diagram.compile()
    assert dae.algebraics
    solve = ca.rootfinder("r", "newton", {"x": dae.z, "p": ca.vertcat(dae.t, dae.x, dae.u, dae.p), "g": dae.alg})
    guess = [150e5 if v.unit == "Pa" else 1e-3 for v in dae.algebraics]
    z = dict(
        zip(
            [v.name for v in dae.algebraics],
            np.asarray(solve(guess, [0, 0, *[v.start for v in dae.parameters]])).ravel(),
            strict=True,
        )
    )
    assert z["first.b.p"] == pytest.approx(100e5, rel=1e-6)


def test_a_spring_and_a_mass_oscillate_at_the_root_of_stiffness_over_mass():
    diagram = Diagram("oscillator")
    wall = diagram.add("wall", Wall())
    spring = diagram.add("spring", Spring(stiffness=4e4))
    block = diagram.add("block", MassBlock(mass=100.0))
    diagram.connect(wall.flange, spring.b)
    diagram.connect(spring.a, block.flange)
    dae = diagram.compile()
    matrix = np.asarray(ca.Function("A", [dae.p], [ca.jacobian(dae.ode, dae.x)])([v.start for v in dae.parameters]))
    assert np.sort(np.linalg.eigvals(matrix).imag) == pytest.approx([-20.0, 20.0])


def test_an_exposed_power_port_takes_velocity_and_gives_force():
    diagram = Diagram("half")
    spring = diagram.add("spring", Spring(stiffness=4e4))
    wall = diagram.add("wall", Wall())
    diagram.connect(wall.flange, spring.b)
    diagram.expose(rod=spring.a)
    dae = diagram.compile()
    assert [v.name for v in dae.inputs] == ["rod.v"]
    assert [v.name for v in dae.outputs] == ["rod.F"]
    rates, _, named = evaluate(dae, x=[70.0], u=[0.5])
    assert rates["spring.f"] == pytest.approx(2e4)
    assert named["rod.F"] == pytest.approx(70.0)


def test_signals_carry_their_unit_across_a_connection():
    diagram = Diagram("measuring")
    lag = diagram.add("lag", Lag())
    dial = diagram.add("dial", InMillimetre())
    diagram.connect(lag.y, dial.u)
    diagram.expose(u=lag.u, y=lag.y)
    dae = diagram.compile()
    _, _, named = evaluate(dae, x=[0.25], u=[1.0])
    assert named["dial.reading"] == pytest.approx(250.0)
    assert named["y"] == pytest.approx(0.25)


def refused(diagram):
    with pytest.raises(StructureError) as caught:
        diagram.compile()
    return str(caught.value)


def test_two_pressure_sources_on_one_node_are_named():
    diagram = Diagram("d")
    a = diagram.add("main_pump", PressureSource(pressure=200 * bar))
    b = diagram.add("boost_pump", PressureSource(pressure=20 * bar))
    diagram.connect(a.p, b.p)
    text = refused(diagram)
    assert "main_pump, boost_pump determine main_pump.p.p more than once" in text


def test_a_chamber_tied_directly_to_a_source_is_told_apart_from_a_mistake():
    diagram = Diagram("d")
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    chamber = diagram.add("chamber", Chamber(volume=1 * l))
    diagram.connect(pump.p, chamber.a)
    text = refused(diagram)
    assert "chamber.p is a state, but its value is also prescribed" in text
    assert "derivative causality at pump, chamber" in text
    assert "Put an orifice, hose or spring between the source and the store" in text


def test_two_chambers_tied_directly_to_a_source_are_both_named():
    diagram = Diagram("d")
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    one, two = (diagram.add(n, Chamber(volume=1 * l)) for n in ("one", "two"))
    diagram.connect(pump.p, one.a, two.a)
    assert "one.p and two.p are states, but their values are also prescribed" in refused(diagram)


def test_an_unconnected_port_is_named_with_the_cure():
    diagram = Diagram("d")
    diagram.add("orifice", Orifice(diameter=5 * mm))
    text = refused(diagram)
    assert "d.orifice.a: is connected to nothing. Connect it, expose it, or plug it." in text
    assert "d.orifice.b" in text


def test_an_undetermined_node_is_named():
    diagram = Diagram("d")
    one, two = (diagram.add(n, LinearOrifice(diameter=5 * mm)) for n in ("one", "two"))
    diagram.connect(one.a, two.a)
    diagram.connect(one.b, two.b)
    assert "nothing determines" in refused(diagram)


def test_wrong_connections_are_refused_at_once_by_name():
    diagram = Diagram("d")
    orifice = diagram.add("orifice", Orifice(diameter=5 * mm))
    wheel = diagram.add("wheel", Flywheel(inertia=2.0))
    lag = diagram.add("lag", Lag())
    dial = diagram.add("dial", InMillimetre())
    stranger = Diagram("other").add("push", Push())
    cases = {
        "different domains": lambda: diagram.connect(orifice.a, wheel.shaft),
        "signal cannot be joined to a power port": lambda: diagram.connect(orifice.a, lag.u),
        "one output and inputs": lambda: diagram.connect(lag.u, dial.u),
        "Did you mean 'shaft'": lambda: wheel.shft,
        "belongs to diagram 'other'": lambda: diagram.connect(stranger.flange, stranger.flange),
        "is the name of a component already": lambda: diagram.add("lag", Lag()),
    }
    for text, attempt in cases.items():
        with pytest.raises(StructureError, match=text):
            attempt()


def test_a_signal_in_the_wrong_unit_is_refused():
    diagram = Diagram("d")
    lag = diagram.add("lag", Lag())

    class Dial(InMillimetre):
        ports = {"u": InMillimetre.ports["u"].__class__("bar")}

    with pytest.raises(StructureError, match=r"takes a signal in bar, but lag.y gives one in m"):
        diagram.connect(lag.y, diagram.add("gauge", Dial()).u)


def test_sources_of_the_laws_are_collected():
    assert filling().compile().sources == ("Merritt, Hydraulic Control Systems, 1967, eq. 3-30",)


class Tank(Component):
    height: Length = parameter("height of the tank", above=0)
    full: Length = initial("level at the start")
    ports = {"u": SignalIn("m")}

    def begins(self):
        return self.height

    def equations(self, m):
        level = m.state("level", unit="m", start=self.begins())
        yield m.der(level), m.u - level


class TankFromNumber(Tank):
    def begins(self):
        return self.full


class TankFromNowhere(Tank):
    def begins(self):
        return float("inf")


def draining(tank):
    diagram = Diagram("d")
    diagram.expose(u=diagram.add("tank", tank).u)
    return diagram


def test_a_state_that_starts_from_a_parameter_is_told_to_start_from_an_initial_value():
    text = refused(draining(Tank(height=2.0)))
    assert "tank.level: has a start value that depends on the parameter tank.height, but it must be a number" in text
    assert "Declare what a state starts from as `initial`" in text
    assert draining(TankFromNumber(height=2.0, full=1.5)).compile().states[0].start == 1.5
    assert "start value that is not a finite number (got inf)" in refused(draining(TankFromNowhere(height=2.0)))
