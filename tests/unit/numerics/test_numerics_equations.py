"""Systems of equations are solved from poor starts, and blocks are torn at few unknowns."""

import numpy as np
import pytest

from seacrane.numerics.equations import solve_equations
from seacrane.numerics.graph import tear


def cubic(z):
    return np.array([-(z[0] ** 3 - 8.0)]), np.array([[-3 * z[0] ** 2]])


@pytest.mark.parametrize("start", [1e-3, 0.1, 50.0, 1e6])
def test_a_root_is_found_from_far_and_from_flat_ground(start):
    root = solve_equations(cubic, np.array([start]), np.array([1.0]))
    assert root == pytest.approx([2.0], rel=1e-9)


def test_a_pressure_between_two_orifices_is_found_from_zero():
    def balance(p):
        drops = np.array([200e5 - p[0], p[0] - 50e5])
        flow = drops / np.sqrt(np.sqrt(drops**2 + 4e8))
        slope = (drops**2 / 2 + 4e8) / (drops**2 + 4e8) ** 1.25
        return np.array([flow[0] - flow[1]]), np.array([[-slope.sum()]])

    assert solve_equations(balance, np.zeros(1), np.array([1e7])) == pytest.approx([125e5], rel=1e-9)


def test_equations_without_a_root_or_without_a_value_give_none():
    assert solve_equations(lambda z: (z**2 + 1.0, np.diag(2 * z)), np.array([3.0]), np.ones(1)) is None
    assert solve_equations(lambda z: (z * np.nan, np.eye(1)), np.array([3.0]), np.ones(1)) is None


def test_where_nothing_depends_on_the_unknown_is_no_root():
    assert solve_equations(lambda z: (np.ones(1), np.zeros((1, 1))), np.zeros(1), np.ones(1)) is None


def test_a_chain_closed_to_a_ring_is_torn_once():
    n = 7
    rows = [[i, (i + 1) % n] for i in range(n)]
    torn = tear(rows, rows, range(n))
    assert len(torn.tears) == len(torn.residuals) == 1
    known = set(torn.tears)
    for row, column in torn.order:
        assert set(rows[row]) - {column} <= known
        known.add(column)
    assert known == set(range(n))


def test_what_no_equation_can_be_solved_for_is_torn():
    rows = [[0, 1], [0, 1, 2], [1, 2]]
    solvable = [[1], [2], [2]]
    torn = tear(rows, solvable, range(3))
    assert torn.tears == [0]
    assert torn.order == [(0, 1), (1, 2)] or torn.order == [(0, 1), (2, 2)]
