"""The search for designs."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from seacrane import design, studies
from seacrane.design import buckling, changes, chart
from seacrane.errors import DesignError, ParameterError
from seacrane.studies import Front, Goal, Variable
from seacrane.studies.optimisation import BUCKLING, judged, plain, violation

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


def test_a_candidate_has_the_sizes_it_is_told_with_and_a_stroke_that_follows_its_joint() -> None:
    sizes = {
        "cylinders[boom_cylinder].rod": 0.2,
        "cylinders[boom_cylinder].bore": 0.4,
        "cylinders[jib_cylinder].base.x": 11.0,  # beyond the middle of the boom: a longer boom would take it along
        "links[boom].length": 20.0,
    }
    crane = changes.changed(CRANE, sizes)
    assert {path: changes.value(crane, path) for path in sizes} == pytest.approx(sizes)
    assert [p.path for p in design.check(crane)] == []


def test_the_best_cranes_lift_in_their_own_load_chart_what_the_front_says(fronts: list[Front]) -> None:
    last = fronts[-1]
    for index in np.flatnonzero(last.best):
        (row,) = chart.curve(last.design(int(index)), radii=[20.0], count=400)
        assert last.goals[index, 1] == pytest.approx(row.swl, rel=0.01)


@pytest.mark.parametrize(
    ("name", "radius"), [("gunnerus-pk65", 18.0), ("dual-drag-link-60t", 28.0), ("a-frame-30t", 4)]
)
def test_the_load_at_a_radius_is_that_of_the_load_chart(name: str, radius: float) -> None:
    crane = design.load(name)
    count = 400 if name == "a-frame-30t" else 90
    (row,) = chart.curve(crane, radii=[radius], count=count)
    assert judged(crane, [Goal("capacity", radius)]) == pytest.approx([row.swl], rel=0.01)
    assert judged(crane, [Goal("capacity", 100.0)]) == [0.0]


def test_no_rod_of_the_front_buckles_although_a_thin_one_is_lighter() -> None:
    variables = (
        Variable("cylinders[boom_cylinder].bore", 0.35, 0.5),
        Variable("cylinders[boom_cylinder].rod", 0.1, 0.6),
    )
    *_, last = studies.optimise(
        CRANE, variables, (Goal("weight"), Goal("capacity", 20.0)), population=16, generations=5
    )
    cranes = [last.design(int(index)) for index in np.flatnonzero(last.best)]
    assert len(cranes) > 4
    safeties = [buckling.safety(crane, crane.cylinder("boom_cylinder")) for crane in cranes]
    assert min(safeties) >= BUCKLING
    thin = changes.changed(CRANE, {variable.path: variable.low for variable in variables})
    assert judged(thin, [Goal("weight")])[0] < last.goals[last.best, 0].min()
    assert all(design.check(crane) == [] for crane in cranes)


@pytest.mark.parametrize(
    ("sizes", "words"),
    [
        ({"cylinders[boom_cylinder].bore": 1.5}, "a stroke and a bore take"),
        ({"cylinders[boom_cylinder].rod": 0.415}, "leaves no annulus"),
        ({"cylinders[boom_cylinder].rod": 0.12}, "times safe against buckling"),
        ({"cylinders[jib_cylinder].eye.z": 2.5}, "passes a dead point within the limits of jib"),
    ],
)
def test_what_cannot_be_built_is_told_in_words(sizes: dict[str, float], words: str) -> None:
    crane = changes.changed(CRANE, sizes)
    assert any(words in reason for reason in studies.why_not(crane))
    assert violation(crane) > 0
    assert studies.why_not(CRANE) == []
    assert violation(CRANE) == 0


@pytest.mark.parametrize("name", design.names())
def test_every_ready_design_could_be_a_candidate(name: str) -> None:
    assert studies.why_not(design.load(name)) == []


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
            {"path": "cylinders[boom_cylinder].eye.z", "low": "-1500 mm", "high": 0},
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
        (VARIABLES, (Goal("weight"), Goal("weight")), "goals: weight is there twice"),
        (VARIABLES[:1] * 2, GOALS, "jib..length is there twice"),
        (VARIABLES, (Goal("capacity", 40), Goal("weight")), r"out of reach of every candidate .*; allowed: up to 36 m"),
        ((Variable("links[column].length", 1, 2),), GOALS, "no length along its x"),
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
        (
            {"variables": [{"path": "links[jib].length", "low": "a"}], "goals": []},
            r"variables\[0\].low: is not a number with a unit",
        ),
        ({"variables": [{"path": "links[jib].length", "low": "3 bar"}], "goals": []}, "cannot be given in 'm'"),
        ({"variables": [{"path": "links[jib].length", "high": None}], "goals": []}, "must be a length"),
        ({"variables": [{"path": "links[jib].length", "hihg": 3}], "goals": []}, "Did you mean 'high'"),
        ({"variables": [3], "goals": []}, r"variables\[0\]: must be an object"),
        ({"variables": [], "goals": [{"kind": "capacity", "radius": True}]}, r"goals\[0\].radius: must be a length"),
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
