"""Workspaces against closed forms."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.design import chart, geometry, planar, workspace
from seacrane.errors import DesignError

OFFSHORE = design.load("offshore-100t")


def test_area_of_two_revolute_links_is_the_closed_form() -> None:
    """|det J| = L2 L3 |sin q3|, and no point is reached twice with the jib on one side only."""
    (low, high), (folded, straight) = (joint.limits for joint in planar.plane_joints(OFFSHORE))
    expected = 18 * 14 * (high - low) * (math.cos(straight) - math.cos(folded))
    assert workspace.section(OFFSHORE).area == pytest.approx(expected, rel=1e-3)


def test_area_and_volume_of_a_telescope_are_those_of_a_ring_sector() -> None:
    crane = design.load("gangway-24m")
    (low, high), (short, long) = (joint.limits for joint in planar.plane_joints(crane))
    found = workspace.section(crane)
    inner, outer = 14 + short, 14 + long
    assert found.area == pytest.approx(0.5 * (high - low) * (outer**2 - inner**2), rel=2e-3)
    first = (outer**3 - inner**3) / 3 * (math.sin(high) - math.sin(low)) + 0.6 * found.area
    assert found.volume(crane) == pytest.approx(2 * math.pi * first, rel=3e-3)


def test_the_area_converges_with_the_cells() -> None:
    exact = 18 * 14 * math.radians(78) * (1 - math.cos(math.radians(-115)))
    errors = [abs(workspace.section(OFFSHORE, cells).area / exact - 1) for cells in (40, 160, 640)]
    assert errors[0] > errors[2]
    assert errors[2] < 5e-4


@pytest.mark.parametrize("name", design.names())
def test_wherever_a_posture_brings_the_tip_the_section_is_reachable(name: str) -> None:
    crane = design.load(name)
    found = workspace.section(crane, 150)
    random = np.random.default_rng(1)
    at = {joint.name: random.uniform(*joint.limits, 400) for joint in planar.plane_joints(crane)}
    x, z = planar.Plane(crane, at).tip()
    width, height = found.cell
    column = np.clip(((x - found.radius[0]) / width + 0.5).astype(int), 2, 147)
    row = np.clip(((z - found.height[0]) / height + 0.5).astype(int), 2, 147)
    near = [found.reachable[r - 2 : r + 3, c - 2 : c + 3].any() for r, c in zip(row, column, strict=True)]
    assert all(near)
    assert not found.reachable.all()


def test_the_postures_of_a_point_bring_the_tip_there() -> None:
    links = list(OFFSHORE.links)
    both_ways = msgspec.structs.replace(links[2].joint, limits=(-2.0, 2.0))
    links[2] = msgspec.structs.replace(links[2], joint=both_ways)
    crane = msgspec.structs.replace(OFFSHORE, links=tuple(links), cylinders=())
    found = workspace.postures_at(crane, 24.0, 17.0)
    assert len(found) == 2
    for posture in found:
        x, _, z = geometry.tip(crane, posture)
        assert (x, z) == pytest.approx((24.0, 17.0), abs=1e-9)
    assert workspace.postures_at(crane, 40.0, 17.0) == []


def test_slewing_between_limits_sweeps_its_share() -> None:
    column = OFFSHORE.links[0]
    joint = msgspec.structs.replace(column.joint, limits=(-1.0, 1.0))
    part = msgspec.structs.replace(OFFSHORE, links=(msgspec.structs.replace(column, joint=joint), *OFFSHORE.links[1:]))
    found = workspace.section(OFFSHORE, 200)
    assert found.volume(part) == pytest.approx(found.volume(OFFSHORE) / math.pi)
    assert workspace.slewing_range(design.load("a-frame-30t")) == 0.0


def test_one_joint_has_no_section() -> None:
    crane = msgspec.structs.replace(OFFSHORE, links=OFFSHORE.links[:2], cylinders=OFFSHORE.cylinders[:1])
    with pytest.raises(DesignError, match="two joints in the plane"):
        workspace.section(crane)


def test_the_load_over_the_section_is_that_of_the_postures_of_its_cells() -> None:
    found = workspace.section(OFFSHORE, 80)
    best = workspace.loads(OFFSHORE, found)
    assert np.array_equal(np.isfinite(best), found.reachable)
    for row, column in zip(*(index[::400] for index in np.nonzero(found.reachable)), strict=True):
        postures = workspace.postures_at(OFFSHORE, float(found.radius[column]), float(found.height[row]))
        most = max(min(chart.each_limit(OFFSHORE, posture).values()) for posture in postures)
        assert best[row, column] == pytest.approx(most, rel=1e-9)


def test_with_a_telescope_no_posture_lifts_more_than_the_section_says() -> None:
    crane = design.load("gunnerus-pk65")
    found = workspace.section(crane, 60)
    best = workspace.loads(crane, found)
    assert np.all(np.isfinite(best[found.reachable]) | (best[found.reachable] >= 0))
    for row in chart.curve(crane, radii=[8.0, 14.0]):
        column = int(np.argmin(np.abs(found.radius - row.radius)))
        assert np.nanmax(best[:, column]) == pytest.approx(row.swl, rel=0.06)
