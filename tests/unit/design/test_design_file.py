"""A design file is read with its units, and a bad one is answered with everything that is wrong with it."""

import json
import math
from importlib import resources

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.errors import DesignError
from seacrane.units import bar, deg, mm, rpm


@pytest.fixture
def data():
    """The shipped design file as plain data, to be spoilt."""
    return json.loads((resources.files("seacrane.design") / "cranes" / "offshore-100t.json").read_text())


@pytest.fixture
def crane():
    return design.load("offshore-100t")


def problems(data):
    with pytest.raises(DesignError) as caught:
        design.loads(json.dumps(data), origin="spoilt")
    return [str(problem).removeprefix("spoilt: ") for problem in caught.value.problems]


def test_the_reference_crane_is_read_in_si(crane):
    main = crane.cylinder("boom_cylinder")
    assert (main.bore, main.rod, main.pressure) == pytest.approx((420 * mm, 300 * mm, 280 * bar))
    assert crane.link("boom").joint.limits == pytest.approx((0.0, 78 * deg))
    assert crane.link("column").mass == 110e3
    assert crane.slew.speed == pytest.approx(1 * rpm)
    assert [joint.name for joint in crane.joints] == ["slew", "luff", "jib"]
    assert crane.joints[0].limits is None


def test_every_shipped_design_is_sound_and_names_its_sources():
    for name in design.names():
        crane = design.load(name)
        assert crane.name == name
        assert design.check(crane) == []
        assert any(source.kind == "assumption" for source in crane.sources)


def test_a_crane_survives_its_own_file(crane, tmp_path):
    path = tmp_path / "copy.json"
    design.save(crane, path)
    assert design.load(path) == crane
    assert design.load(str(path)) == crane
    assert [item.name for item in tmp_path.iterdir()] == ["copy.json"]


def test_a_number_in_the_file_is_si(data, crane):
    data["cylinders"][0]["bore"] = 0.42
    data["cylinders"][0]["retracted"] = None
    assert design.loads(json.dumps(data)) == crane


def test_an_unsound_crane_is_not_written_and_the_old_file_stays(crane, tmp_path):
    path = tmp_path / "crane.json"
    design.save(crane, path)
    before = path.read_bytes()
    with pytest.raises(DesignError, match="bulk_modulus: must be above 0"):
        design.save(msgspec.structs.replace(crane, bulk_modulus=-1.0), path)
    assert path.read_bytes() == before
    assert len(list(tmp_path.iterdir())) == 1


def test_an_unknown_name_names_the_nearest_design():
    with pytest.raises(DesignError, match="Did you mean 'offshore-100t'"):
        design.load("ofshore-100t")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"{", "is not JSON: .* in line 1, column 2"),
        (b"\xff\xfe", "is not a text file in UTF-8"),
        (b"[1]", "must be a JSON object"),
        (b"{}", "names no format.*allowed: 'seacrane-crane/1'"),
        (b'{"format": "seacrane-crane/9"}', "a format that this version cannot read .got 'seacrane-crane/9'."),
        (b'{"format": "a", "format": "b"}', "gives a field twice in one object: 'format'"),
        (b"[" * 200_000, "nested too deeply"),
        (b"1" * 5000, "a number too long"),
    ],
)
def test_what_is_no_design_file_says_so(tmp_path, content, message):
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(DesignError, match=message):
        design.load(path)


def test_a_missing_file_and_a_folder_say_so(tmp_path):
    with pytest.raises(DesignError, match="cannot be read: No such file"):
        design.load(tmp_path / "none.json")
    with pytest.raises(DesignError, match="cannot be read: Is a directory"):
        design.load(tmp_path)


def test_an_unknown_field_names_the_nearest(data):
    data["cylinders"][0]["boer"] = "1 m"
    assert problems(data) == [
        "cylinders[boom_cylinder].boer: is not a field here. Did you mean 'bore' or 'base'?",
    ]


def test_a_wrong_unit_says_what_it_is_and_what_is_allowed(data):
    data["cylinders"][0]["bore"] = "420 kg"
    assert problems(data) == [
        "cylinders[boom_cylinder].bore: cannot be given in 'kg': piston diameter [m] (got '420 kg'); "
        "allowed: m, mm, cm, km, ft, in"
    ]


def test_a_text_without_a_unit_and_an_unknown_unit_are_refused(data):
    data["cylinders"][0]["bore"] = "420"
    data["cylinders"][0]["rod"] = "300 milimetre"
    data["links"][0]["mass"] = "heavy"
    first, second, third = problems(data)
    assert first == "links[column].mass: is not a number with a unit (got 'heavy'); allowed: kg, t"
    assert second.startswith("cylinders[boom_cylinder].bore: the unit is missing (got '420'); allowed: m, mm")
    assert third.startswith("cylinders[boom_cylinder].rod: unknown unit 'milimetre' (got '300 milimetre')")


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("-48 t", "links[boom].mass: must be above 0: mass with all that is fixed to it [kg] (got '-48 t')"),
        (0, "links[boom].mass: must be above 0: mass with all that is fixed to it [kg] (got 0)"),
        (True, "links[boom].mass: must be a number in kg: mass with all that is fixed to it [kg] (got True)"),
        ("1e999 t", "links[boom].mass: must be a finite number (got '1e999 t')"),
        (math.nan, "links[boom].mass: must be a finite number (got 'nan')"),
        (math.inf, "links[boom].mass: must be a finite number (got 'inf')"),
    ],
)
def test_a_mass_must_be_a_positive_number(data, value, message):
    data["links"][1]["mass"] = value
    assert problems(data) == [message]


@pytest.mark.parametrize(
    ("pressure", "question"),
    [("280 Pa", "did you mean 280 bar?"), (280, "did you mean 280 bar?")],
)
def test_an_implausible_magnitude_is_questioned(data, pressure, question):
    data["cylinders"][1]["pressure"] = pressure
    (problem,) = problems(data)
    assert problem.startswith("cylinders[jib_cylinder].pressure: is implausible")
    assert problem.endswith(question)


def test_degrees_typed_as_radian_are_questioned(data):
    data["links"][1]["joint"]["limits"] = [0, 78]
    assert "78 rad is implausible; did you mean 78 deg?" in problems(data)[0]


def test_missing_fields_and_a_missing_joint_are_named(data):
    del data["links"][2]["joint"]
    del data["cylinders"][0]["bore"]
    assert problems(data) == [
        "links[jib].joint: is missing",
        "cylinders[boom_cylinder].bore: is missing: piston diameter [m]",
        "cylinders[jib_cylinder].moves: moves a joint that the crane does not have (got 'jib'). Known: luff, slew.",
    ]


def test_a_missing_link_shows_at_everything_that_hangs_on_it(data):
    del data["links"][2]
    found = problems(data)
    assert [problem.split(": ")[0] for problem in found] == [
        "cylinders[jib_cylinder].eye.link",
        "hoist.sheaves[1].link",
        "cylinders[jib_cylinder].moves",
    ]
    assert all("does not have (got 'jib')" in problem for problem in found)


def test_all_problems_are_reported_at_once(data):
    data["name"] = ""
    data["links"][0]["mass"] = "-1 t"
    data["links"][1]["inertia"] = [1, 1, 3]
    data["links"][1]["joint"]["limits"] = ["78 deg", "-5 deg"]
    data["cylinders"][0]["rod"] = "500 mm"
    data["hoist"]["drum"]["link"] = "colunm"
    data["capacity"].reverse()
    found = problems(data)
    for words in (
        "name: must not be empty",
        "links[column].mass: must be above 0",
        "no body has these moments of inertia",
        "Are they reversed?",
        "must be thinner than the bore",
        "hoist.drum.link: is on a link that the crane does not have (got 'colunm'). Did you mean 'column'?",
        "capacity: the radius must grow",
    ):
        assert any(words in problem for problem in found), words
    assert len(found) == 7


def test_a_thin_plate_is_the_limit_of_the_triangle_inequality(data):
    data["links"][1]["inertia"] = [1.0, 2.0, 3.0]
    design.loads(json.dumps(data))
    data["links"][1]["inertia"] = [1.0, 2.0, 3.001]
    assert "allowed: largest at most 3 kg.m2" in problems(data)[0]
    data["links"][1]["inertia"] = [1.0, 0.0, 1.0]
    assert "must be above 0 kg.m2" in problems(data)[0]


def test_names_are_unique(data):
    data["links"][1]["name"] = "column"
    data["links"][1]["joint"]["name"] = "slew"
    data["cylinders"][1]["name"] = "boom_cylinder"
    found = problems(data)
    assert "links: 'column' is the name of two links" in found
    assert "links: 'slew' is the name of two joints" in found
    assert "cylinders: 'boom_cylinder' is the name of two cylinders" in found


def test_a_cylinder_too_short_for_its_joint_says_what_stroke_would_do(data):
    data["links"][1]["joint"]["limits"] = ["-5 deg", "78 deg"]
    (problem,) = problems(data)
    assert problem == (
        "cylinders[boom_cylinder].stroke: is too short for the joint's limits: the pins are 5.02 to 9.764 m apart over "
        "the joint's limits (got 4.4); allowed: at least 4.744 m. Give a longer stroke, narrower limits of the joint, "
        "or other pins."
    )


def test_a_cylinder_that_could_not_be_built_is_refused(data):
    data["cylinders"][0]["stroke"] = "5 m"
    assert "piston, head and eyes need about one bore beyond the stroke" in problems(data)[0]


def test_a_retracted_length_must_let_the_joint_reach_its_limits(data):
    data["cylinders"][1]["retracted"] = "5.7 m"
    assert design.loads(json.dumps(data)).cylinder("jib_cylinder").retracted == pytest.approx(5.7)
    data["cylinders"][1]["retracted"] = "5.8 m"
    assert "allowed: 5.618 to 5.708 m" in problems(data)[0]


def test_a_cylinder_must_straddle_the_joint_it_moves_and_the_joint_must_end(data):
    data["cylinders"][1]["moves"] = "luff"
    (problem,) = problems(data)
    assert "are not on both sides of the joint it moves (got 'luff'); allowed: jib" in problem
    data["cylinders"][1]["moves"] = "jib"
    del data["links"][2]["joint"]["limits"]
    assert "cannot move an endless joint" in problems(data)[0]


def test_a_cylinder_moves_one_joint_and_a_joint_has_one_set(data):
    jib = data["cylinders"][1]
    data["cylinders"].append(jib | {"name": "another"})
    (problem,) = problems(data)
    assert problem == "cylinders: 'jib' is moved by two sets. Cylinders side by side are one, with a `count`."
    data["cylinders"].pop()
    jib["base"]["link"] = "column"
    (problem,) = problems(data)
    assert "cylinders[jib_cylinder]: has more than one joint between its pins: luff, jib; allowed: only jib" in problem


def test_a_design_has_no_more_and_nothing_larger_than_a_crane(data):
    data["rating"]["wave_heights"] = [1.0, 1.04, -8, 30]
    data["links"][1]["mass"] = 1e30
    data["links"][1]["parts"] = [{"kind": ["box"], "name": "odd"}]
    data["hoist"]["sheaves"][1]["x"] = 2000
    data["sources"] *= 200
    data["name"] = "two\nlines"
    data["about"] = "a bell \x07"
    data["cylinders"][0]["name"] = "\ud800"
    assert [problem.split("; allowed")[0] for problem in problems(data)] == [
        "name: must be one line of at most 100 characters (got 'two\\nlines')",
        "about: has a character that cannot be printed (got 'U+0007')",
        "links[boom].mass: is beyond any crane (got 1e+30)",
        "links[boom].parts[odd].kind: is none of the known values (got ['box'])",
        "cylinders[0].name: has a character that cannot be printed (got 'U+D800')",
        "rating.wave_heights[2]: must be above 0: significant wave height [m] (got -8)",
        "rating.wave_heights[3]: must be at most 20: significant wave height [m] (got 30)",
        "sources: must have at most 1000 entries (got 2200)",
        "links: are longer together than any crane (got '2022 m')",
        "rating.wave_heights: two of them are the mode 'hs1.0'",
    ]


def test_a_file_may_begin_with_the_mark_of_an_editor(data):
    assert design.loads(b"\xef\xbb\xbf" + json.dumps(data).encode()) == design.loads(json.dumps(data))


def test_a_chain_of_thousands_of_links_or_parts_is_refused_at_once(data):
    whole = json.dumps(data["links"][1])
    for count, what in ((13, "must have at most 12 entries (got 13)"), (5000, "(got 5000)")):
        data["links"] = [json.loads(whole) for _ in range(count)]
        assert what in next(problem for problem in problems(data) if problem.startswith("links:"))


def test_an_axis_needs_a_direction_and_a_point_three_numbers(data):
    data["links"][1]["joint"]["axis"] = [0, 0, 0]
    data["links"][2]["com"] = ["6 m", "0 m"]
    data["links"][0]["joint"]["kind"] = "hinge"
    data["hoist"]["sheaves"] = []
    found = problems(data)
    for words in (
        "links[boom].joint.axis: has no direction",
        "links[jib].com: must have 3 entries",
        "links[column].joint.kind: is none of the known values (got 'hinge'); allowed: revolute, prismatic",
        "hoist.sheaves: must have at least 1 entry",
    ):
        assert any(words in problem for problem in found), words


def test_limits_of_a_sliding_joint_are_lengths(data):
    data["links"][2]["joint"] |= {"kind": "prismatic", "axis": [1, 0, 0], "limits": ["0 deg", "3 m"]}
    assert "links[jib].joint.limits[0]: cannot be given in 'deg'" in problems(data)[0]


def test_the_last_sheave_is_on_the_last_link(data):
    data["hoist"]["sheaves"].pop()
    assert "the last sheave is the tip" in problems(data)[0]


def test_what_is_not_an_object_a_list_or_a_text_says_so(data):
    data["hoist"] = 3
    data["links"][0]["com"] = "here"
    data["about"] = 7
    data["cylinders"][0]["count"] = 1.5
    assert [problem.split(" (got")[0] for problem in problems(data)] == [
        "about: must be a text",
        "links[column].com: must be a list",
        "cylinders[boom_cylinder].count: must be a whole number: number of cylinders side by side",
        "hoist: must be an object with the fields of a hoist",
    ]


def test_a_crane_built_in_python_is_held_to_the_same_checks(crane):
    boom = msgspec.structs.replace(crane.links[1], mass=-1.0, com=(float("nan"), 0.0, 0.0))
    main = msgspec.structs.replace(crane.cylinders[0], bore="420 mm", pressure=280.0)
    bad = msgspec.structs.replace(crane, links=(crane.links[0], boom, crane.links[2]), cylinders=(main,))
    found = [str(problem) for problem in design.check(bad)]
    assert len(found) == 4
    assert found[0].startswith("links[boom].mass: must be above 0")
    assert found[1].startswith("links[boom].com[0]: must be a finite number")
    assert found[2].startswith("cylinders[boom_cylinder].bore: must be a number in m")
    assert found[3].endswith("did you mean 280 bar?")


def test_numpy_numbers_are_numbers(crane):
    bulk = msgspec.structs.replace(crane, bulk_modulus=np.float64(1.1e9))
    assert design.check(bulk) == []
    assert design.loads(design.to_json(bulk)) == bulk


def test_a_crane_is_frozen(crane):
    with pytest.raises(AttributeError):
        crane.name = "other"
    with pytest.raises(KeyError, match="no link 'bom'"):
        crane.link("bom")
