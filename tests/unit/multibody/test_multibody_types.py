"""Cranes of other types than the knuckle boom crane, through the same equations."""

from __future__ import annotations

import msgspec
import pytest
from dae_evaluation import Evaluation

from seacrane import design
from seacrane.design import Attachment, Crane, Joint
from seacrane.multibody import crane_mechanics

KNUCKLE = design.load("offshore-100t")


def telescopic() -> Crane:
    """RRP: the jib slides in the boom, moved by its cylinder."""
    column, boom, jib = KNUCKLE.links
    inner = msgspec.structs.replace(
        jib, joint=Joint(name="telescope", kind="prismatic", axis=(1, 0, 0), origin=(6, 0, 0), limits=(0, 10))
    )
    base, eye = Attachment(link="boom", x=2, z=0.8), Attachment(link="jib", x=0, z=0.8)
    push = msgspec.structs.replace(
        KNUCKLE.cylinders[1], name="telescope_cylinder", moves="telescope", base=base, eye=eye
    )
    return msgspec.structs.replace(KNUCKLE, links=(column, boom, inner), cylinders=(KNUCKLE.cylinders[0], push))


def frame() -> Crane:
    """RP without cylinders: a tilting frame and a trolley, each with its own drive."""
    boom, jib = KNUCKLE.links[1:]
    trolley = msgspec.structs.replace(
        jib, joint=Joint(name="trolley", kind="prismatic", axis=(1, 0, 0), origin=(0, 0, 0), limits=(0, 10))
    )
    hoist = msgspec.structs.replace(
        KNUCKLE.hoist, drum=Attachment(link="boom", x=0, z=0), sheaves=(Attachment(link="jib", x=14, z=0),)
    )
    return msgspec.structs.replace(KNUCKLE, links=(boom, trolley), cylinders=(), hoist=hoist)


def dual_drag() -> Crane:
    """RRRR: an outer jib with a drive of its own."""
    outer = msgspec.structs.replace(
        KNUCKLE.links[2],
        name="outer",
        mass=6e3,
        joint=Joint(name="outer", kind="revolute", axis=(0, -1, 0), origin=(14, 0, 0), limits=(-1.5, 0)),
    )
    hoist = msgspec.structs.replace(KNUCKLE.hoist, sheaves=(*KNUCKLE.hoist.sheaves, Attachment(link="outer", x=8, z=0)))
    return msgspec.structs.replace(KNUCKLE, links=(*KNUCKLE.links, outer), hoist=hoist)


@pytest.mark.parametrize(
    ("crane", "inputs"),
    [
        (telescopic(), {"boom_cylinder.force", "telescope_cylinder.force", "slew.torque"}),
        (frame(), {"luff.torque", "trolley.force"}),
        (dual_drag(), {"boom_cylinder.force", "jib_cylinder.force", "slew.torque", "outer.torque"}),
    ],
    ids=["telescopic", "frame", "dual drag link"],
)
def test_a_crane_of_another_type_rests_in_its_equilibrium(crane: Crane, inputs: set[str]) -> None:
    dae = crane_mechanics(crane, 20e3)
    assert {v.name for v in dae.inputs if not v.name.startswith(("base.", "drum."))} == inputs
    result = Evaluation(dae)()
    assert max(abs(value) for name, value in result.items() if name.startswith("der(")) < 1e-8
    weight = 9.81 * (sum(link.mass for link in crane.links) + 20e3)
    assert result["wrench.fz"] == pytest.approx(-weight, rel=1e-9)
