"""The elimination that is chosen when a model is compiled, and what happens where it serves no longer."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from seacrane.model import Dae, build
from seacrane.model.dae import Variable
from seacrane.model.elimination import eliminate


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize(("states", "algebraics", "share"), [(1, 0, 1.0), (9, 0, 0.3), (6, 5, 0.3), (0, 7, 0.4)])
def test_the_system_of_a_step_is_solved(seed: int, states: int, algebraics: int, share: float) -> None:
    random = np.random.default_rng(seed)
    size, s = states + algebraics, 40.0
    jacobian = np.where(random.random((size, size)) < share, random.normal(size=(size, size)), 0.0)
    shuffled = states + random.permutation(algebraics)
    jacobian[np.arange(states, size), shuffled] = 3 + random.random(algebraics)  # the unknowns in another order
    columns, rows = np.nonzero(jacobian.T)
    e = eliminate(states, size, rows.tolist(), columns.tolist())
    factor = ca.Function("factor", [e.nonzeros, e.s], [e.factors])
    solve = ca.Function("solve", [e.factor, e.b], [e.x])
    b = random.normal(size=size)
    x = np.array(solve(factor(jacobian[rows, columns], s), b)).reshape(-1)
    matrix = s * np.diag(np.arange(size) < states) - jacobian
    np.testing.assert_allclose(matrix @ x, b, atol=1e-9)


def test_a_chain_is_eliminated_without_new_entries() -> None:
    size = 60
    rows = [i for i in range(size) for j in (i - 1, i, i + 1) if 0 <= j < size]
    columns = [j for i in range(size) for j in (i - 1, i, i + 1) if 0 <= j < size]
    assert eliminate(size, size, rows, columns).factors.numel() == len(rows)


@pytest.mark.parametrize(
    ("states", "size", "rows", "columns"),
    [
        pytest.param(1, 3, [0, 1, 2], [0, 1, 1], id="an unknown in no equation"),
        pytest.param(0, 1, [], [], id="no equation at all"),
        pytest.param(40, 40, [i % 40 for i in range(1600)], [i // 40 for i in range(1600)], id="too full"),
    ],
)
def test_there_are_no_factors_where_there_is_no_good_elimination(
    states: int, size: int, rows: list[int], columns: list[int]
) -> None:
    assert eliminate(states, size, rows, columns).factors.numel() == 0


@pytest.mark.parametrize("mirrored", [False, True])
def test_a_pivot_that_vanishes_does_not_spoil_the_solution(mirrored: bool) -> None:
    t, x, z, p, none = ca.SX.sym("t"), ca.SX.sym("x"), ca.SX.sym("z", 2), ca.SX.sym("p"), ca.SX(0, 1)
    first, second = p * z[0] + z[1] - x, z[0] + p * z[1] - x
    dae = Dae(
        "coupled",
        states=(Variable("x", start=1.0),),
        algebraics=(Variable("z1"), Variable("z2")),
        inputs=(),
        parameters=(Variable("p"),),
        outputs=(),
        observables=(),
        t=t, x=x, z=z, u=none, p=p,
        ode=-z[0], alg=ca.vertcat(second, first) if mirrored else ca.vertcat(first, second), out=none, obs=none,
    )  # fmt: skip
    native = build(dae)
    for weak in (0.0, 1e-17, 1e-9):
        with native.instantiate() as instance:
            instance.set(["p", "solver.tolerance"], [weak, 1e-9])
            instance.initialize()
            instance.step(0.0, 1.0)
            assert instance.get("x") == pytest.approx(np.exp(-1 / (1 + weak)), rel=1e-8)
            assert instance.statistics.steps < 100
