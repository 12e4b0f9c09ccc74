"""Kinematics of the reference crane against the closed form of a knuckle boom crane and its published figures."""

import math
from itertools import product

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.design import geometry
from seacrane.units import deg

POSTURE = {"slew": 90 * deg, "luff": 50 * deg, "jib": -70 * deg}


@pytest.fixture(scope="module")
def crane():
    return design.load("offshore-100t")


@pytest.mark.parametrize(("slew", "luff", "jib"), list(product((0, 45, 90, 200), (0, 50, 78), (-115, -70, 0))))
def test_the_tip_of_a_knuckle_boom_crane_follows_its_closed_form(crane, slew, luff, jib):
    q1, q2, q3 = slew * deg, luff * deg, jib * deg
    reach = 18 * math.cos(q2) + 14 * math.cos(q2 + q3)
    height = 4 + 18 * math.sin(q2) + 14 * math.sin(q2 + q3)
    posture = {"slew": q1, "luff": q2, "jib": q3}
    np.testing.assert_allclose(
        geometry.tip(crane, posture), [reach * math.cos(q1), reach * math.sin(q1), height], atol=1e-12
    )
    assert geometry.radius(crane, posture) == pytest.approx(abs(reach))


def test_the_published_posture_has_the_published_radius_and_cylinder_lengths(crane):
    assert geometry.radius(crane, POSTURE) == pytest.approx(24.73, abs=0.005)
    lengths = [geometry.cylinder_length(crane, cylinder, POSTURE) for cylinder in crane.cylinders]
    assert lengths == pytest.approx([8.54, 7.14], abs=0.005)


def test_the_lever_arm_is_the_rate_of_the_cylinder_length(crane):
    for cylinder, arm in zip(crane.cylinders, (3.00, 2.19), strict=True):
        low, high = (
            geometry.cylinder_length(crane, cylinder, POSTURE | {cylinder.moves: POSTURE[cylinder.moves] + step})
            for step in (-1e-6, 1e-6)
        )
        assert (high - low) / 2e-6 == pytest.approx(arm, abs=0.005)


def test_the_travel_stays_inside_the_stroke(crane):
    for cylinder in crane.cylinders:
        shortest, longest = geometry.cylinder_range(crane, cylinder)
        retracted = geometry.retracted_length(crane, cylinder)
        assert retracted <= shortest < longest <= retracted + cylinder.stroke
    given = msgspec.structs.replace(crane.cylinders[0], retracted=5.37)
    assert geometry.retracted_length(crane, given) == 5.37


def test_a_cylinder_behind_its_joint_lowers_as_it_comes_out(crane):
    frame = design.load("a-frame-30t")
    assert [geometry.extends_upward(frame, cylinder) for cylinder in frame.cylinders] == [False, True]
    assert all(geometry.extends_upward(crane, cylinder) for cylinder in crane.cylinders)
    over = msgspec.structs.replace(crane.cylinders[0], eye=design.Attachment(link="boom", x=0.3, z=-2.0))
    assert geometry.extends_upward(crane, over) is None


def test_a_sliding_joint_moves_its_link_along_the_axis(crane):
    jib = crane.links[2]
    slide = msgspec.structs.replace(jib.joint, kind="prismatic", axis=(2.0, 0.0, 0.0), limits=(0.0, 3.0))
    telescope = msgspec.structs.replace(
        crane, links=(*crane.links[:2], msgspec.structs.replace(jib, joint=slide)), cylinders=crane.cylinders[:1]
    )
    assert design.check(telescope) == []
    assert geometry.radius(telescope, {"jib": 2.5}) == pytest.approx(18 + 14 + 2.5)
    raised = geometry.tip(telescope, {"luff": 90 * deg, "jib": 1.0})
    np.testing.assert_allclose(raised, [0, 0, 4 + 18 + 14 + 1], atol=1e-12)


def test_an_endless_joint_has_no_cylinder_range(crane):
    wrong = msgspec.structs.replace(crane.cylinders[0], moves="slew")
    with pytest.raises(ValueError, match="'slew' has no limits"):
        geometry.cylinder_range(crane, wrong)
