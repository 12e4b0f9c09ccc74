"""Which cranes can be operated, and where they start."""

from __future__ import annotations

import math

import msgspec
import numpy as np
import pytest

from seacrane import design, plant
from seacrane.control import axis_names
from seacrane.design import Crane, chart, geometry, planar
from seacrane.errors import ParameterError, StructureError
from seacrane.units import GRAVITY, bar

AXES = {
    "offshore-100t": ("slew", "boom", "jib"),
    "gunnerus-pk65": ("slew", "boom", "jib", "telescope"),
    "dual-drag-link-60t": ("slew", "boom", "jib", "outer_jib"),
    "gangway-24m": ("slew", "boom", "telescope"),
    "a-frame-30t": ("frame", "leg"),
}


def test_every_shipped_design_is_looked_at_here() -> None:
    assert sorted(AXES) == design.names()


def rod_force(crane: Crane, start: plant.Start, joint: str) -> float:
    """What the drive of a joint must push with [N], from the statics of the load chart's plane.

    Of a cylinder along its rod, of a telescope along its travel: the weights and the pull of the load by virtual work.
    """
    plane = planar.Plane(crane, {j.name: np.asarray(start.posture[j.name]) for j in planar.plane_joints(crane)})
    up = (0.0, 1.0)
    lifted = plane.by_joint(joint, plane.tip())[1] + plane.rope_by_joint(joint) / crane.hoist.falls
    borne = plane.own_moment(joint, up) + (start.load + crane.hoist.hook_mass) * lifted
    cylinder = next((c for c in crane.cylinders if c.moves == joint), None)
    lever = plane.distance_by_joint(joint, cylinder.base, cylinder.eye) if cylinder else 1.0
    return float(GRAVITY * borne / lever)


@pytest.mark.parametrize("name", AXES)
def test_the_drives_start_at_the_pressures_of_the_design_charts_statics(name: str) -> None:
    crane = design.load(name)
    start = plant.Start.usual(crane)
    parts = plant.parts(crane, start=start)
    assert axis_names(crane) == AXES[name]
    assert [*parts] == [*(f"{axis}_drive" for axis in AXES[name]), "winch_drive", "crane"]
    for axis, joint in zip(AXES[name], crane.joints, strict=True):
        if axis == "slew":
            continue
        rods = parts[f"{axis}_drive"].parts["cylinder"].component
        piston = rods.count * math.pi / 4 * rods.bore**2
        annulus = piston - rods.count * math.pi / 4 * rods.rod**2
        force = rods.pressure_a * piston - rods.pressure_b * annulus
        beside = any(link.joint.origin[1] for link in crane.links)  # a telescope beside the plane of the chart
        assert force == pytest.approx(rod_force(crane, start, joint.name), rel=5e-3 if beside else 1e-9)
        assert min(rods.pressure_a, rods.pressure_b) == 0.0
        assert 0 <= rods.extension <= rods.stroke
        assert max(rods.pressure_a, rods.pressure_b) < plant.Hydraulics.of(crane).supply


@pytest.mark.parametrize("name", AXES)
def test_a_crane_starts_away_from_its_ends_with_a_load_that_it_bears(name: str) -> None:
    crane = design.load(name)
    start = plant.Start.usual(crane)
    assert len(start.joints(crane)) == len(crane.joints)
    posture = {joint.name: start.posture[joint.name] for joint in planar.plane_joints(crane)}
    for joint in planar.plane_joints(crane):
        low, high = joint.limits
        assert low + 0.1 * (high - low) < posture[joint.name] < high - 0.1 * (high - low)
    assert 0 < start.load <= 0.8 * min(chart.each_limit(crane, posture).values())
    assert 2.0 <= start.hanging <= 14.0
    assert crane.pedestal[2] + geometry.tip(crane, posture)[2] > start.hanging


def test_the_drives_of_the_reference_crane_are_those_of_its_class() -> None:
    reference, gangway = (plant.Hydraulics.of(design.load(name)) for name in ("offshore-100t", "gangway-24m"))
    assert reference.slew.per_radian == pytest.approx(plant.Hydraulics().slew.per_radian)
    assert reference.winch.per_radian == pytest.approx(plant.Hydraulics().winch.per_radian)
    assert gangway.supply == 230 * bar
    assert gangway.winch.per_radian * gangway.supply == pytest.approx(20e3 * 0.15, rel=0.05)


def refused(crane: Crane) -> str:
    with pytest.raises(StructureError) as error:
        plant.build(crane)
    return str(error.value)


def test_joints_that_cannot_be_driven_are_refused_by_name_all_at_once() -> None:
    crane = design.load("gunnerus-pk65")
    boom, jib = crane.cylinders
    loose = msgspec.structs.replace(crane, cylinders=(jib,))
    assert "gunnerus-pk65: joint luff: turns and nothing moves it; allowed: a cylinder." in refused(loose)
    twice = msgspec.structs.replace(crane, cylinders=(boom, jib, msgspec.structs.replace(boom, name="second")))
    assert "joint luff: has more than one drive (got '2 cylinder sets'); allowed: one cylinder set, or" in refused(
        twice
    )
    both = msgspec.structs.replace(
        crane,
        cylinders=(
            msgspec.structs.replace(boom, name="telescope_cylinder"),
            msgspec.structs.replace(jib, name="winch"),
        ),
    )
    problems = refused(both)
    assert "axis telescope: is the name of two drives" in problems
    assert "axis winch: is the name of two drives" in problems


def test_a_cylinder_that_passes_its_dead_point_is_refused() -> None:
    crane = design.load("offshore-100t")
    boom = msgspec.structs.replace(crane.cylinders[0], eye=design.Attachment(link="boom", x=0.3, z=-2.0))
    told = refused(msgspec.structs.replace(crane, cylinders=(boom, crane.cylinders[1])))
    assert "cylinder boom_cylinder: passes a dead point within the limits of luff" in told


def test_a_posture_beyond_the_limits_is_told_in_the_unit_of_its_joint() -> None:
    crane = design.load("gangway-24m")
    with pytest.raises(ParameterError) as error:
        plant.parts(crane, start=plant.Start({"luff": 1.0, "telescope": 11.0, "jib": 0.0}))
    told = str(error.value)
    assert "posture.luff: 57.3 deg is beyond its limits; allowed: -15 deg to 35 deg" in told
    assert "posture.telescope: 11 m is beyond its limits; allowed: 0 m to 10 m" in told
    assert "posture.jib: is not a joint of the crane" in told
