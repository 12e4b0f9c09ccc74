"""Bond graphs of diagrams: how they are joined and simplified, and the causality they get."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.model import Diagram
from seacrane.model.bondgraph import SystemBondGraph
from seacrane.units import bar, l, mm


def filling() -> Diagram:
    """A pump fills a volume through an orifice."""
    diagram = Diagram("filling")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    edge = diagram.add("edge", hyd.Orifice(diameter=3 * mm))
    volume = diagram.add("volume", hyd.ControlVolume(volume=5 * l))
    diagram.connect(pump.p, edge.a)
    diagram.connect(edge.b, volume.a)
    return diagram


def two_masses() -> Diagram:
    """Two masses on one rod: only one of them can keep its own speed."""
    diagram = Diagram("rod")
    first = diagram.add("first", mech.Mass(mass=10.0))
    second = diagram.add("second", mech.Mass(mass=20.0))
    diagram.connect(first.flange, second.flange)
    return diagram


def strokes(graph: SystemBondGraph) -> dict[frozenset[str], str | None]:
    return {frozenset((bond.tail, bond.head)): bond.effort_to for bond in graph.bonds}


def test_a_volume_behind_an_orifice_is_one_flow_junction_with_source_resistor_and_store() -> None:
    graph = filling().bond_graph()
    assert {element.name: element.kind for element in graph.elements} == {
        "pump.supply": "Se",
        "edge.through": "1",
        "edge.edge": "R",
        "volume.oil": "C",
    }
    assert strokes(graph) == {
        frozenset(("pump.supply", "edge.through")): "edge.through",
        frozenset(("edge.through", "edge.edge")): "edge.edge",
        frozenset(("edge.through", "volume.oil")): "edge.through",
    }
    assert graph.findings == ()
    assert {bond.domain for bond in graph.bonds} == {"hydraulic"}


def test_of_two_masses_on_one_rod_one_has_derivative_causality() -> None:
    graph = two_masses().bond_graph()
    assert [(f.sort, f.element) for f in graph.findings] == [("derivative", "second.inertia")]


def test_orifices_in_series_without_a_volume_are_an_algebraic_loop() -> None:
    diagram = Diagram("series")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    first = diagram.add("first", hyd.Orifice(diameter=3 * mm))
    second = diagram.add("second", hyd.Orifice(diameter=3 * mm))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(pump.p, first.a)
    diagram.connect(first.b, second.a)
    diagram.connect(second.b, tank.p)
    assert [f.sort for f in diagram.bond_graph().findings] == ["loop"]


def test_two_pressure_sources_on_one_node_are_a_conflict() -> None:
    diagram = Diagram("clash")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    tank = diagram.add("tank", hyd.Tank())
    volume = diagram.add("volume", hyd.ControlVolume(volume=1 * l))
    diagram.connect(pump.p, tank.p, volume.a)
    findings = diagram.bond_graph().findings
    assert {"conflict", "derivative"} == {f.sort for f in findings}
    assert "tank.tank: imposes its effort where it is imposed already" in [str(f) for f in findings]


def test_an_exposed_rod_is_moved_from_outside() -> None:
    diagram = Diagram("drive")
    spring = diagram.add("spring", mech.SpringDamper(stiffness=1e5, damping=10.0))
    mass = diagram.add("mass", mech.Mass(mass=5.0))
    diagram.connect(spring.b, mass.flange)
    diagram.expose(rod=spring.a)
    graph = diagram.bond_graph()
    assert {e.name: e.kind for e in graph.elements}["rod"] == "MSf"
    assert graph.findings == ()


def test_the_drawing_has_a_stroke_a_half_arrow_and_a_line_for_each_bond() -> None:
    graph = filling().bond_graph()
    root = ET.fromstring(graph.svg())
    lines = [e for e in root if e.tag.endswith("polyline")]
    words = [e.text for e in root if e.tag.endswith("text")]
    assert len(lines) == 3 * len(graph.bonds)
    assert {"Se", "1", "R", "C", "supply", "pump"} <= set(words)


def test_the_drawing_tells_what_is_wrong() -> None:
    svg = two_masses().bond_graph().svg()
    assert "derivative: second.inertia: has derivative causality" in svg


def test_the_drawing_is_the_same_each_time() -> None:
    assert filling().bond_graph().svg() == filling().bond_graph().svg()


def test_the_list_shows_half_arrows_and_strokes() -> None:
    assert str(filling().bond_graph()).splitlines() == [
        "filling: 1 1, 1 C, 1 R, 1 Se",
        "  pump.supply ->| edge.through",
        "  edge.through ->| edge.edge",
        "  edge.through |-> volume.oil",
    ]


def test_a_source_with_many_branches_is_drawn_at_each_of_them() -> None:
    diagram = Diagram("star")
    tank = diagram.add("tank", hyd.Tank())
    ports = []
    for i in range(3):
        edge = diagram.add(f"edge{i}", hyd.Orifice(diameter=3 * mm))
        volume = diagram.add(f"volume{i}", hyd.ControlVolume(volume=1 * l))
        diagram.connect(volume.a, edge.a)
        ports.append(edge.b)
    diagram.connect(tank.p, *ports)
    graph = diagram.bond_graph()
    kinds = [e.kind for e in graph.elements]
    assert (kinds.count("Se"), kinds.count("0")) == (1, 4)
    words = [e.text for e in ET.fromstring(graph.svg()) if e.tag.endswith("text")]
    assert (words.count("Se"), words.count("0")) == (3, 3)
