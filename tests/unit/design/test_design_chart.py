"""The load chart against statics done another way, published loads and closed forms."""

from __future__ import annotations

import itertools
import math

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.design import Crane, chart, geometry, planar
from seacrane.errors import DesignError
from seacrane.multibody import static_equilibrium
from seacrane.units import GRAVITY, bar, deg

OFFSHORE = design.load("offshore-100t")
HS2 = chart.mode(OFFSHORE, "hs2.0")


def postures(crane: Crane, count: int = 40, seed: int = 3) -> dict[str, np.ndarray]:
    random = np.random.default_rng(seed)
    return {joint.name: random.uniform(*joint.limits, count) for joint in planar.plane_joints(crane)}


def alone(crane: Crane, **rating: object) -> Crane:
    """The crane with no limits but its cylinders, and those of `rating`."""
    hoist = msgspec.structs.replace(
        crane.hoist, line_pull=None, rope=msgspec.structs.replace(crane.hoist.rope, breaking_load=None)
    )
    return msgspec.structs.replace(crane, hoist=hoist, rating=design.Rating(**rating))


@pytest.mark.parametrize("name", ["offshore-100t", "gunnerus-pk65", "dual-drag-link-60t", "a-frame-30t"])
def test_at_the_capacity_of_the_cylinders_the_equilibrium_holds_one_cylinder_at_its_limit(name: str) -> None:
    crane = alone(design.load(name))
    at = postures(crane, 12)
    found = chart.capacity(crane, at)
    for i in np.flatnonzero((found.swl > 0) & (found.swl < 1e6)):
        posture = [float(at[joint.name][i]) if joint.name in at else 0.0 for joint in crane.joints]
        held = static_equilibrium(crane, posture, float(found.swl[i]) + crane.hoist.hook_mass, hanging=1e6)
        used = []
        for cylinder in crane.cylinders:
            push, pull = chart.forces(cylinder)
            force = held.cylinder_forces[cylinder.name]
            used.append(force / push if force > 0 else -force / pull)
        assert max(used) == pytest.approx(1.0, abs=2e-5)
        assert crane.cylinders[int(np.argmax(used))].name == found.limits[found.governs[i]]


def test_forty_tonnes_stand_on_the_pressures_of_the_reference() -> None:
    crane = alone(OFFSHORE)
    for name, pressure in (("boom_cylinder", 191.0 * bar), ("jib_cylinder", 115.5 * bar)):
        weak = [msgspec.structs.replace(c, pressure=pressure if c.name == name else 1e9) for c in crane.cylinders]
        found = chart.each_limit(
            msgspec.structs.replace(crane, cylinders=tuple(weak)), {"luff": 50 * deg, "jib": -70 * deg}
        )
        assert found[name] == pytest.approx(40e3, rel=2e-3)


def test_the_published_loads_of_the_gunnerus_crane() -> None:
    near, far = chart.curve(design.load("gunnerus-pk65"), radii=[4.0, 20.3])
    assert near.swl == pytest.approx(15.1e3, rel=0.05)
    assert far.swl == pytest.approx(2.1e3, rel=0.05)


@pytest.mark.parametrize("name", design.names())
def test_a_shipped_crane_lifts_its_rated_loads_and_no_more_than_half_as_much_again(name: str) -> None:
    crane = design.load(name)
    for rated in crane.capacity:
        (row,) = chart.curve(crane, radii=[rated.radius])
        assert row.swl == pytest.approx(rated.mass, rel=5e-3) or row.swl > rated.mass
    assert max(row.swl for row in chart.curve(crane)) < 1.5 * max(rated.mass for rated in crane.capacity)


def test_a_curve_finds_what_a_hundred_times_as_many_postures_find() -> None:
    """Three joints, so that a radius has postures without end; the load hangs on few of them."""
    crane = design.load("dual-drag-link-60t")
    fine = {row.radius: row.swl for row in chart.curve(crane, count=80)}
    found = chart.curve(crane)
    assert [row.radius for row in found] == [*range(6, 33), 32.9]
    for row in found:
        assert row.swl == pytest.approx(fine[row.radius], rel=0.02)
        most = min(chart.each_limit(crane, row.posture).values())
        assert row.swl == pytest.approx(most, rel=0.13 / row.radius + 1e-9)


def test_radii_close_to_each_other_are_charted_alike() -> None:
    near = chart.curve(OFFSHORE, radii=[14.99, 15.0, 15.001, 27.3, 27.31])
    whole = {row.radius: row.swl for row in chart.curve(OFFSHORE)}
    assert [row.radius for row in near] == [14.99, 15.0, 15.001, 27.3, 27.31]
    assert near[0].swl == pytest.approx(near[2].swl, rel=2e-3)
    assert near[1].swl == whole[15.0]
    assert near[3].swl == pytest.approx(near[4].swl, rel=2e-3)
    for row in near:
        assert geometry.radius(OFFSHORE, row.posture) == pytest.approx(row.radius, abs=0.13)
        assert row.swl <= min(chart.each_limit(OFFSHORE, row.posture).values()) * (1 + 1e-9)


def test_a_posture_without_a_joint_is_refused() -> None:
    with pytest.raises(DesignError, match=r"posture: lacks a joint \(got 'jib'\); allowed: luff, jib"):
        chart.each_limit(OFFSHORE, {"luff": 1.0})


def test_a_chain_of_as_many_links_as_there_may_be_is_charted_within_a_few_postures() -> None:
    """Eleven joints in the plane, which no grid of all of them together could fill; the last carries little alone."""
    column, boom, _ = OFFSHORE.links
    short = msgspec.structs.replace(boom, mass=4e3, com=(1.5, 0.0, 0.0), inertia=(4e2, 4e3, 4e3))
    links = [column]
    for i in range(11):
        origin = (3.0, 0.0, 4.0 if i == 0 else 0.0)
        joint = msgspec.structs.replace(boom.joint, name=f"joint {i}", origin=origin, limits=(-0.5, 0.8))
        links.append(msgspec.structs.replace(short, name=f"link {i}", joint=joint))
    tip = design.Attachment(link="link 10", x=3.0, z=0.0)
    hoist = msgspec.structs.replace(OFFSHORE.hoist, sheaves=(tip,))
    crane = msgspec.structs.replace(OFFSHORE, links=tuple(links), cylinders=(), hoist=hoist)
    assert design.check(crane) == []
    rows = chart.curve(crane)
    assert rows[-1].radius > 30
    for row in rows:
        assert geometry.radius(crane, row.posture) == pytest.approx(row.radius, abs=0.13)
        assert row.swl <= min(chart.each_limit(crane, row.posture).values()) * (1 + 1e-9)
    assert design.workspace.section(crane, 40).area > 100


def test_levers_are_the_derivatives_of_the_points_and_lengths() -> None:
    crane, h = design.load("dual-drag-link-60t"), 1e-6
    at = postures(crane)
    plane = planar.Plane(crane, at)
    for joint in at:
        ahead = planar.Plane(crane, {**at, joint: at[joint] + h})
        behind = planar.Plane(crane, {**at, joint: at[joint] - h})
        for exact, upper, lower in zip(plane.by_joint(joint, plane.tip()), ahead.tip(), behind.tip(), strict=True):
            np.testing.assert_allclose(exact, (upper - lower) / (2 * h), atol=1e-7)
        slope = (ahead.rope_length() - behind.rope_length()) / (2 * h)
        np.testing.assert_allclose(plane.rope_by_joint(joint), slope, atol=1e-7)
        for c in crane.cylinders:
            slope = (ahead.distance(c.base, c.eye) - behind.distance(c.base, c.eye)) / (2 * h)
            np.testing.assert_allclose(plane.distance_by_joint(joint, c.base, c.eye), slope, atol=1e-7)


@pytest.mark.parametrize("name", design.names())
def test_the_plane_of_a_crane_is_where_its_geometry_is_without_slewing(name: str) -> None:
    crane = design.load(name)
    at = postures(crane, 5)
    x, z = planar.Plane(crane, at).tip()
    for i in range(5):
        tip = geometry.tip(crane, {joint: float(q[i]) for joint, q in at.items()})
        assert (x[i], z[i]) == pytest.approx((tip[0], tip[2]), abs=1e-12)


def test_the_slewing_moment_is_that_of_all_weights_about_the_ring() -> None:
    crane = alone(OFFSHORE, slew_moment=19e6)
    at = {"luff": 0.4, "jib": -0.5}
    frames = geometry.frames(crane, at)
    own = sum(link.mass * GRAVITY * frames[link.name].point(link.com)[0] for link in crane.links)
    expected = (19e6 - own) / (GRAVITY * geometry.radius(crane, at))
    assert chart.each_limit(crane, at)["slew moment"] == pytest.approx(expected, rel=1e-12)


def test_the_slewing_gear_holds_the_crane_at_its_worst_angle_on_a_deck_that_heels_and_trims() -> None:
    heel, trim, torque = 3 * deg, 2 * deg, 1.5e6
    crane = alone(OFFSHORE, slew_torque=torque, heel=heel, trim=trim)
    at = {"luff": 0.4, "jib": -0.5}
    mass = chart.each_limit(crane, at)["slew torque"]
    up = np.array([-math.tan(trim), -math.tan(heel), 1.0])
    up /= np.linalg.norm(up)

    def energy(slew: float) -> float:
        frames = geometry.frames(crane, {**at, "slew": slew})
        own = sum(link.mass * float(up @ frames[link.name].point(link.com)) for link in crane.links)
        return GRAVITY * (own + mass * float(up @ np.array(geometry.tip(crane, {**at, "slew": slew}))))

    h = 1e-4
    turning = [abs(energy(slew + h) - energy(slew - h)) / (2 * h) for slew in np.linspace(0, math.pi, 721)]
    assert max(turning) == pytest.approx(torque, rel=1e-5)


def test_a_level_deck_in_harbour_asks_nothing_of_the_slewing_gear_and_the_sidelead_something() -> None:
    crane = alone(OFFSHORE, slew_torque=1e6)
    at = {"luff": 0.4, "jib": -0.5}
    assert chart.each_limit(crane, at)["slew torque"] == math.inf
    assert chart.each_limit(crane, at, chart.mode(crane, "hs1.0"))["slew torque"] < 1e6


def test_rope_and_winch_carry_their_share_of_the_falls() -> None:
    rope = msgspec.structs.replace(OFFSHORE.hoist.rope, breaking_load=3e6, safety_factor=5.0)
    hoist = msgspec.structs.replace(
        OFFSHORE.hoist, rope=rope, falls=3, sheave_efficiency=0.98, line_pull=2e5, hook_mass=900.0
    )
    crane = msgspec.structs.replace(OFFSHORE, hoist=hoist, rating=design.Rating(harbour_factor=1.2))
    found = chart.each_limit(crane, {"luff": 0.8, "jib": -1.0})
    share = (1 - 0.98**3) / (1 - 0.98)
    assert found["rope"] == pytest.approx(share * 6e5 / GRAVITY / 1.2 - 900, rel=1e-12)
    assert found["winch"] == pytest.approx(share * 2e5 / GRAVITY / 1.2 - 900, rel=1e-12)


def test_load_moment_and_stability_take_no_dynamics() -> None:
    crane = alone(OFFSHORE, load_moment=10e6, heeling_moment=12e6, harbour_factor=1.5)
    at = {"luff": 0.8, "jib": -1.0}
    radius = geometry.radius(crane, at)
    for mode in chart.modes(crane):
        found = chart.each_limit(crane, at, mode)
        assert found["load moment"] == pytest.approx(10e6 / GRAVITY / radius, rel=1e-12)
        assert found["ship stability"] == pytest.approx(12e6 / GRAVITY / (radius + 7.0), rel=1e-12)


def test_at_sea_the_dynamic_factor_of_what_is_lifted_uses_up_the_limit() -> None:
    """psi(m) m = C of the rope, with psi written out for the m that the chart gives and the stiffness of the rope."""
    cylinders = tuple(msgspec.structs.replace(c, bore=40.0, rod=0.1) for c in OFFSHORE.cylinders)
    rope = msgspec.structs.replace(OFFSHORE.hoist.rope, breaking_load=3e6, safety_factor=3.0)
    hoist = msgspec.structs.replace(OFFSHORE.hoist, rope=rope, line_pull=None)
    rating = design.Rating(tip_speed_per_height=0.4)
    crane = msgspec.structs.replace(OFFSHORE, cylinders=cylinders, hoist=hoist, rating=rating)
    at = {"luff": 0.9, "jib": -0.9}
    found = chart.each_limit(crane, at, HS2)["rope"]
    plane = planar.Plane(crane, {name: np.asarray(q) for name, q in at.items()})
    length = float(plane.rope_length()) + float(plane.tip()[1]) + 12.0
    speed = 0.5 * 1.0 + math.hypot(6 * 2 / (2 + 8), 0.4 * 2)
    psi = 1 + speed / GRAVITY * math.sqrt(rope.EA / length / found)
    assert psi * found == pytest.approx(1e6 / GRAVITY, rel=2e-4)  # the oil of bores of 40 m still gives a little


def test_waves_heel_and_reeving_never_add_capacity_where_they_should_not() -> None:
    at = planar.grid(OFFSHORE, 60)
    swl = [chart.capacity(OFFSHORE, at, mode).swl for mode in chart.modes(OFFSHORE)]
    for calm, rough in itertools.pairwise(swl):
        assert np.all(rough <= calm + 1e-6)
    moment = alone(OFFSHORE, slew_moment=19e6)
    heeled = alone(OFFSHORE, slew_moment=19e6, heel=5 * deg)
    above = chart.capacity(moment, at).height > 0
    level, tilted = (chart.capacity(crane, at) for crane in (moment, heeled))
    ring = level.limits.index("slew moment")
    governed = above & (level.governs == ring) & (tilted.governs == ring)
    assert np.any(governed)
    assert np.all(tilted.swl[governed] < level.swl[governed])


def test_a_posture_that_the_crane_cannot_hold_alone_carries_nothing() -> None:
    weak = tuple(msgspec.structs.replace(c, pressure=20 * bar) for c in OFFSHORE.cylinders)
    crane = msgspec.structs.replace(OFFSHORE, cylinders=weak)
    found = chart.capacity(crane, planar.grid(crane, 30))
    assert found.swl.min() == 0.0
    outboard = found.radius > 25
    assert {found.limits[i] for i in np.unique(found.governs[outboard & (found.swl == 0)])} == {"boom_cylinder"}


def test_a_curve_names_its_posture_and_falls_with_the_radius_where_moments_govern() -> None:
    rows = chart.curve(OFFSHORE)
    assert [row.radius for row in rows] == list(range(7, 33))
    ring = [row.swl for row in rows if row.governs == "slew moment"]
    assert len(ring) > 5
    assert all(a > b for a, b in itertools.pairwise(ring))
    for row in rows:
        assert geometry.radius(OFFSHORE, row.posture) == pytest.approx(row.radius, abs=0.13)
        most = min(chart.each_limit(OFFSHORE, row.posture).values())
        assert row.swl == pytest.approx(most, rel=0.13 / row.radius + 1e-9)
    assert chart.curve(OFFSHORE, radii=[50.0]) == []


@pytest.mark.parametrize("name", ["offshore-100t", "gunnerus-pk65"])
def test_the_load_of_a_posture_is_the_least_of_its_limits_whatever_other_postures_are_asked_for(name: str) -> None:
    crane = design.load(name)
    at = planar.grid(crane, {2: 120, 3: 24}[len(planar.plane_joints(crane))])
    flat = {joint: q.ravel() for joint, q in zip(at, np.broadcast_arrays(*at.values()), strict=True)}
    for mode in (chart.HARBOUR, chart.mode(crane, "hs2.0")):
        whole, row = chart.capacity(crane, at, mode), chart.capacity(crane, flat, mode)
        np.testing.assert_allclose(whole.swl.ravel(), row.swl, rtol=1e-12)
        for i in np.linspace(0, row.swl.size - 1, 12).astype(int):
            each = chart.each_limit(crane, {joint: float(q[i]) for joint, q in flat.items()}, mode)
            assert row.swl[i] == pytest.approx(min(each.values()), rel=1e-12)
            assert each[row.limits[row.governs[i]]] == pytest.approx(min(each.values()), rel=1e-12)


def test_a_cylinder_in_line_with_its_joint_holds_nothing() -> None:
    """The pin of the boom straight above the pin of the column: no lever on the joint between them."""
    above = tuple(
        msgspec.structs.replace(c, base=design.Attachment(link="column", x=0.0, z=1.0), eye=c.eye)
        if c.name == "boom_cylinder"
        else c
        for c in OFFSHORE.cylinders
    )
    eye = above[0].eye
    straight = math.pi / 2 - math.atan2(eye.z, eye.x)
    each = chart.each_limit(msgspec.structs.replace(OFFSHORE, cylinders=above), {"luff": straight, "jib": -1.0}, HS2)
    assert each["boom_cylinder"] == pytest.approx(0.0, abs=1.0)
    assert each["jib_cylinder"] > 1e3


def test_hook_speed_for_a_lift_from_a_vessel() -> None:
    still = msgspec.structs.replace(OFFSHORE, rating=design.Rating())
    assert chart.hook_speed_needed(still, HS2) == pytest.approx(0.5 * 1.2)
    two = msgspec.structs.replace(still, hoist=msgspec.structs.replace(still.hoist, falls=2))
    assert chart.hook_speed_needed(two, HS2) == pytest.approx(0.28 * 1.2)
    assert chart.hook_speed_needed(still, chart.HARBOUR) == 0.0


def test_a_mode_that_is_not_there_gets_the_nearest() -> None:
    with pytest.raises(DesignError, match=r"mode: is not one of this crane \(got 'hs2'\); allowed: harbour, hs1.0"):
        chart.mode(OFFSHORE, "hs2")


def test_a_crane_out_of_one_plane_is_refused_with_every_joint_that_leaves_it() -> None:
    links = list(OFFSHORE.links)
    for i, axis in ((1, (0, -1, 0.2)), (2, (1, 0, 0))):
        joint = msgspec.structs.replace(links[i].joint, axis=axis)
        links[i] = msgspec.structs.replace(links[i], joint=joint)
    with pytest.raises(DesignError) as refused:
        chart.capacity(msgspec.structs.replace(OFFSHORE, links=tuple(links)), {"luff": np.zeros(1), "jib": np.zeros(1)})
    assert [problem.path for problem in refused.value.problems] == [
        "links[boom].joint.axis",
        "links[jib].joint.axis",
    ]


def test_without_any_limit_nothing_governs() -> None:
    free = msgspec.structs.replace(alone(OFFSHORE), cylinders=())
    found = chart.capacity(free, {"luff": np.zeros(1), "jib": np.zeros(1)})
    assert found.limits == (chart.NOTHING,)
    assert np.isinf(found.swl).all()
