from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from mujoco_oracle import ChainOracle, Foot

from seacrane.design import Joint, Link
from seacrane.multibody.chain import (
    BaseMotion,
    forward_dynamics,
    frames,
    inverse_dynamics,
    kinetic_energy,
    mass_moment,
)

LUFF, SLEW, ALONG, SKEWED = (0, -1, 0), (0, 0, 1), (1, 0, 0), (0.48, -0.6, 0.64)


def link(name: str, kind: str, axis: tuple[float, ...], origin: tuple[float, ...], mass: float) -> Link:
    joint = Joint(name=f"q_{name}", kind=kind, axis=axis, origin=origin)
    return Link(name=name, joint=joint, mass=mass, com=(3.0, 0.2, 0.4), inertia=(mass * 2, mass * 20, mass * 21))


CHAINS = {
    "RP": [link("frame", "revolute", LUFF, (0, 0, 1), 3e4), link("telescope", "prismatic", ALONG, (6, 0, 0), 1e4)],
    "RRR": [
        link("column", "revolute", SLEW, (0, 0, 0), 1.1e5),
        link("boom", "revolute", LUFF, (-1, 0, 4), 4.8e4),
        link("jib", "revolute", LUFF, (18, 0.3, 0), 2.4e4),
    ],
    "RRP": [
        link("column", "revolute", SLEW, (0, 0, 0), 1.1e5),
        link("boom", "revolute", LUFF, (0, 0, 4), 4.8e4),
        link("telescope", "prismatic", ALONG, (4, 0, 0), 2.4e4),
    ],
    "RRRR": [
        link("column", "revolute", SLEW, (0, 0, 0), 1.1e5),
        link("boom", "revolute", LUFF, (0, 0, 4), 4.8e4),
        link("jib", "revolute", LUFF, (18, 0, 0), 2.4e4),
        link("outer", "revolute", LUFF, (14, 0, 0), 6e3),
    ],
    "skewed": [
        link("first", "revolute", SKEWED, (1, 2, 3), 2e4),
        link("second", "prismatic", (0.6, 0, 0.8), (2, 1, 1), 1e4),
        link("third", "revolute", (0, 3, 4), (1, 0, 0), 1e4),
    ],
}


@pytest.fixture(params=CHAINS)
def links(request: pytest.FixtureRequest) -> list[Link]:
    return CHAINS[request.param]


def numbers(value: ca.DM) -> np.ndarray:
    return value.full().ravel()


def dynamics(links: list[Link]) -> tuple[ca.Function, ca.Function]:
    n = len(links)
    q, qd, effort, rotor = (ca.SX.sym(name, n) for name in ("q", "qd", "effort", "rotor"))
    w, alpha, a = (ca.SX.sym(name, 3) for name in ("w", "alpha", "a"))
    base = BaseMotion(w, alpha, a)
    forward = ca.Function(
        "forward", [q, qd, effort, rotor, w, alpha, a], list(forward_dynamics(links, q, qd, effort, base, rotor))
    )
    inverse = ca.Function("inverse", [q, qd, effort, w, alpha, a], list(inverse_dynamics(links, q, qd, effort, base)))
    return forward, inverse


@pytest.mark.parametrize("moving", [False, True], ids=["fixed foot", "moving foot"])
def test_accelerations_and_foot_wrench_are_those_of_mujoco(links: list[Link], moving: bool) -> None:
    rng, oracle, (forward, _) = np.random.default_rng(1), ChainOracle(links), dynamics(links)
    n = len(links)
    for _ in range(200):
        foot = Foot.random(rng) if moving else Foot.at_rest()
        q, qd, effort = rng.uniform(-1.5, 1.5, n), rng.uniform(-0.5, 0.5, n), rng.uniform(-1e6, 1e6, n)
        rotor = np.where(np.arange(n) == 0, rng.uniform(0, 5e5), 0.0)
        qdd, wrench = oracle(foot, q, qd, effort, rotor)
        result = forward(q, qd, effort, rotor, foot.w, foot.alpha, foot.a - foot.gravity)
        assert numbers(result[0]) == pytest.approx(qdd, rel=1e-10, abs=1e-10 * np.abs(qdd).max())
        for part in (slice(3), slice(3, 6)):
            scale = np.abs(wrench[part]).max()
            assert numbers(result[1])[part] == pytest.approx(wrench[part], rel=1e-10, abs=1e-10 * scale)


def test_inverse_dynamics_undoes_forward_dynamics_and_feels_the_same_wrench(links: list[Link]) -> None:
    rng, (forward, inverse) = np.random.default_rng(2), dynamics(links)
    n = len(links)
    for _ in range(20):
        q, qd, effort = rng.uniform(-1.5, 1.5, n), rng.uniform(-0.5, 0.5, n), rng.uniform(-1e6, 1e6, n)
        foot = rng.uniform(-1, 1, (3, 3))
        qdd, wrench = forward(q, qd, effort, np.zeros(n), *foot)
        back, wrench_again = inverse(q, qd, qdd, *foot)
        assert numbers(back) == pytest.approx(effort, rel=1e-9, abs=1e-3)
        assert numbers(wrench_again) == pytest.approx(numbers(wrench), rel=1e-9, abs=1e-3)


def test_momentum_from_the_kinetic_energy_changes_as_the_foot_pushes(links: list[Link]) -> None:
    """Over a small step on a fixed foot the momentum about it gains wrench plus weight, integrated."""
    n = len(links)
    q, qd, twist = ca.SX.sym("q", n), ca.SX.sym("qd", n), ca.SX.sym("twist", 6)
    energy = kinetic_energy(links, q, qd, twist)
    momentum = ca.Function("h", [q, qd], [ca.substitute(ca.gradient(energy, twist), twist, ca.DM.zeros(6))])
    weight = ca.Function("weight", [q], [mass_moment(links, q)])
    forward, _ = dynamics(links)
    rng = np.random.default_rng(3)
    x, v, effort = rng.uniform(-1, 1, n), rng.uniform(-0.5, 0.5, n), rng.uniform(-1e6, 1e6, n)
    gravity = np.array([0, 0, -9.81])
    qdd, wrench = (numbers(part) for part in forward(x, v, effort, np.zeros(n), [0, 0, 0], [0, 0, 0], -gravity))
    h = 1e-5
    after, before = (numbers(momentum(x + s * h * v, v + s * h * qdd)) for s in (1, -1))
    mass = sum(link.mass for link in links)
    loads = np.concatenate([np.cross(numbers(weight(x)), gravity), mass * gravity])
    assert (after - before) / (2 * h) == pytest.approx(wrench + loads, rel=1e-6, abs=1e-6 * np.abs(wrench).max())


def test_a_rotor_is_a_heavier_joint(links: list[Link]) -> None:
    forward, _ = dynamics(links)
    n = len(links)
    free, held = (
        forward(np.ones(n), np.zeros(n), np.zeros(n), [j] * n, *np.zeros((2, 3)), [0, 0, 9.81]) for j in (0, 1e12)
    )
    assert np.abs(numbers(held[0])).max() < 1e-4 < np.abs(numbers(free[0])).max()


def test_an_axis_need_not_be_of_unit_length() -> None:
    long = [link("a", "revolute", (0, 0, 7), (0, 0, 0), 1e3), link("b", "prismatic", (5, 0, 0), (1, 0, 0), 1e3)]
    unit = [link("a", "revolute", (0, 0, 1), (0, 0, 0), 1e3), link("b", "prismatic", (1, 0, 0), (1, 0, 0), 1e3)]
    first, second = (frames(chain, [0.3, 2.0])["b"].origin for chain in (long, unit))
    assert numbers(first) == pytest.approx(numbers(second), rel=1e-14)
