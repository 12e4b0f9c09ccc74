"""Bond graphs of diagrams: how they are joined and simplified, and the causality they get."""

from __future__ import annotations

import itertools
import math
import time
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.library import signals
from seacrane.model import Diagram, load
from seacrane.model.bondgraph import SystemBondGraph
from seacrane.units import bar, l, l_min, mm


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


def test_every_bond_has_the_domain_of_its_power() -> None:
    diagram = Diagram("lift")
    valve = diagram.add("valve", hyd.DirectionalValve43(flow=100 * l_min, at=35 * bar))
    cylinder = diagram.add("cylinder", hyd.DoubleActingCylinder(bore=100 * mm, rod=50 * mm, stroke=1.0))
    mass = diagram.add("mass", mech.Mass(mass=10.0, gravity=9.81))
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(pump.p, valve.p)
    diagram.connect(tank.p, valve.t)
    diagram.connect(valve.a, cylinder.a)
    diagram.connect(valve.b, cylinder.b)
    diagram.connect(cylinder.rod, mass.flange)
    domains = {frozenset((b.tail, b.head)): b.domain for b in diagram.bond_graph().bonds}
    assert set(domains.values()) == {"hydraulic", "translational"}
    assert all(domain == "translational" for ends, domain in domains.items() if "mass.inertia" in ends)


# ---------------------------------------------------------------- signals
def test_what_modulates_an_element_is_drawn_from_the_block_or_input_it_comes_from() -> None:
    diagram = Diagram("metered")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    lag = diagram.add("lag", signals.FirstOrderLag(time_constant=0.1))
    edge = diagram.add("edge", hyd.VariableOrifice(diameter=3 * mm))
    volume = diagram.add("volume", hyd.ControlVolume(volume=5 * l))
    diagram.connect(pump.p, edge.a)
    diagram.connect(edge.b, volume.a)
    diagram.connect(lag.y, edge.k)
    diagram.expose(command=lag.u)
    graph = diagram.bond_graph()
    assert {(link.tail, link.head) for link in graph.links} == {("command", "lag"), ("lag", "edge.edge")}
    assert {e.name: e.kind for e in graph.elements if e.kind in ("block", "MR")} == {
        "command": "block",
        "lag": "block",
        "edge.edge": "MR",
    }
    assert str(graph).splitlines()[-2:] == ["  command ~> lag", "  lag ~> edge.edge"]
    dashed = [e for e in ET.fromstring(graph.svg()).iter() if e.get("stroke-dasharray")]
    assert len(dashed) == len(graph.links)


def test_a_pilot_pressure_modulates_the_seat_from_the_node_where_it_is_sensed() -> None:
    diagram = Diagram("held")
    valve = diagram.add(
        "valve", hyd.CounterbalanceValve(flow=100 * l_min, at=10 * bar, crack=200 * bar, full=250 * bar, ratio=4.0)
    )
    for side in ("a", "b", "pilot"):
        volume = diagram.add(f"volume_{side}", hyd.ControlVolume(volume=1 * l))
        diagram.connect(volume.a, getattr(valve, side))
    links = {(link.tail, link.head) for link in diagram.bond_graph().links}
    assert ("node valve.pilot", "valve.seat") in links or ("volume_pilot.oil", "valve.seat") in links
    assert len(links) == 2


# ---------------------------------------------------------------- diagrams in diagrams
def fleet(count: int) -> Diagram:
    """Equal units on one pump."""
    unit = Diagram("unit")
    edge = unit.add("edge", hyd.VariableOrifice(diameter=3 * mm))
    bleed = unit.add("bleed", hyd.Orifice(diameter=1 * mm))
    volume = unit.add("volume", hyd.ControlVolume(volume=5 * l))
    tank = unit.add("tank", hyd.Tank())
    unit.connect(edge.b, volume.a)
    unit.connect(edge.a, bleed.a)
    unit.connect(bleed.b, tank.p)
    unit.expose(supply=edge.a, opening=edge.k)
    diagram = Diagram("fleet")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    line = diagram.add("line", hyd.Orifice(diameter=10 * mm))
    room = diagram.add("room", hyd.ControlVolume(volume=1 * l))
    parts = [diagram.add(f"unit_{i}", unit) for i in range(count)]
    diagram.connect(pump.p, line.a)
    diagram.connect(line.b, room.a, *(part.supply for part in parts))
    diagram.expose(**{f"opening_{i}": part.opening for i, part in enumerate(parts)})
    return diagram


def test_a_diagram_in_another_keeps_its_own_junctions_and_one_bond_to_the_outside_for_each_port() -> None:
    graph = fleet(2).bond_graph()
    scope = {element.name: element.scope for element in graph.elements}
    crossing = [bond for bond in graph.bonds if scope[bond.tail] != scope[bond.head]]
    assert [bond.ports[scope[bond.head]] for bond in crossing] == ["supply", "supply"]
    assert graph.findings == ()


def test_a_diagram_in_another_is_drawn_as_a_word_and_laid_open_once_for_all_that_are_alike() -> None:
    for svg in (fleet(3).bond_graph().svg(), fleet(3).icons_svg()):
        words = [e.text for e in ET.fromstring(svg).iter() if e.tag.endswith("text")]
        assert words.count("unit_0, unit_1, unit_2") == 1
        assert words.count("bleed") == 1
        assert {"supply", "opening"} <= set(words)


def test_causality_passes_through_the_ports_of_diagrams_in_diagrams() -> None:
    def kinds(graph: SystemBondGraph) -> list[tuple[str, bool]]:
        return sorted(
            (end.rpartition(".")[2], bond.effort_to == end)
            for bond in graph.bonds
            for end in (bond.tail, bond.head)
            if end.endswith((".edge", ".oil", ".supply"))
        )

    alone = Diagram("alone")
    pump = alone.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    line = alone.add("line", hyd.Orifice(diameter=10 * mm))
    room = alone.add("room", hyd.ControlVolume(volume=1 * l))
    edge = alone.add("edge", hyd.VariableOrifice(diameter=3 * mm))
    bleed = alone.add("bleed", hyd.Orifice(diameter=1 * mm))
    volume = alone.add("volume", hyd.ControlVolume(volume=5 * l))
    tank = alone.add("tank", hyd.Tank())
    alone.connect(pump.p, line.a)
    alone.connect(line.b, room.a, edge.a, bleed.a)
    alone.connect(edge.b, volume.a)
    alone.connect(bleed.b, tank.p)
    alone.expose(opening=edge.k)
    assert kinds(fleet(1).bond_graph()) == kinds(alone.bond_graph())


# ---------------------------------------------------------------- the drawing as a picture
@pytest.fixture(scope="module")
def boom_drive() -> str:
    return load(Path(__file__).parents[3] / "examples" / "boom_drive.json").bond_graph().svg()


def test_no_words_of_a_large_drawing_lie_on_each_other(boom_drive: str) -> None:
    boxes = []
    for e in ET.fromstring(boom_drive).iter():
        if e.tag.endswith("text"):
            x, y, size = (float(e.attrib[key]) for key in ("x", "y", "font-size"))
            half = 0.27 * size * len(e.text or "")
            boxes.append((x - half, y - 0.75 * size, x + half, y, e.text))
    for a, b in itertools.combinations(boxes, 2):
        assert a[0] >= b[2] or b[0] >= a[2] or a[1] >= b[3] or b[1] >= a[3], (a, b)


def test_causal_strokes_stand_apart_from_each_other(boom_drive: str) -> None:
    strokes = []
    for e in ET.fromstring(boom_drive).iter():
        if e.get("stroke-width") == "2.2":
            (x0, y0), (x1, y1) = ([float(v) for v in p.split(",")] for p in e.attrib["points"].split())
            strokes.append(((x0 + x1) / 2, (y0 + y1) / 2))
    assert len(strokes) > 50
    near = [(a, b) for a, b in itertools.combinations(strokes, 2) if math.dist(a, b) < 6]
    assert len(near) <= 1


def test_a_drawing_of_sixty_elements_takes_a_second_or_so() -> None:
    """One sheet without diagrams in it; the bound is wide because machines differ."""
    diagram = Diagram("star")
    room = diagram.add("room", hyd.ControlVolume(volume=1 * l))
    ports = []
    for i in range(19):
        edge = diagram.add(f"edge{i}", hyd.Orifice(diameter=3 * mm))
        volume = diagram.add(f"volume{i}", hyd.ControlVolume(volume=1 * l))
        diagram.connect(volume.a, edge.a)
        ports.append(edge.b)
    diagram.connect(room.a, *ports)
    graph = diagram.bond_graph()
    begun = time.process_time()
    graph.svg()
    assert time.process_time() - begun < 8
