from __future__ import annotations

import math

import numpy as np
import pytest

from seacrane import design
from seacrane.multibody import Kinematics

CRANE = design.load("offshore-100t")
L1, L2, L3 = 4.0, 18.0, 14.0
SLEWS = [0, 45, 90, 137, -60]


@pytest.fixture(scope="module")
def kinematics() -> Kinematics:
    return Kinematics(CRANE)


def postures(slew: float) -> list[np.ndarray]:
    rng = np.random.default_rng(5)
    return [
        np.radians([slew, luff, jib]) for luff, jib in zip(rng.uniform(-5, 78, 6), rng.uniform(-115, 0, 6), strict=True)
    ]


@pytest.mark.parametrize("slew", SLEWS)
def test_tip_and_axes_are_those_of_the_closed_form(kinematics: Kinematics, slew: float) -> None:
    """Denavit-Hartenberg axes of the source: x along the jib, z along the luffing axis, y thus our z."""
    for q in postures(slew):
        (c1, c2, c23), (s1, s2, s23) = (f([q[0], q[1], q[1] + q[2]]) for f in (np.cos, np.sin))
        reach = L2 * c2 + L3 * c23
        assert kinematics.tip(q) == pytest.approx([c1 * reach, s1 * reach, L1 + L2 * s2 + L3 * s23], abs=1e-12)
        assert kinematics.radius(q) == pytest.approx(abs(reach), rel=1e-12)
        expected = np.array([[c1 * c23, -c1 * s23, s1], [s1 * c23, -s1 * s23, -c1], [s23, c23, 0]])
        found = kinematics.axes(q)
        assert np.column_stack([found[:, 0], found[:, 2], -found[:, 1]]) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("slew", SLEWS)
def test_jacobian_and_its_determinant_are_those_of_the_closed_form(kinematics: Kinematics, slew: float) -> None:
    for q in postures(slew):
        (c1, c2, c23), (s1, s2, s23) = (f([q[0], q[1], q[1] + q[2]]) for f in (np.cos, np.sin))
        reach, height = L2 * c2 + L3 * c23, L2 * s2 + L3 * s23
        expected = [
            [-s1 * reach, -c1 * height, -L3 * c1 * s23],
            [c1 * reach, -s1 * height, -L3 * s1 * s23],
            [0, reach, L3 * c23],
        ]
        found = kinematics.jacobian(q)
        assert found == pytest.approx(np.array(expected), abs=1e-11)
        assert abs(np.linalg.det(found)) == pytest.approx(L2 * L3 * abs(math.sin(q[2]) * reach), rel=1e-9)


def test_a_straight_jib_is_singular(kinematics: Kinematics) -> None:
    assert abs(np.linalg.det(kinematics.jacobian(np.radians([30, 40, 0])))) < 1e-9


def test_an_arm_is_the_change_of_length_with_its_joint(kinematics: Kinematics) -> None:
    q, h = np.radians([20, 45, -60]), 1e-6
    for joint in range(3):
        step = h * np.eye(3)[joint]
        slope = (kinematics.cylinder_lengths(q + step) - kinematics.cylinder_lengths(q - step)) / (2 * h)
        assert kinematics.cylinder_arms(q)[:, joint] == pytest.approx(slope, abs=1e-8)


def test_lengths_are_those_of_the_design_geometry(kinematics: Kinematics) -> None:
    q = np.radians([20, 45, -60])
    posture = dict(zip(("slew", "luff", "jib"), q.tolist(), strict=True))
    expected = [design.geometry.cylinder_length(CRANE, c, posture) for c in CRANE.cylinders]
    assert kinematics.cylinder_lengths(q) == pytest.approx(expected, rel=1e-12)
    assert kinematics.tip(q) == pytest.approx(design.geometry.tip(CRANE, posture), rel=1e-12)
