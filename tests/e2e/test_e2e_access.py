"""The designer for those who use no pointer, want less motion or read it by other means, in a real browser."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

import pytest

from seacrane import design

Browse = Callable[..., Any]


def test_a_crane_is_made_and_exported_by_keyboard_alone(designer: str, browse: Browse) -> None:
    seen = browse("access.mjs", designer, "goes_from_an_empty_page_to_an_exported_crane_by_keyboard")
    crane = design.archive.load_archive(seen["path"])
    assert crane == design.loads(json.dumps(seen["design"]))
    assert crane.name == "by keys"
    assert crane.cylinder("jib_cylinder").bore == 0.35
    assert design.check(crane) == []


@pytest.mark.parametrize(("scheme", "width"), [("light", "1280"), ("dark", "1920")])
def test_no_state_of_the_page_has_a_serious_violation(scheme: str, width: str, designer: str, browse: Browse) -> None:
    browse("access.mjs", designer, "has_no_serious_violation_in_any_state", scheme, width)


def test_nothing_moves_by_itself_where_less_motion_is_asked_for(designer: str, browse: Browse) -> None:
    browse("access.mjs", designer, "moves_nothing_by_itself_where_less_motion_is_asked_for")
