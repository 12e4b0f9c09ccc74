"""What an instance adds to its class: checks of parameters together, and ports that an option shapes."""

import pytest

from seacrane.errors import ParameterError, Problem
from seacrane.model import Component, Diagram, SignalIn, SignalOut, option, parameter
from seacrane.units import Pressure


class Window(Component):
    low: Pressure = parameter("lower edge", above=0)
    high: Pressure = parameter("upper edge", above=0)

    def check(self):
        if self.low >= self.high:
            yield Problem("high", "must be above low", self.high)


class Copy(Component):
    unit: str = option("unit of both signals", default="1")
    ports = {"u": SignalIn(), "y": SignalOut()}

    def interface(self):
        return {"u": SignalIn(self.unit), "y": SignalOut(self.unit)}

    def equations(self, m):
        yield m.y, m.u


def test_parameters_that_contradict_each_other_are_refused():
    Window(low=1e5, high=2e5)
    with pytest.raises(ParameterError) as caught:
        Window(low=2e5, high=1e5)
    assert str(caught.value) == "Window.high: must be above low (got 100000.0)"


def test_parameters_are_checked_together_only_when_each_is_sound():
    with pytest.raises(ParameterError) as caught:
        Window(low=-1e5, high=-2e5)
    assert [problem.path for problem in caught.value.problems] == ["Window.low", "Window.high"]
    assert "must be above low" not in str(caught.value)


def test_the_unit_given_to_an_instance_is_the_unit_of_its_ports():
    diagram = Diagram("d")
    copy = diagram.add("copy", Copy(unit="bar"))
    other = diagram.add("other", Copy(unit="Pa"))
    diagram.connect(copy.y, other.u)
    diagram.expose(inlet=copy.u, outlet=other.y)
    dae = diagram.compile()
    assert dae.inputs[0].unit == "bar"
    assert dae.outputs[0].unit == "Pa"
