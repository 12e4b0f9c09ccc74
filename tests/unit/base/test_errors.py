from seacrane.errors import DesignError, Problem, SeacraneError, nearest


def test_an_error_lists_all_its_problems():
    error = DesignError(
        [Problem("crane.mass", "must be positive", -1.0, "above 0 kg"), Problem("crane.x", "is unknown")]
    )
    assert str(error) == "crane.mass: must be positive (got -1.0); allowed: above 0 kg\ncrane.x: is unknown"
    assert isinstance(error, SeacraneError)
    assert error.code == "design"


def test_the_nearest_names_come_first_and_all_names_otherwise():
    assert nearest("presure", ["pressure", "flow"]) == "Did you mean 'pressure'?"
    assert nearest("xyz", ["pressure", "flow"]) == "Known: flow, pressure."
    assert nearest("xyz", []) == "There is none here."
