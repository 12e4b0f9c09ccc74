"""The search for better designs, in a real browser with the server behind it."""

from collections.abc import Callable
from typing import Any


def test_a_designer_searches_takes_a_design_of_the_front_and_undoes_it(
    designer: str, browse: Callable[..., Any]
) -> None:
    browse("optimise.mjs", designer, "searches")


def test_a_search_whose_server_is_lost_loses_nothing_that_was_found(designer: str, browse: Callable[..., Any]) -> None:
    browse("optimise.mjs", designer, "keeps_what_was_found_when_the_server_is_lost")


def test_a_mesh_of_another_program_becomes_a_part_in_its_unit_or_is_refused(
    designer: str, browse: Callable[..., Any]
) -> None:
    browse("mesh.mjs", designer, "takes_a_mesh_in_its_unit_or_refuses_it")
