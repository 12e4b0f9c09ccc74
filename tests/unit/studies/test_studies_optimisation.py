"""The search for designs."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from seacrane import design, studies
from seacrane.errors import DesignError, ParameterError
from seacrane.studies import Front, Goal, Variable
from seacrane.studies.optimisation import judged, plain, violation

CRANE = design.load("offshore-100t")
VARIABLES = (
    Variable("links[jib].length", 10, 18),
    Variable("cylinders[boom_cylinder].bore", 0.35, 0.5),
    Variable("cylinders[boom_cylinder].eye.x", 5.5, 7.5),
)
GOALS = (Goal("reach"), Goal("capacity", 20.0), Goal("weight"))


@pytest.fixture(scope="module")
def fronts() -> list[Front]:
    return list(studies.optimise(CRANE, VARIABLES, GOALS, population=16, generations=6))


def volume(front: Front) -> float:
    """Share of a box of goals that the front beats, by points spread over it."""
    random = np.random.default_rng(0)
    low, high = np.array([25.0, 20e3, 150e3]), np.array([37.0, 90e3, 240e3])
    points = low + (high - low) * random.random((4000, 3))
    best = front.goals[front.best]
    beats = (best[:, None, 0] >= points[:, 0]) & (best[:, None, 1] >= points[:, 1]) & (best[:, None, 2] <= points[:, 2])
    return float(beats.any(axis=0).mean())


def test_the_front_grows_better_and_holds_cranes_that_can_be_built(fronts: list[Front]) -> None:
    assert volume(fronts[-1]) > volume(fronts[0])
    last = fronts[-1]
    assert last.generation == 6
    for index in np.flatnonzero(last.best):
        crane = last.design(int(index))
        assert design.check(crane) == []
        assert judged(crane, GOALS) == pytest.approx(last.goals[index].tolist())
        assert violation(crane) == last.violation[index] == 0


def test_none_of_the_best_beats_another(fronts: list[Front]) -> None:
    signed = fronts[-1].goals[fronts[-1].best] * np.array([-1, -1, 1])
    for one in signed:
        assert not np.any(np.all(signed <= one, axis=1) & np.any(signed < one, axis=1))


def test_a_stopped_search_goes_on_as_if_it_had_not_been(fronts: list[Front], tmp_path: Path) -> None:
    studies.save(fronts[3], tmp_path / "front.json")
    *_, resumed = studies.optimise(CRANE, (), (), generations=6, state=studies.read(tmp_path / "front.json"))
    np.testing.assert_array_equal(resumed.values, fronts[-1].values)
    np.testing.assert_array_equal(resumed.goals, fronts[-1].goals)


def test_the_crane_as_it_stands_is_among_the_first(fronts: list[Front]) -> None:
    np.testing.assert_allclose(fronts[0].values[0], [14.0, 0.42, 6.5])


def test_a_specification_of_a_page_gets_bounds_about_what_stands_there() -> None:
    data = {
        "variables": [
            {"path": "links[jib].length"},
            {"path": "cylinders[boom_cylinder].eye.z", "low": -1.5, "high": 0},
        ],
        "goals": [{"kind": "capacity", "radius": 20, "mode": "hs2.0"}, {"kind": "weight"}],
    }
    variables, goals = studies.specification(data, CRANE)
    assert variables == (
        Variable("links[jib].length", 10.5, 17.5),
        Variable("cylinders[boom_cylinder].eye.z", -1.5, 0.0),
    )
    assert [goal.name for goal in goals] == ["capacity at 20 m, hs2.0", "weight"]


@pytest.mark.parametrize(
    ("variables", "goals", "message"),
    [
        ((), GOALS, "there is nothing that may change"),
        (VARIABLES, GOALS[:1], "a front needs two goals or more"),
        ((Variable("links[jib].length", 18, 10),), GOALS, "low must be below high"),
        ((Variable("links[jib].length", -1, 10),), GOALS, "must stay above 0 m"),
        (VARIABLES, (Goal("capacity", 20, "hs9"), Goal("weight")), "is not one of this crane"),
        (VARIABLES, (Goal("capacity"), Goal("weight")), "must be above 0 m"),
    ],
)
def test_what_cannot_be_searched_is_refused(
    variables: tuple[Variable, ...], goals: tuple[Goal, ...], message: str
) -> None:
    with pytest.raises(ParameterError, match=message):
        next(studies.optimise(CRANE, variables, goals))


def test_bad_specifications_and_files_are_refused_in_words(tmp_path: Path) -> None:
    for data, message in (
        ([], "must be an object"),
        ({"variables": 3, "goals": [{"kind": "beauty"}]}, "must be a list"),
        ({"variables": [{"path": 1}], "goals": []}, "must be the path of a size"),
        ({"variables": [{"path": "links[jib].length", "low": "a"}], "goals": []}, "must be numbers in m"),
    ):
        with pytest.raises(ParameterError, match=message):
            studies.specification(data, CRANE)
    with pytest.raises(DesignError, match="is not a size"):
        studies.specification({"variables": [{"path": "name"}], "goals": []}, CRANE)
    (tmp_path / "other.json").write_text("{}")
    with pytest.raises(ParameterError, match="is not a saved optimisation"):
        studies.read(tmp_path / "other.json")


def test_a_damaged_front_is_refused_with_all_that_is_wrong(fronts: list[Front]) -> None:
    whole = plain(fronts[0])
    for damage, messages in (
        ({"values": None, "seed": -1}, [r"values: must be a list", "seed: must be a whole number, 0 or more"]),
        ({"values": [[1.0, 2.0]] * 16}, ["allowed: rows of 3 finite numbers"]),
        ({"results": [[1.0, 2.0, "x"]] * 16}, ["results: must be a list"]),
        ({"violation": [float("inf")] * 16}, ["violation: must be a list"]),
        ({"violation": [0.0] * 15}, ["as many results and violations as values"]),
        ({key: whole[key][:3] for key in ("values", "results", "violation")}, ["too few candidates"]),
        ({"generation": True}, ["generation: must be a whole number"]),
    ):
        with pytest.raises(ParameterError) as refused:
            studies.loads(json.dumps({**whole, **damage}))
        for message in messages:
            assert re.search(message, str(refused.value))
    with pytest.raises(DesignError, match="the front"):
        studies.loads(json.dumps({**whole, "crane": None}))


def test_a_front_is_plain_data_for_a_page(fronts: list[Front]) -> None:
    data = plain(fronts[-1])
    assert len(data["values"]) == len(data["results"]) == len(data["best"]) == 16
    assert data["goals"][1]["name"] == "capacity at 20 m, harbour"
