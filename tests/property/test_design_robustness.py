"""Whatever stands in a design file, the answer is a crane or a `DesignError`, never another failure."""

import copy
import json
from importlib import resources

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from seacrane import design
from seacrane.errors import DesignError

GOOD = json.loads((resources.files("seacrane.design") / "cranes" / "offshore-100t.json").read_text())


def places(data, path=()):
    """The path of every value in the file."""
    for key, value in data.items() if isinstance(data, dict) else enumerate(data):
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from places(value, (*path, key))


PLACES = list(places(GOOD))
JUNK = st.recursive(
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(max_size=8)
    | st.sampled_from(["420 mm", "-5 deg", "1e999 m", "280 Pa", "luff", "boom", "prismatic", "nan m", "1 m m"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)
CHANGES = st.lists(st.tuples(st.sampled_from(PLACES), st.one_of(st.just("remove"), JUNK)), min_size=1, max_size=4)


def spoilt(changes):
    data = copy.deepcopy(GOOD)
    for path, value in changes:
        *way, last = path
        holder = data
        try:
            for key in way:
                holder = holder[key]
            if value == "remove":
                del holder[last]
            else:
                holder[last] = value
        except (KeyError, IndexError, TypeError):
            continue  # an earlier change took this place away
    return data


def answer(content):
    try:
        return design.loads(content)
    except DesignError as error:
        return error


@settings(max_examples=150, deadline=None)
@given(CHANGES)
def test_a_spoilt_file_gives_a_crane_or_says_what_is_wrong(changes):
    found = answer(json.dumps(spoilt(changes)))
    if isinstance(found, DesignError):
        assert found.problems
        assert all(problem.message for problem in found.problems)
    else:
        assert design.check(found) == []
        assert design.loads(design.to_json(found)) == found


@settings(max_examples=100, deadline=None)
@given(st.binary(max_size=60) | st.text(max_size=60).map(str.encode) | JUNK.map(lambda j: json.dumps(j).encode()))
def test_any_bytes_are_answered_with_a_design_error(content):
    assert isinstance(answer(content), DesignError)


@pytest.mark.parametrize("place", [p for p in PLACES if p[0] != "sources"], ids=lambda p: ".".join(map(str, p)))
def test_a_number_beyond_all_bounds_breaks_nothing(place):
    for value in (1e308, 10**400):
        assert isinstance(answer(json.dumps(spoilt([(place, value)]))), DesignError | design.Crane)
