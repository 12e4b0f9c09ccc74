"""What is wrong with a circuit is told by component and port, with a cure that then works."""

from __future__ import annotations

import pytest

from seacrane.errors import ParameterError, StructureError
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.model import Component, Diagram
from seacrane.units import bar, l, mm

FLOW = hyd.Pump(level="constant-flow", displacement=1e-5, speed=150.0)
ORIFICE = hyd.Orifice(diameter=3 * mm)


def joined(parts: dict[str, Component], *nodes: str) -> Diagram:
    """A diagram of these parts with nodes written as "pump.p edge.a"."""
    diagram = Diagram("d")
    placed = {name: diagram.add(name, part) for name, part in parts.items()}
    for node in nodes:
        diagram.connect(*(getattr(placed[path.split(".")[0]], path.split(".")[1]) for path in node.split()))
    return diagram


def told(diagram: Diagram) -> str:
    with pytest.raises(StructureError) as caught:
        diagram.compile()
    return str(caught.value)


def test_two_pressures_on_one_node_want_an_orifice_between_them() -> None:
    pump = hyd.ConstantPressurePump(pressure=100 * bar)
    assert told(joined({"pump": pump, "tank": hyd.Tank()}, "pump.p tank.p")) == (
        "d: pump, tank determine pump.p.p more than once."
        " Two pressures on one node? Remove one source, or put an orifice or a hose between them."
    )
    cured = {"pump": pump, "tank": hyd.Tank(), "edge": ORIFICE}
    assert joined(cured, "pump.p edge.a", "edge.b tank.p").compile().algebraics == ()


def test_flow_into_a_closed_end_wants_a_volume() -> None:
    assert told(joined({"pump": FLOW, "plug": hyd.Plug()}, "pump.p plug.a")) == (
        "d: pump, plug determine pump.p.q more than once."
        " Flow imposed from both sides? Put a ControlVolume or a hose there, to take up the difference."
    )
    cured = {"pump": FLOW, "plug": hyd.Plug(), "room": hyd.ControlVolume(volume=1 * l)}
    assert len(joined(cured, "pump.p plug.a room.a").compile().states) == 1


def test_two_speeds_on_one_shaft_want_a_spring_between_them() -> None:
    two = {"left": mec.SpeedInput(), "right": mec.SpeedInput()}

    def turned(parts: dict[str, Component], *nodes: str) -> Diagram:
        diagram = joined(parts, *nodes)
        diagram.expose(left=diagram.parts["left"].w, right=diagram.parts["right"].w)
        return diagram

    assert told(turned(two, "left.flange right.flange")).endswith(
        "Two speeds on one shaft? Remove one source, or put a TorsionalSpringDamper between them."
    )
    shaft = {**two, "shaft": mec.TorsionalSpringDamper(stiffness=1e6, damping=1e3)}
    assert turned(shaft, "left.flange shaft.a", "shaft.b right.flange").compile().algebraics == ()


def test_a_port_left_open_and_a_signal_not_given_are_named() -> None:
    text = told(joined({"edge": hyd.VariableOrifice(diameter=3 * mm), "tank": hyd.Tank()}, "edge.b tank.p"))
    assert "d.edge.k: is given no signal. Connect it, or expose it." in text
    assert "d.edge.a: is connected to nothing. Connect it, expose it, or plug it." in text


def test_a_quantity_given_as_a_text_is_told_how_it_is_written() -> None:
    with pytest.raises(ParameterError) as caught:
        hyd.ConstantPressurePump(pressure="280 bar")  # type: ignore[arg-type]
    assert str(caught.value).endswith("(got '280 bar'). Write 280 * bar, with the constants of seacrane.units.")
    with pytest.raises(ParameterError) as caught:
        hyd.ConstantPressurePump(pressure="280 mm")  # type: ignore[arg-type]
    assert "Write" not in str(caught.value)
