"""Table 4.4 in a short form: the orders that must hold, and the targets."""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from seacrane.model import simulate

EXAMPLES = Path(__file__).parents[2] / "examples" / "dissertation"


@pytest.fixture(scope="module")
def cylinder():
    sys.path.insert(0, str(EXAMPLES))
    try:
        yield importlib.import_module("cylinder")
    finally:
        sys.path.remove(str(EXAMPLES))


@pytest.fixture(scope="module")
def table(cylinder, tmp_path_factory):
    folder = tmp_path_factory.mktemp("table")
    importlib.import_module("table_4_4").main(
        ["--until", "5", "--json", str(folder / "t.json"), "--out", str(folder / "figures")]
    )
    assert {f.suffix for f in (folder / "figures").iterdir()} == {".svg", ".csv"}
    return json.loads((folder / "t.json").read_text())


def row(table, solver, level):
    (found,) = [r for r in table["rows"] if r["solver"] == solver and r["level"] == level]
    return found


def test_the_table_has_the_printed_rows_and_ours(table):
    found = {(r["solver"], r["level"]) for r in table["rows"]}
    solvers = ("Runge-Kutta 4", "explicit Euler", "Adams (SUNDIALS)", "BDF (SUNDIALS)", "RODAS4")
    assert found == {(s, level) for s in solvers for level in ("simplified", "extended")}
    assert all({"solver", "level", "rtf", "rmse_m"} <= set(r) for r in table["rows"])
    assert table["machine"]["cpu"]
    assert "other hardware" in table["printed"]


@pytest.mark.parametrize("solver", ["Runge-Kutta 4", "Adams (SUNDIALS)"])
def test_the_extended_level_costs_more_than_the_simplified_one(table, solver):
    assert row(table, solver, "extended")["rtf"] > row(table, solver, "simplified")["rtf"]


def test_an_implicit_variable_step_is_fifty_times_below_the_printed_cost(table):
    assert row(table, "RODAS4", "extended")["rtf"] < 0.067 / 50


def test_the_piston_follows_at_least_as_closely_as_printed(table):
    for level in ("simplified", "extended"):
        for solver in ("Runge-Kutta 4", "Adams (SUNDIALS)", "BDF (SUNDIALS)", "RODAS4"):
            assert row(table, solver, level)["rmse_m"] <= 3.8e-3


def test_explicit_methods_diverge_at_a_step_that_resolves_no_longer_the_oil(table):
    limits = table["limits_s"]
    assert limits["extended"]["explicit Euler"] < limits["extended"]["Runge-Kutta 4"] < 2e-4
    assert limits["simplified"]["Runge-Kutta 4"] > 5 * limits["extended"]["Runge-Kutta 4"]


def test_all_solvers_come_to_one_solution_as_tolerances_tighten(table):
    for errors in table["convergence_m"].values():
        values = list(errors.values())
        assert values[-1] < max(values[0] / 5, 1e-12)
        assert values[-1] < 1e-9


def test_the_two_levels_agree_in_the_limit_of_stiff_oil_and_open_ports(cylinder):
    ideal = {f"cylinder.{n}": 0.0 for n in ("viscous_friction", "coulomb_friction", "leakage")}

    def apart(bulk_modulus, port):
        runs = [
            simulate(
                cylinder.controlled(level, bulk_modulus=bulk_modulus),
                5.0,
                record=["cylinder.extension"],
                parameters={**ideal, "cylinder.port_diameter": port} if level == "extended" else None,
            )
            for level in ("extended", "simplified")
        ]
        return runs[0].rmse(runs[1], "cylinder.extension")

    apart_in_kind, closer, closest = apart(1e9, 0.032), apart(1e10, 0.064), apart(1e11, 0.128)
    assert closest < closer / 3 < apart_in_kind / 9
    assert closest < 2e-5


def test_the_scripts_share_one_drive(cylinder):
    assert importlib.import_module("manual_manipulation").Drive is cylinder.Drive
    assert np.isclose(cylinder.Drive().bumper_stiffness, (210e5 * np.pi / 4 * 0.28**2 - 20e3 * 9.81) / 0.01)
