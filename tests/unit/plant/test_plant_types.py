"""Which cranes can be operated."""

from __future__ import annotations

import pytest

from seacrane import design, plant
from seacrane.errors import StructureError


@pytest.mark.parametrize("name", ["a-frame-30t", "gangway-24m", "dual-drag-link-60t", "gunnerus-pk65"])
def test_a_crane_of_another_type_is_refused_with_its_joints_and_what_it_can_do(name: str) -> None:
    crane = design.load(name)
    joints = ", ".join(joint.name for joint in crane.joints)
    with pytest.raises(StructureError) as refused:
        plant.build(crane)
    (problem,) = refused.value.problems
    assert problem.path == f"{name}: links"
    assert problem.value == joints
    assert "knuckle boom crane" in problem.message
    assert "crane_mechanics" in str(problem)
