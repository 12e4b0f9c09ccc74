"""Changes of a design that keep it whole."""

from __future__ import annotations

import pytest

from seacrane import design
from seacrane.design import changes, chart, geometry, mass, workspace
from seacrane.errors import DesignError

OFFSHORE = design.load("offshore-100t")


def test_a_longer_boom_reaches_further_by_as_much_and_is_heavier_in_proportion() -> None:
    longer = changes.changed(OFFSHORE, {"links[boom].length": 20.0})
    assert design.check(longer) == []
    assert workspace.extent(longer)[1] == pytest.approx(workspace.extent(OFFSHORE)[1] + 2.0, abs=1e-3)
    boom = longer.link("boom")
    assert boom.mass == pytest.approx(OFFSHORE.link("boom").mass * 20 / 18)
    assert boom.inertia[1] == pytest.approx(OFFSHORE.link("boom").inertia[1] * (20 / 18) ** 3)
    assert longer.hoist.sheaves[0].x == pytest.approx(20.0)
    assert longer.cylinder("jib_cylinder").base.x == pytest.approx(12.5)
    assert longer.cylinder("boom_cylinder").eye.x == pytest.approx(6.5)


def test_a_larger_bore_keeps_the_share_of_its_rod_and_pushes_by_the_square() -> None:
    larger = changes.changed(OFFSHORE, {"cylinders[boom_cylinder].bore": 0.48}).cylinder("boom_cylinder")
    before = OFFSHORE.cylinder("boom_cylinder")
    assert larger.rod == pytest.approx(0.3 * 0.48 / 0.42)
    assert chart.forces(larger)[0] == pytest.approx(chart.forces(before)[0] * (0.48 / 0.42) ** 2)
    assert mass.of_cylinder(larger) > mass.of_cylinder(before)


def test_a_moved_pin_gets_the_stroke_that_it_needs() -> None:
    moved = changes.changed(OFFSHORE, {"cylinders[boom_cylinder].eye.x": 7.0})
    cylinder = moved.cylinder("boom_cylinder")
    shortest, longest = geometry.cylinder_range(moved, cylinder)
    assert cylinder.stroke == pytest.approx(longest - shortest)
    assert cylinder.stroke > OFFSHORE.cylinder("boom_cylinder").stroke


def test_values_read_back_and_unknown_paths_get_the_nearest() -> None:
    for path in ("links[jib].length", "cylinders[jib_cylinder].rod", "cylinders[jib_cylinder].base.z"):
        now = changes.value(OFFSHORE, path)
        assert changes.value(changes.changed(OFFSHORE, {path: now * 1.01}), path) == pytest.approx(now * 1.01)
    with pytest.raises(DesignError, match=r"the crane has no such link \(got 'bom'\)\. Did you mean 'boom'"):
        changes.changed(OFFSHORE, {"links[bom].length": 3.0})
    with pytest.raises(DesignError, match=r"is not a size that can be changed; allowed: links\[NAME\]\.length"):
        changes.value(OFFSHORE, "links[boom].mass")


def test_the_estimate_of_a_cylinder_is_near_that_of_its_steel() -> None:
    """A 420/300 mm cylinder of 4.4 m stroke: the rod alone is 2.4 t, the barrel of 39 mm about 2.1 t."""
    pair = mass.of_cylinder(OFFSHORE.cylinder("boom_cylinder"))
    rods = 2 * 7850 * 3.14159265 / 4 * 0.3**2 * 4.4
    assert rods < pair < 3 * rods
