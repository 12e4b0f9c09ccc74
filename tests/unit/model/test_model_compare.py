"""One call compares models and solvers on any signal."""

import json

import numpy as np
import pytest
from parts import Lag

from seacrane.errors import ParameterError
from seacrane.model import Diagram, ExplicitEuler, ImplicitEuler, RungeKutta4, compare, simulate


def lag(rate=2.0):
    diagram = Diagram("following")
    part = diagram.add("lag", Lag(rate=rate))
    diagram.expose(u=part.u, y=part.y)
    return diagram


def test_the_error_of_each_solver_is_against_a_tight_solution():
    solvers = (ImplicitEuler(0.1), ImplicitEuler(0.05), "rk4", "rodas4")
    found = compare(lag(), 3.0, "y", solvers=solvers, every=0.1, inputs={"u": 1.0})
    exact = 1 - np.exp(-2 * found.reference.time)
    assert found.reference["y"] == pytest.approx(exact, abs=1e-9)
    coarse, fine, rk4, rodas = (r.rmse for r in found.rows)
    assert coarse == pytest.approx(
        np.sqrt(np.mean((found.runs["following", "implicit Euler, 0.1 s"]["y"] - exact) ** 2))
    )
    assert coarse / fine == pytest.approx(2.0, rel=0.15)
    assert max(rk4, rodas) < 1e-5
    assert all(r.real_time_factor > 0 and r.unit == "m" for r in found.rows)


def test_the_reference_may_be_another_signal_or_a_recording():
    own = compare(lag(), 3.0, "y", reference="u", inputs={"u": 1.0}, every=0.1)
    t = own.reference.time
    assert own.rows[0].rmse == pytest.approx(np.sqrt(np.mean(np.exp(-4 * t))), rel=1e-4)
    other = simulate(lag(4.0), 3.0, inputs={"u": 1.0}, every=0.1)
    recorded = compare(lag(), 3.0, "y", reference=other, inputs={"u": 1.0}, every=0.1)
    assert recorded.rows[0].rmse == pytest.approx(np.sqrt(np.mean((np.exp(-2 * t) - np.exp(-4 * t)) ** 2)), rel=1e-4)


def test_the_last_of_several_models_is_the_reference():
    found = compare({"slow": lag(2.0), "fast": lag(4.0)}, 1.0, "y", inputs={"u": 1.0})
    assert [r.model for r in found.rows] == ["slow", "fast"]
    assert found.rows[1].rmse < 1e-5 < 0.1 < found.rows[0].rmse


def test_a_solver_that_diverges_has_its_row_with_what_happened():
    found = compare(lag(), 4000.0, "y", solvers=(ExplicitEuler(2.0), "rodas4"), every=2.0, inputs={"u": 1.0})
    assert "not finite" in found.rows[0].failure
    assert not found.rows[1].failure
    assert "not finite" in str(found)


def test_the_table_is_readable_and_its_data_are_json():
    found = compare(lag(), 1.0, "y", solvers=("rodas4", RungeKutta4(1e-3)), inputs={"u": 1.0})
    lines = str(found).splitlines()
    assert lines[1].split()[:3] == ["model", "solver", "RTF"]
    assert [line.split()[0] for line in lines[2:]] == ["following", "following"]
    assert json.loads(json.dumps(found.data()))[1]["solver"] == "Runge-Kutta 4, 0.001 s"


def test_the_plot_shows_every_run_over_the_reference():
    found = compare(lag(), 1.0, "y", solvers=("rodas4", "rk4"), inputs={"u": 1.0})
    above, below = found.plot(unit="mm").axes
    assert len(above.lines) == 3
    assert len(below.lines) == 2
    assert above.get_ylabel() == "y [mm]"
    assert above.lines[0].get_ydata()[-1] == pytest.approx(1000 * (1 - np.exp(-2.0)), rel=1e-4)


def test_unknown_signals_and_empty_comparisons_are_refused():
    with pytest.raises(ParameterError, match="yy"):
        compare(lag(), 1.0, "yy")
    with pytest.raises(ParameterError, match="at least one"):
        compare(lag(), 1.0, "y", solvers=())
    with pytest.raises(ParameterError, match="twice"):
        compare(lag(), 1.0, "y", solvers=("rodas4", "rodas4"))
