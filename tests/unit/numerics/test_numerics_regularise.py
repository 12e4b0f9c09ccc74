import casadi as ca
import numpy as np
import pytest

from seacrane.numerics.regularise import (
    limit,
    maximum,
    minimum,
    piecewise_linear,
    positive_part,
    signed_sqrt,
    smooth_limit,
    smooth_sign,
)

X = np.concatenate([np.linspace(-4, 4, 4001), [0.0, 1e-9, -1e-9, 1e6, -1e6]])


def slope(f, at):
    x = ca.SX.sym("x")
    return float(ca.Function("slope", [x], [ca.jacobian(f(x), x)])(at))


def test_signed_sqrt_is_within_its_stated_error_of_the_root():
    transition = 0.3
    error = np.sign(X) * np.sqrt(abs(X)) - signed_sqrt(X, transition)
    assert (error * np.sign(X) >= 0).all()
    assert abs(error).max() < 0.255 * transition**0.5
    far = abs(X) > 0
    assert (abs(error[far]) <= (transition / X[far]) ** 2 / 4 * abs(X[far]) ** 0.5 + 1e-12).all()


def test_signed_sqrt_crosses_zero_with_its_stated_slope():
    assert signed_sqrt(0.0, 1e4) == 0.0
    assert slope(lambda x: signed_sqrt(x, 1e4), 0.0) == pytest.approx(1e-2)


def test_smooth_sign_is_within_its_stated_error_of_the_sign():
    width = 0.1
    away = abs(X) > 1e-6
    error = abs(np.sign(X[away]) - smooth_sign(X[away], width))
    assert (error <= (width / X[away]) ** 2 / 2).all()
    assert slope(lambda x: smooth_sign(x, width), 0.0) == pytest.approx(1 / width)


def test_positive_part_is_exact_away_from_zero_and_never_negative():
    width = 0.5
    error = positive_part(X, width) - np.maximum(X, 0)
    assert (error[abs(X) >= width] == 0).all()
    assert error.max() == pytest.approx(width / 4) == positive_part(0.0, width)
    assert (positive_part(X, width) >= 0).all()


def test_positive_part_has_a_continuous_slope():
    width = 0.5
    for x in (-width, -0.2, 0.0, 0.2, width):
        expected = (x + width) / (2 * width)
        for near in (x - 1e-9, x, x + 1e-9):
            assert slope(lambda s: positive_part(s, width), near) == pytest.approx(expected, abs=1e-7)


def test_smooth_limit_is_exact_between_and_beyond_its_rounded_corners():
    values = smooth_limit(X, -1.0, 2.0, 0.1)
    exact = np.clip(X, -1, 2)
    rounded = (abs(X + 1) < 0.1) | (abs(X - 2) < 0.1)
    assert values[~rounded] == pytest.approx(exact[~rounded], abs=1e-9)
    assert abs(values - exact).max() == pytest.approx(0.1 / 4, rel=1e-3)


def test_sharp_limits_are_exact():
    assert minimum(X, 0.5) == pytest.approx(np.minimum(X, 0.5), abs=1e-9)
    assert maximum(X, 0.5) == pytest.approx(np.maximum(X, 0.5), abs=1e-9)
    assert limit(X, -1.0, 2.0) == pytest.approx(np.clip(X, -1, 2), abs=1e-9)


def test_a_sharp_limit_has_the_mean_slope_at_its_corner():
    assert slope(lambda x: limit(x, 0.0, 1.0), 0.0) == 0.5
    assert slope(lambda x: limit(x, 0.0, 1.0), 0.5) == 1.0
    assert slope(lambda x: limit(x, 0.0, 1.0), 2.0) == 0.0


def test_piecewise_linear_passes_through_its_points_and_stays_beyond_them():
    points = [(-1.0, 3.0), (0.0, -2.0), (2.0, 0.5)]
    xs, ys = zip(*points, strict=True)
    assert piecewise_linear(X, points) == pytest.approx(np.interp(X, xs, ys), abs=1e-9)
    assert slope(lambda x: piecewise_linear(x, points), 1.0) == pytest.approx(1.25)


@pytest.mark.parametrize(
    "function",
    [
        lambda x: signed_sqrt(x, 0.1),
        lambda x: smooth_sign(x, 0.1),
        lambda x: positive_part(x, 0.1),
        lambda x: smooth_limit(x, -1.0, 1.0, 0.1),
        lambda x: limit(x, -1.0, 1.0),
        lambda x: piecewise_linear(x, [(0.0, 0.0), (1.0, 2.0)]),
    ],
)
def test_one_definition_serves_numbers_arrays_and_symbols(function):
    x = ca.SX.sym("x")
    symbolic = ca.Function("f", [x], [function(x)])
    array = function(X)
    for value, expected in zip(X[::371], array[::371], strict=True):
        assert function(float(value)) == expected
        assert float(symbolic(value)) == pytest.approx(expected, rel=1e-14, abs=1e-14)
