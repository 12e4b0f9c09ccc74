"""What is about the crane on the designer's page, in a real browser: commands, panels, links, fields."""

from collections.abc import Callable
from typing import Any

import pytest


@pytest.mark.parametrize(
    "scenario",
    [
        "gives_every_command_by_a_few_letters_and_keys_alone",
        "moves_folds_and_swaps_panels_and_remembers_them",
        "saves_a_front_and_opens_it_again",
        "opens_a_copied_link_as_it_was_seen_and_loses_no_work",
        "drags_numbers_finely_and_reckons_them",
    ],
)
def test_the_designers_page(scenario: str, designer: str, browse: Callable[..., Any]) -> None:
    browse("designer_page.mjs", designer, scenario)
