"""The closed forms of the knuckle boom crane agree with the design's chain at every slew, and lose rank where told."""

from itertools import product

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.control import KnuckleBoom
from seacrane.design import geometry
from seacrane.errors import DesignError
from seacrane.units import deg

POSTURES = [
    (slew * deg, luff * deg, jib * deg)
    for slew, luff, jib in product((-30, 0, 45, 90, 200), (0, 50, 78), (-115, -70, 0))
]


@pytest.fixture(scope="module")
def crane():
    return design.load("offshore-100t")


@pytest.fixture(scope="module")
def boom(crane):
    return KnuckleBoom.of(crane)


def test_the_lengths_are_those_of_the_design(boom):
    assert (boom.heel, boom.boom, boom.jib) == (4.0, 18.0, 14.0)


@pytest.mark.parametrize("q", POSTURES)
def test_tip_and_rotation_agree_with_the_chain_of_the_design(crane, boom, q):
    posture = dict(zip(("slew", "luff", "jib"), q, strict=True))
    np.testing.assert_allclose(boom.tip(*q), geometry.tip(crane, posture), atol=1e-12)
    x, y, z = geometry.frames(crane, posture)["jib"].rotation.T
    np.testing.assert_allclose(boom.rotation(*q), np.column_stack((x, z, -y)), atol=1e-12)


@pytest.mark.parametrize("q", POSTURES)
def test_the_jacobian_is_the_derivative_of_the_tip(boom, q):
    h = 1e-5
    columns = [(boom.tip(*(np.array(q) + d)) - boom.tip(*(np.array(q) - d))) / (2 * h) for d in h * np.eye(3)]
    np.testing.assert_allclose(boom.jacobian(*q), np.column_stack(columns), atol=1e-8)
    assert boom.determinant(*q[1:]) == pytest.approx(abs(np.linalg.det(boom.jacobian(*q))), abs=1e-9)


def test_a_straight_jib_and_a_tip_over_the_axis_lose_a_direction(boom):
    assert boom.determinant(50 * deg, 0.0) == 0.0
    # 18 cos(luff) + 14 cos(luff + jib) = 0
    luff = 78 * deg
    jib = np.arccos(-18 * np.cos(luff) / 14) - luff
    assert boom.determinant(luff, jib) == pytest.approx(0.0, abs=1e-9)
    assert np.linalg.matrix_rank(boom.jacobian(0.3, luff, jib), tol=1e-9) == 2


def test_another_kind_of_crane_has_no_closed_form(crane):
    jib = crane.links[2]
    slide = msgspec.structs.replace(jib.joint, kind="prismatic", axis=(1.0, 0.0, 0.0))
    telescope = msgspec.structs.replace(crane, links=(*crane.links[:2], msgspec.structs.replace(jib, joint=slide)))
    with pytest.raises(DesignError, match="is no knuckle boom crane"):
        KnuckleBoom.of(telescope)
