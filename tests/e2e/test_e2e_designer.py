"""The designer as its user meets it: the command, its page in a real browser, files out and in again."""

from collections.abc import Callable
from typing import Any

import pytest


@pytest.mark.parametrize(
    "scenario",
    [
        "creates_drags_undoes_saves_and_opens_equal",
        "exports_and_imports_equal_through_the_server",
        "shows_what_cannot_be_built_in_place_and_in_words",
        "works_by_keyboard_alone",
        "recovers_the_work_after_a_reload",
        "steps_into_the_simulation",
        "has_no_serious_violation_and_looks_well",
    ],
)
def test_a_designer(scenario: str, designer: str, browse: Callable[..., Any]) -> None:
    browse("designer.mjs", designer, scenario)
