"""A trimmed model stands still where the balance of its laws says."""

import numpy as np
import pytest
from parts import Chamber, Lag, LinearOrifice, MassBlock, Orifice, PressureSource, Push, Spring, Wall

from seacrane.errors import ParameterError, SolveError
from seacrane.model import Diagram, simulate, trim
from seacrane.units import bar, l, mm


def divider(first=5 * mm, second=5 * mm):
    """Pump, orifice, chamber, orifice, tank."""
    diagram = Diagram("divider")
    pump = diagram.add("pump", PressureSource(pressure=200 * bar))
    tank = diagram.add("tank", PressureSource(pressure=1 * bar))
    one, two = diagram.add("one", Orifice(diameter=first)), diagram.add("two", Orifice(diameter=second))
    chamber = diagram.add("chamber", Chamber(volume=1 * l))
    diagram.connect(pump.p, one.a)
    diagram.connect(one.b, chamber.a, two.a)
    diagram.connect(two.b, tank.p)
    return diagram


@pytest.mark.parametrize("second", [1 * mm, 5 * mm, 8 * mm])
def test_a_pressure_divider_settles_where_both_flows_are_equal(second):
    rest = trim(divider(second=second))
    ratio = (second / (5 * mm)) ** 4
    expected = (200e5 + ratio * 1e5) / (1 + ratio)
    assert rest.start["chamber.p"] == pytest.approx(expected, rel=1e-3)
    assert rest.values["one.a.q"] == pytest.approx(rest.values["two.a.q"], rel=1e-6)


def test_a_simulation_from_the_trimmed_state_stands_still():
    diagram = divider()
    run = simulate(diagram, 1.0, parameters=trim(diagram).start)
    assert run["chamber.p"] == pytest.approx(np.full_like(run.time, run["chamber.p"][0]), rel=1e-7)


def test_an_undamped_oscillator_comes_to_rest_at_its_force():
    diagram = Diagram("oscillator")
    wall, spring = diagram.add("wall", Wall()), diagram.add("spring", Spring(stiffness=4e4))
    block, push = diagram.add("block", MassBlock(mass=100.0)), diagram.add("push", Push(force=500.0))
    diagram.connect(wall.flange, spring.b)
    diagram.connect(spring.a, block.flange, push.flange)
    rest = trim(diagram)
    assert rest.start["spring.f"] == pytest.approx(500.0)
    assert rest.start["block.v"] == pytest.approx(0.0, abs=1e-9)


def test_inputs_and_parameters_set_the_state():
    diagram = Diagram("following")
    lag = diagram.add("lag", Lag())
    diagram.expose(u=lag.u, y=lag.y)
    assert trim(diagram, inputs={"u": 3.0}, parameters={"lag.level": -100.0}).values["y"] == pytest.approx(3.0)


def sinking():
    diagram = Diagram("sinking")
    push, block = diagram.add("push", Push(force=500.0)), diagram.add("block", MassBlock(mass=100.0))
    wall, spring = diagram.add("wall", Wall()), diagram.add("spring", Spring(stiffness=4e4))
    diagram.connect(push.flange, block.flange, spring.a)
    diagram.connect(spring.b, wall.flange)
    return diagram


def test_a_held_state_stays_and_its_rate_is_told():
    rest = trim(sinking(), parameters={"block.v": 0.5, "spring.f": 100.0}, hold=["block.v", "spring.f"])
    assert (rest.start["block.v"], rest.start["spring.f"]) == (0.5, 100.0)
    assert rest.moving["block.v"] == pytest.approx((500.0 - 100.0) / 100.0)
    assert rest.moving["spring.f"] == pytest.approx(4e4 * 0.5)


def test_what_does_not_settle_is_named_with_its_rate():
    diagram = Diagram("pumping")
    source = diagram.add("source", PressureSource(pressure=200 * bar))
    leak = diagram.add("leak", LinearOrifice(diameter=5 * mm))
    chamber = diagram.add("chamber", Chamber(volume=1 * l))
    push, block = diagram.add("push", Push(force=500.0)), diagram.add("block", MassBlock(mass=100.0))
    wall, spring = diagram.add("wall", Wall()), diagram.add("spring", Spring(stiffness=4e4))
    diagram.connect(source.p, leak.a)
    diagram.connect(leak.b, chamber.a)
    diagram.connect(push.flange, block.flange, spring.a)
    diagram.connect(spring.b, wall.flange)
    with pytest.raises(SolveError) as caught:
        trim(diagram, parameters={"block.v": 0.5}, hold=["block.v"])
    text = str(caught.value)
    assert "spring.f: does not settle: it still changes by" in text
    assert "hold=['spring.f']" in text


def test_unknown_names_and_values_are_refused():
    with pytest.raises(ParameterError) as caught:
        trim(divider(), inputs={"u": 1.0}, parameters={"chamber.pp": 1.0}, hold=["chamber.q"])
    assert len(caught.value.problems) == 3
    assert "Did you mean 'chamber.p'" in str(caught.value)
    with pytest.raises(ParameterError, match=r"chamber.p: is not a finite number"):
        trim(divider(), parameters={"chamber.p": float("nan")})
