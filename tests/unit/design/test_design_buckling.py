"""Buckling of cylinders, against Euler's formula and against a column cut into many pieces."""

from __future__ import annotations

import math

import numpy as np
import pytest

from seacrane import design
from seacrane.design import buckling, geometry


def test_a_column_of_one_section_has_the_load_of_euler() -> None:
    inertia, length = 4e-4, 9.0
    euler = math.pi**2 * buckling.ELASTICITY * inertia / length**2
    assert buckling.stepped(inertia, 4.0, inertia, 5.0) == pytest.approx(euler)
    assert buckling.stepped(inertia, length, 10 * inertia, 0.0) == pytest.approx(euler)


@pytest.mark.parametrize(("barrel", "rod"), [(1.5e-3, 4e-4), (5e-3, 1e-4), (2e-4, 9e-4), (1e-2, 1e-6)])
def test_a_stepped_column_has_the_load_at_which_one_of_many_pieces_bends_out(barrel: float, rod: float) -> None:
    first, second, pieces = 5.0, 4.4, 470
    h = (first + second) / pieces
    x = np.arange(1, pieces) * h
    stiffness = buckling.ELASTICITY * np.where(x < first, barrel, rod)
    stiffness[np.isclose(x, first)] = 2 * buckling.ELASTICITY / (1 / barrel + 1 / rod)
    # EI y" + P y = 0 at the inner points, held at both ends
    bent = (np.diag(np.full(pieces - 1, 2.0)) - np.eye(pieces - 1, k=1) - np.eye(pieces - 1, k=-1)) / h**2
    flexible = np.linalg.inv(bent) / stiffness[None, :]
    y = np.sin(np.pi * x / (first + second))
    for _ in range(60):
        y = flexible @ y
        y /= np.abs(y).max()
    least = 1 / float((flexible @ y)[np.abs(y).argmax()] / y[np.abs(y).argmax()])
    assert buckling.stepped(barrel, first, rod, second) == pytest.approx(least, rel=2e-3)


def test_a_cylinder_lies_between_its_rod_alone_and_its_barrel_alone() -> None:
    crane = design.load("offshore-100t")
    cylinder = crane.cylinder("boom_cylinder")
    longest = geometry.cylinder_range(crane, cylinder)[1]
    rod_alone = math.pi**2 * buckling.ELASTICITY * math.pi / 64 * cylinder.rod**4 / longest**2
    assert 1.3 * rod_alone < buckling.load(crane, cylinder) < 3.7 * rod_alone
    push = cylinder.pressure * math.pi / 4 * cylinder.bore**2
    assert buckling.safety(crane, cylinder) == pytest.approx(buckling.load(crane, cylinder) / push)
