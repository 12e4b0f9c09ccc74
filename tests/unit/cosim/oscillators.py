"""Two masses joined by a spring, cut at the spring's end: as two slaves, and as a whole with its exact solution.

Slave `one` is mass 1 on its wall spring and damper; it takes the force of the joining spring and gives its velocity.
Slave `two` is mass 2 on its wall spring, with the joining spring; it takes the velocity and gives the force.
"""

from functools import cache

import casadi as ca
import numpy as np
from scipy.linalg import expm

from seacrane.cosim import FunctionSlave, ModelSlave, Slave, System
from seacrane.model.dae import Dae, Variable

M1, K1, C1 = 2.0, 30.0, 0.4
M2, K2, KC = 1.5, 20.0, 12.0
X1 = 0.5
"""Mass 1 starts at this displacement [m]; all else is at rest, and the joining spring is stretched by it."""

ONE = np.array([[0, 1], [-K1 / M1, -C1 / M1]]), np.array([[0], [1 / M1]]), np.array([[0.0, 1.0], [1.0, 0.0]])
TWO = (
    np.array([[0, 0, 1], [0, 0, 1], [-KC / M2, -K2 / M2, 0]]),
    np.array([[-1.0], [0.0], [0.0]]),
    np.array([[KC, 0, 0]]),
)
START_ONE, START_TWO = [X1, 0.0], [-X1, 0.0, 0.0]


def linear(a: np.ndarray, b: np.ndarray, c: np.ndarray):
    """Exact step of x' = a x + b u, y = c x with the input held."""
    n, m = b.shape

    @cache
    def matrices(h: float) -> tuple[np.ndarray, np.ndarray]:
        whole = expm(np.block([[a, b], [np.zeros((m, n + m))]]) * h)
        return whole[:n, :n], whole[:n, n:]

    def step(t, h, x, u):
        transition, driven = matrices(h)
        following = transition @ x + driven @ u
        return following, c @ following

    return step


FORCE = Variable("force", "N", about="of the joining spring on mass 1")
VELOCITY, POSITION = Variable("velocity", "m/s"), Variable("position", "m")


def functions() -> tuple[Slave, Slave]:
    return (
        FunctionSlave(linear(*ONE), [FORCE], [VELOCITY, POSITION], START_ONE),
        FunctionSlave(linear(*TWO), [VELOCITY], [FORCE], START_TWO),
    )


def dae(name: str, matrices, start, inputs, outputs) -> Dae:
    a, b, c = matrices
    n = len(start)
    x, u = ca.SX.sym("x", n), ca.SX.sym("u", b.shape[1])
    states = tuple(Variable(f"x{i}", "1", start=value) for i, value in enumerate(start))
    none = ca.SX(0, 1)
    return Dae(
        name, states, (), tuple(inputs), (), tuple(outputs), (Variable("sum"),), ca.SX.sym("t"),
        x, none, u, none, ca.mtimes(ca.DM(a), x) + ca.mtimes(ca.DM(b), u), none, ca.mtimes(ca.DM(c), x),
        ca.densify(ca.sum1(x)),
    )  # fmt: skip


def models() -> tuple[Slave, Slave]:
    one = dae("one", ONE, START_ONE, [FORCE], [VELOCITY, POSITION])
    two = dae("two", TWO, START_TWO, [VELOCITY], [FORCE])
    return tuple(ModelSlave(d, {"solver.tolerance": 1e-10}) for d in (one, two))


def system(slaves: tuple[Slave, Slave]) -> System:
    one, two = slaves
    joined = System("oscillators")
    joined.add("two", two)
    joined.add("one", one)
    joined.bond("spring", effort=("two.force", "one.force"), flow=("one.velocity", "two.velocity"))
    return joined


def exact(times: np.ndarray) -> np.ndarray:
    """Position of mass 1 [m] of the whole, shape (times,)."""
    a = np.zeros((5, 5))
    a[:2, :2], a[2:, 2:] = ONE[0], TWO[0]
    a[:2, 2:] = ONE[1] @ TWO[2]
    a[2:, 1] = TWO[1][:, 0]
    return np.array([(expm(a * t) @ [*START_ONE, *START_TWO])[0] for t in times])
