"""The extended cylinder drive against an independent solution: its laws written out anew and solved whole by scipy."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seacrane.model import Radau, simulate

EXAMPLES = Path(__file__).parents[2] / "examples" / "dissertation"


@pytest.fixture(scope="module")
def cylinder():
    sys.path.insert(0, str(EXAMPLES))
    try:
        yield importlib.import_module("cylinder")
    finally:
        sys.path.remove(str(EXAMPLES))


def root(dp, transition=1e4):
    return dp / (dp * dp + transition * transition) ** 0.25


def rounded(x, width=0.01):
    return 0.0 if x < -width else x if x > width else (x + width) ** 2 / (4 * width)


def equations(t, y):
    """dy/dt of spool and its speed, x, p_a, p_b, line pressures, v, integral and filtered error of the controller."""
    s, sv, x, pa, pb, la, lb, v, integral, filtered = y
    area = np.pi / 4 * 0.28**2
    ring = np.pi / 4 * (0.28**2 - 0.2**2)
    beta, mass, g, stroke, dead = 1e9, 20e3, 9.81, 1.4, 0.03
    # controller
    w = 2 * np.pi / 15.0
    wanted, speed = 0.7 + 0.4 * np.sin(w * t), 0.4 * w * np.cos(w * t)
    e = speed + 8.0 * (wanted - x) - v
    free = 1.0 * e + integral + 0.002 * (e - filtered) / 0.01
    u = min(max(free, -1.0), 1.0)
    command = np.interp(u + 4.5 * speed, [-1.0, -0.01, 0.01, 1.0], [-1.0, -0.06, 0.06, 1.0])
    # valve
    k = 400e-3 / 60 / root(35e5)
    p_a_open = min(rounded((s - 0.05) / 0.95), 1.0) + 1e-4
    p_b_open = min(rounded((-s - 0.05) / 0.95), 1.0) + 1e-4
    into_a = k * (p_a_open * root(210e5 - la) - p_b_open * root(la))
    into_b = k * (p_b_open * root(210e5 - lb) - p_a_open * root(lb))
    # cylinder; the piston stays away from its bumpers here
    port = 0.7 * np.pi / 4 * 0.032**2 * np.sqrt(2 / 870.0)
    qa, qb, leak = port * root(la - pa), port * root(lb - pb), 1e-14 * (pa - pb)
    friction = 6e4 * v + 3e3 * v / np.sqrt(v * v + 2e-3**2)
    return [
        sv,
        60.0**2 * (command - s) - 2 * 0.8 * 60.0 * sv,
        v,
        beta / (area * (dead + x)) * (qa - area * v - leak),
        beta / (ring * (dead + stroke - x)) * (qb + ring * v + leak),
        beta / 1e-3 * (into_a - qa),
        beta / 1e-3 * (into_b - qb),
        (area * pa - ring * pb - friction) / mass - g,
        5.0 * (e + (u - free) / 1.0),
        (e - filtered) / 0.01,
    ]


STATES = {
    "valve.spool_position": 1.0,
    "cylinder.extension": 1.0,
    "cylinder.pressure_a": 1e6,
    "cylinder.pressure_b": 1e6,
    "line_a.pressure": 1e6,
    "line_b.pressure": 1e6,
    "mass.speed": 0.1,
}
PLACES = [0, 2, 3, 4, 5, 6, 7]


def test_the_drive_is_the_monolithic_solution_to_a_millionth(cylinder):
    until, start = 4.0, 20e3 * 9.81 / (np.pi / 4 * 0.28**2)
    y0 = [0.0, 0.0, 0.7, start, 0.0, start, 0.0, 0.0, 0.0, 0.0]
    nominal = np.array([1.0, 10.0, 1.0, 1e6, 1e6, 1e6, 1e6, 1.0, 1.0, 1.0])
    times = np.linspace(0.0, until, 81)
    exact = solve_ivp(
        lambda t, y: np.array(equations(t, y * nominal)) / nominal,
        (0.0, until),
        np.array(y0) / nominal,
        method="Radau",
        rtol=1e-10,
        atol=1e-12,
        t_eval=times,
    )
    assert exact.success
    drive = cylinder.controlled()
    for solver in ("rodas4", Radau()):
        run = simulate(drive, until, every=0.05, record=list(STATES), solver=solver, tolerance=1e-10)
        for (name, size), place in zip(STATES.items(), PLACES, strict=True):
            independent = exact.y[place] * nominal[place]
            assert np.abs(run[name] - independent).max() < 1e-6 * max(size, np.abs(independent).max()), (solver, name)
