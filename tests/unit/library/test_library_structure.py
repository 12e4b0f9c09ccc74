"""Every component of the library can be drawn: it has a bond graph that fits its ports."""

from __future__ import annotations

import dataclasses
import xml.etree.ElementTree as ET

import pytest

import seacrane.library.hydraulics
import seacrane.library.mechanics
import seacrane.library.signals  # noqa: F401  (the registry holds what was imported)
from seacrane.model import REGISTRY, Component
from seacrane.model.ports import PowerPort
from seacrane.units import GRAVITY

LIBRARY = [c for c in REGISTRY if c.__module__.startswith("seacrane.library")]


@pytest.mark.parametrize("component", LIBRARY, ids=lambda c: c.__name__)
def test_bond_graph_has_one_bond_at_each_power_port_and_a_signal_at_each_signal_port(
    component: type[Component],
) -> None:
    power_ports = {name for name, port in component.ports.items() if isinstance(port, PowerPort)}
    assert component.bond_graph is not None
    assert component.bond_graph.misfits(component.__name__, power_ports, set(component.ports) - power_ports) == []


@pytest.mark.parametrize("component", LIBRARY, ids=lambda c: c.__name__)
def test_every_law_names_where_it_comes_from(component: type[Component]) -> None:
    assert component.sources
    assert all(len(source) > 10 for source in component.sources)


@pytest.mark.parametrize("component", LIBRARY, ids=lambda c: c.__name__)
def test_every_number_has_a_meaning_a_unit_and_bounds(component: type[Component]) -> None:
    for name, (declaration, quantity) in component.declarations.items():
        if declaration.role == "option":
            continue
        assert declaration.about
        assert quantity is not None, f"{name} has no unit"
        assert declaration.least is not None or declaration.above is not None, f"{name} has no lower bound"
        assert declaration.most is not None or declaration.below is not None, f"{name} has no upper bound"


@pytest.mark.parametrize("component", LIBRARY, ids=lambda c: c.__name__)
def test_every_default_that_is_a_choice_gives_its_reason(component: type[Component]) -> None:
    """0 and 1 leave something out (no friction, one cylinder); gravity is known to all."""
    for field in dataclasses.fields(component):  # type: ignore[arg-type]
        declaration, _ = component.declarations[field.name]
        default = getattr(field.default, "default", field.default)
        if declaration.role in ("parameter", "shared") and default not in (dataclasses.MISSING, 0, 1, GRAVITY):
            assert declaration.reason, field.name


@pytest.mark.parametrize("component", LIBRARY, ids=lambda c: c.__name__)
def test_icon_has_its_ports_on_grid_points_of_its_rim(component: type[Component]) -> None:
    icon = component.icon
    assert icon is not None
    assert set(icon.ports) <= set(component.ports)
    for x, y in icon.ports.values():
        assert x % 10 == 0
        assert y % 10 == 0
        assert x in (0, icon.width) or y in (0, icon.height)


@pytest.mark.parametrize("component", LIBRARY, ids=lambda c: c.__name__)
def test_icon_is_well_formed_svg(component: type[Component]) -> None:
    assert component.icon is not None
    assert len(ET.fromstring(f"<svg>{component.icon.svg}</svg>")) > 0
