"""The C core finds algebraic unknowns from poor start values."""

import casadi as ca
import pytest

from seacrane.errors import SolveError
from seacrane.model.dae import Dae, Variable, column
from seacrane.model.native import build


def one_equation(name, g, z, start, nominal=1.0):
    """A model of nothing but 0 = g(z)."""
    none, n = ca.SX(0, 1), z.numel()
    return Dae(
        name, (), tuple(Variable(f"z{i}", start=start, nominal=nominal) for i in range(n)), (), (), (), (),
        ca.SX.sym("t"), none, z, none, none, none, column(g), none, none,
    )  # fmt: skip


def solved(dae):
    with build(dae).instantiate() as run:
        run.initialize(0.0)
        return run.get([v.name for v in dae.algebraics])


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_root_is_found_from_where_the_slope_is_next_to_nothing(sign):
    z = ca.SX.sym("z")
    assert solved(one_equation("flat", sign * (z**3 - 8.0), z, start=1e-3)) == pytest.approx([2.0])


def test_a_network_whose_slopes_vanish_at_the_start_is_solved_whatever_the_signs():
    z = ca.SX.sym("z", 2)
    g = ca.vertcat(z[0] ** 3 + z[0] * 1e-9 - (9.0 - z[1]), -(z[1] ** 3 + z[1] - 2.0 * z[0] + 3.0))
    a, b = solved(one_equation("network", g, z, start=0.0))
    assert a**3 == pytest.approx(9.0 - b, rel=1e-6)
    assert b**3 + b == pytest.approx(2.0 * a - 3.0, rel=1e-6)


def test_equations_without_a_root_are_told_with_the_unknown():
    z = ca.SX.sym("z")
    with pytest.raises(SolveError, match=r"algebraic equations .* z0"):
        solved(one_equation("none", z**2 + 1.0, z, start=3.0))
