"""Iconic diagrams: symbols that do not overlap, right-angled lines that join what is joined and nothing else."""

from __future__ import annotations

import itertools
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from typing import Any

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.library import signals
from seacrane.model import Component, Diagram, Hydraulic, SignalIn
from seacrane.model.drawing.arrangement import Item, Wire, arrange
from seacrane.model.drawing.routing import Router
from seacrane.units import bar, l, l_min, mm


def drive() -> Diagram:
    """A cylinder moved by a 4/3 valve."""
    diagram = Diagram("drive")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=210 * bar))
    tank = diagram.add("tank", hyd.Tank())
    valve = diagram.add("valve", hyd.DirectionalValve43(flow=100 * l_min, at=35 * bar))
    relief = diagram.add("relief", hyd.ReliefValve(crack=200 * bar, full=220 * bar, flow=100 * l_min))
    cylinder = diagram.add("cylinder", hyd.DoubleActingCylinder(bore=100 * mm, rod=50 * mm, stroke=1.0))
    volume = diagram.add("volume", hyd.ControlVolume(volume=1 * l))
    rod = diagram.add("rod", mech.MotionInput())
    diagram.connect(pump.p, valve.p, relief.a)
    diagram.connect(tank.p, valve.t, relief.b)
    diagram.connect(valve.a, cylinder.a, volume.a)
    diagram.connect(valve.b, cylinder.b)
    diagram.connect(cylinder.rod, rod.flange)
    diagram.expose(spool=valve.x, velocity=rod.v, position=rod.x, force=rod.F)
    return diagram


def drawn(svg: str, tag: str) -> list[ET.Element]:
    return [e for e in ET.fromstring(svg) if e.tag.endswith(tag)]


def segments(svg: str) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
    for line in drawn(svg, "polyline"):
        points = [tuple(float(v) for v in p.split(",")) for p in line.attrib["points"].split()]
        if float(line.attrib["stroke-width"]) > 1.5:  # heads of arrows are thinner
            yield from itertools.pairwise(points)  # type: ignore[misc]


def test_lines_are_right_angled() -> None:
    for (x0, y0), (x1, y1) in segments(drive().icons_svg()):
        assert x0 == x1 or y0 == y1


def test_every_component_is_drawn_with_its_name_and_each_tank_connection_with_a_tank() -> None:
    svg = drive().icons_svg()
    words = [e.text for e in drawn(svg, "text")]
    assert {"pump", "valve", "relief", "cylinder", "volume", "rod"} <= set(words)
    assert len(drawn(svg, "g")) == 6 + 2


def test_exposed_names_stand_at_their_ports() -> None:
    words = [e.text for e in drawn(drive().icons_svg(), "text")]
    assert {"spool", "velocity", "position", "force"} <= set(words)


def test_lines_have_the_colour_of_their_domain() -> None:
    colours = {line.attrib["stroke"] for line in drawn(drive().icons_svg(), "polyline")}
    assert {"#b3261e", "#1f5f8b", "#6b6b6b"} <= colours


def test_the_drawing_is_the_same_each_time() -> None:
    assert drive().icons_svg() == drive().icons_svg()


def test_names_cannot_break_out_of_the_document() -> None:
    diagram = Diagram('<script>alert("x")</script>')
    diagram.add("tank", hyd.Tank())
    diagram.add("plug", hyd.Plug())
    assert "<script" not in diagram.icons_svg()


def test_a_component_without_an_icon_is_a_box_with_its_name() -> None:
    class Booster(Component):
        ports = {"a": Hydraulic(), "b": Hydraulic(), "on": SignalIn()}

    diagram = Diagram("test")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=100 * bar))
    booster = diagram.add("booster", Booster())
    plug = diagram.add("plug", hyd.Plug())
    switch = diagram.add("switch", signals.Constant(value=1.0))
    diagram.connect(pump.p, booster.a)
    diagram.connect(booster.b, plug.a)
    diagram.connect(switch.y, booster.on)
    assert "Booster</text>" in diagram.icons_svg()
    assert [e.kind for e in diagram.bond_graph().elements if e.name == "booster"] == ["word"]


def test_symbols_keep_their_distance() -> None:
    items = {f"s{i}": Item(40, 40) for i in range(9)}
    chain = [
        Wire(((f"s{i}", (20.0, 0.0), (0, -1)), (f"s{i + 1}", (20.0, 40.0), (0, 1))), "hydraulic", (False, False))
        for i in range(8)
    ]
    at = arrange(items, chain)
    for a, b in itertools.combinations(at.values(), 2):
        assert abs(a[0] - b[0]) >= 60 or abs(a[1] - b[1]) >= 60


def test_lines_of_different_nodes_cross_but_never_run_together() -> None:
    router = Router([])
    first, _ = router.tree([((0.0, 50.0), (1, 0)), ((200.0, 50.0), (-1, 0))])
    second, _ = router.tree([((100.0, 0.0), (0, 1)), ((100.0, 100.0), (0, -1))])
    third, _ = router.tree([((20.0, 50.0), (0, -1)), ((180.0, 50.0), (0, -1))])
    assert first == [[(200.0, 50.0), (0.0, 50.0)]]
    assert second == [[(100.0, 100.0), (100.0, 0.0)]]
    inside = [y for x, y in third[0] if 20 < x < 180]
    assert 50.0 not in inside


def test_lines_go_round_symbols() -> None:
    router = Router([(40.0, -40.0, 60.0, 40.0)])
    (path,), _ = router.tree([((0.0, 0.0), (1, 0)), ((100.0, 0.0), (-1, 0))])
    assert max(abs(y) for _, y in path) > 40


def test_sources_are_those_of_the_levels_used() -> None:
    def cylinder(level: str) -> Any:
        diagram = Diagram("test")
        diagram.add("cylinder", hyd.DoubleActingCylinder(level=level, bore=100 * mm, rod=50 * mm, stroke=1.0))
        return diagram.sources()

    assert any("friction" in source for source in cylinder("extended"))
    assert not any("friction" in source for source in cylinder("simplified"))
    assert len(drive().sources()) == len(set(drive().sources()))


def test_coordinates_are_finite_numbers() -> None:
    assert not re.search(r"nan|inf\b", drive().icons_svg())


def test_parts_that_nothing_joins_stand_beside_one_another_without_overlap() -> None:
    items = {f"s{i}": Item(40, 40) for i in range(12)}
    at = arrange(items, [])
    for a, b in itertools.combinations(at.values(), 2):
        assert abs(a[0] - b[0]) >= 80 or abs(a[1] - b[1]) >= 80
    assert max(x for x, _ in at.values()) < 600
