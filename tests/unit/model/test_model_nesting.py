"""A diagram placed in another is as if its components stood there, under its name."""

import pytest
from parts import Chamber, InMillimetre, Lag, Orifice, PressureSource

from seacrane.errors import ParameterError, StructureError
from seacrane.model import Diagram, simulate
from seacrane.units import bar, l, mm


def branch(**shared):
    """An orifice into a chamber, and a lag beside it."""
    diagram = Diagram("branch", **shared)
    orifice = diagram.add("orifice", Orifice(diameter=5 * mm))
    chamber = diagram.add("chamber", Chamber(volume=1 * l, pressure=10 * bar))
    lag = diagram.add("lag", Lag())
    diagram.connect(orifice.b, chamber.a)
    diagram.expose(inlet=orifice.a, u=lag.u, y=lag.y)
    return diagram


def plant(first, second, **shared):
    diagram = Diagram("plant", **shared)
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    one, two = diagram.add("one", first), diagram.add("two", second)
    diagram.connect(pump.p, one.inlet, two.inlet)
    diagram.connect(one.y, two.u)
    diagram.expose(u=one.u, y=two.y)
    return diagram


def test_a_diagram_placed_twice_gives_two_independent_copies():
    inner = branch()
    dae = plant(inner, inner).compile()
    names = [v.name for v in dae.states]
    assert names == ["one.chamber.p", "one.lag.level", "two.chamber.p", "two.lag.level"]
    changed = {"two.orifice.diameter": 1 * mm, "two.lag.rate": 5.0}
    run = simulate(plant(inner, inner), 0.1, every=0.001, inputs={"u": 1.0}, parameters=changed)
    assert run["one.chamber.p"][2] > 5 * run["two.chamber.p"][2]
    assert run["y"][-1] == pytest.approx(run["two.lag.level"][-1])


def test_what_is_added_to_a_diagram_later_is_not_in_the_copy():
    inner = branch()
    whole = plant(inner, inner)
    inner.add("more", Chamber(volume=1 * l))
    assert not [v for v in whole.compile().variables if "more" in v.name]


def test_a_shared_parameter_of_the_inner_diagram_goes_before_the_one_around_it():
    dae = plant(branch(density=900.0), branch(), density=850.0).compile()
    shared = {v.name: v.start for v in dae.parameters if v.name.endswith("density")}
    assert shared == {"one.density": 900.0, "density": 850.0}


def test_diagrams_nest_to_any_depth_with_full_names():
    middle = plant(branch(), branch())
    outer = Diagram("outer")
    inside = outer.add("ship", middle)
    outer.expose(u=inside.u, result=inside.y)
    dae = outer.compile()
    assert "ship.two.orifice.cd" in [v.name for v in dae.parameters]
    assert [v.name for v in dae.outputs] == ["result"]


def test_faults_inside_are_told_with_their_full_path():
    whole = Diagram("whole")
    whole.add("one", branch())
    with pytest.raises(StructureError) as caught:
        whole.compile()
    text = str(caught.value)
    assert "whole.one.orifice.a: is connected to nothing" in text
    assert "whole.one.lag.u: is given no signal" in text
    part = whole.parts["one"]
    with pytest.raises(StructureError, match=r"one: has no port 'inlt'. Did you mean 'inlet'"):
        _ = part.inlt
    with pytest.raises(StructureError, match="one: is the diagram 'branch', not a component"):
        _ = part.component


def test_a_diagram_without_ports_and_a_signal_in_the_wrong_unit_are_refused():
    whole = Diagram("whole")
    with pytest.raises(StructureError, match=r"whole.empty: is the diagram 'bare', which has no ports to connect"):
        whole.add("empty", Diagram("bare"))
    one, dial = whole.add("one", branch()), whole.add("dial", InMillimetre())
    whole.connect(one.y, dial.u)
    with pytest.raises(StructureError, match="cannot be joined"):
        whole.connect(one.inlet, dial.u)


def test_a_shared_parameter_that_no_component_has_is_questioned():
    with pytest.raises(StructureError, match=r"plant.one.densty: is no shared parameter.*Did you mean 'density'"):
        plant(branch(densty=900.0), branch()).compile()


def test_a_parameter_of_a_nested_component_is_found_by_its_nearest_name():
    with pytest.raises(ParameterError, match=r"Did you mean 'one.lag.rate'"):
        simulate(plant(branch(), branch()), 0.1, parameters={"one.lag.rat": 1.0})
