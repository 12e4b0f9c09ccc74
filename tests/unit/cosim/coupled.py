"""A weight on a spring, cut between the two: FMUs that start at rest and give nothing at the start.

`spring` takes a velocity and gives a force; `mass` takes a force and gives a velocity. Both start with zeros, so that a
master that exchanges no values before the first step gets the same results. `mixer` passes three inputs on at once.
"""

from functools import cache
from pathlib import Path

import casadi as ca

from seacrane import fmi
from seacrane.model.dae import Dae, Variable

STIFFNESS, MASS, WEIGHT = 40.0, 2.0, 10.0
NONE = ca.SX(0, 1)


def spring() -> Dae:
    x, v, k = ca.SX.sym("x"), ca.SX.sym("v"), ca.SX.sym("k")
    return Dae(
        "spring", (Variable("stretch", "m"),), (), (Variable("velocity", "m/s"),),
        (Variable("stiffness", "N/m", STIFFNESS),), (Variable("force", "N"),), (), ca.SX.sym("t"),
        x, NONE, v, k, v, NONE, -k * x, NONE,
    )  # fmt: skip


def mass() -> Dae:
    x, u, p = ca.SX.sym("x"), ca.SX.sym("u", 2), ca.SX.sym("p", 2)
    return Dae(
        "mass", (Variable("v", "m/s"),), (), (Variable("force", "N"), Variable("pull", "kN")),
        (Variable("mass", "kg", MASS, minimum=0.1), Variable("weight", "N", WEIGHT)), (Variable("velocity", "m/s"),),
        (), ca.SX.sym("t"), x, NONE, u, p, (u[0] + 1e3 * u[1] + p[1]) / p[0], NONE, x, NONE,
    )  # fmt: skip


def mixer() -> Dae:
    x, u = ca.SX.sym("x"), ca.SX.sym("u", 3)
    inputs = Variable("force", "N"), Variable("speed", "m/s"), Variable("plain")
    outputs = Variable("force_out", "kN"), Variable("speed_out", "m/s"), Variable("plain_out")
    return Dae(
        "mixer", (Variable("x"),), (), inputs, (), outputs, (), ca.SX.sym("t"),
        x, NONE, u, NONE, ca.SX(1, 1), NONE, ca.vertcat(1e-3 * u[0], u[1], u[2]), NONE,
    )  # fmt: skip


@cache
def exported(folder: Path) -> Path:
    """The folder, with an FMU of each; those of FMI 3.0 end on `3`."""
    for model in (spring(), mass(), mixer()):
        fmi.export(model, folder / f"{model.name}.fmu")
        fmi.export(model, folder / f"{model.name}3.fmu", version="3.0")
    return folder
