"""First-order indices against closed forms: bias, and how often intervals hold the true index."""

import numpy as np
import pytest

from scenarios.statistics.sensitivity import first_order_index

pytestmark = pytest.mark.slow

REPEATS = 100
"""Samples of each model and size: a share of 95 % is known to 2.2 %."""


def ishigami(generator, flights):
    """T. Ishigami and T. Homma 1990 with a = 7, b = 0.1; variances as in the SALib documentation."""
    x = generator.uniform(-np.pi, np.pi, (flights, 3))
    figure = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    of_each = np.array([0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 0.0])
    return x, figure, of_each / (of_each.sum() + 0.01 * np.pi**8 * 8.0 / 225.0)


def g_function(generator, flights):
    """Sobol's g-function: each factor has mean 1 and variance 1/3/(1 + a)^2."""
    a = np.array([0.0, 1.0, 4.5, 99.0])
    x = generator.random((flights, len(a)))
    of_each = 1.0 / 3.0 / (1.0 + a) ** 2
    figure = np.prod((np.abs(4.0 * x - 2.0) + a) / (1.0 + a), axis=1)
    return x, figure, of_each / (np.prod(1.0 + of_each) - 1.0)


def linear(generator, flights):
    """Sum of normal inputs: shares are those of the squared coefficients."""
    coefficients = np.array([4.0, 2.0, 0.5, 0.0])
    x = generator.standard_normal((flights, len(coefficients)))
    return x, x @ coefficients, coefficients**2 / np.sum(coefficients**2)


def parabola(generator, flights):
    """6 (x - 1/2)^2, of variance 36/180, with a noise of 1 % of that: one input has all but it."""
    x = generator.random((flights, 1))
    noise = np.sqrt(0.01 * 0.2) * generator.standard_normal(flights)
    return x, 6.0 * (x[:, 0] - 0.5) ** 2 + noise, np.array([1.0 / 1.01])


def jump(generator, flights):
    """A jump of 1 at 0.3, of variance 0.3 0.7, with a noise of 0.3."""
    x = generator.random((flights, 1))
    figure = (x[:, 0] > 0.3) + 0.3 * generator.standard_normal(flights)
    return x, figure, np.array([0.21 / (0.21 + 0.09)])


@pytest.mark.parametrize(
    ("model", "flights"),
    [
        (ishigami, 300),
        (g_function, 300),
        (linear, 300),
        (parabola, 300),
        (jump, 300),
        (ishigami, 1000),
    ],
)
def test_intervals_hold_the_true_index_and_indices_have_no_bias(model, flights):
    generator = np.random.default_rng(flights)
    errors, widths = [], []
    for _ in range(REPEATS):
        inputs, figure, true = model(generator, flights)
        found = [first_order_index(x, figure, confidence=0.95) for x in inputs.T]
        errors.append([index.index for index in found] - true)
        widths.append([index.half_width for index in found])
    held = np.mean(np.abs(errors) <= widths, axis=0)
    # Stated are 95 %, and 400 samples of each held at least 93 %; of 100 the share scatters by 2.2
    # %. Classes of an input held a dominant one in 0 to 57 %.
    assert np.all(held >= 0.88), held
    # The bias is a small part of an interval: a jump, which no spline follows, has the largest, a
    # quarter of it.
    assert np.all(np.abs(np.mean(errors, axis=0)) < 0.35 * np.mean(widths, axis=0))


def test_an_interval_is_as_narrow_as_the_efficient_estimators():
    # 1 - R/T of normal residuals and a normal figure: Var(S1) = 4 S1 (1 - S1)^2 (1 + ...)/n; for Y
    # = X + E the influence is e^2/2 - y^2/4, of variance 1/2 + 1/2 - 2 (1/8) 2 = 1/2.
    generator = np.random.default_rng(3)
    x, noise = generator.standard_normal((2, 4000))
    found = first_order_index(x, x + noise, confidence=0.95)
    # 5 %: the price of the spline is 1 %, the sum of 4,000 squares is known to some 4 %.
    assert found.half_width == pytest.approx(1.960 * np.sqrt(0.5 / 4000.0), rel=0.08)


def test_a_scale_and_an_origin_change_nothing():
    generator = np.random.default_rng(6)
    x, y, _ = ishigami(generator, 400)
    plain = first_order_index(x[:, 1], y, confidence=0.95)
    moved = first_order_index(1e6 + 1e-3 * x[:, 1], 1e4 - 50.0 * y, confidence=0.95)
    # A thousandth of a spread at 1e6 keeps 7 digits of the input.
    assert moved.index == pytest.approx(plain.index, abs=1e-5)
    assert moved.half_width == pytest.approx(plain.half_width, abs=1e-5)


def test_a_figure_that_few_flights_decide_on_has_a_wide_interval_that_holds():
    held, widths = [], []
    generator = np.random.default_rng(8)
    # Lognormal with exponents 1.5 and 1: kurtosis 30,000. Variance of each factor, exp(s^2) - 1.
    true = (np.exp(2.25) - 1.0) / (np.exp(3.25) - 1.0)
    for _ in range(200):
        x = generator.standard_normal((300, 2))
        found = first_order_index(x[:, 0], np.exp(x @ [1.5, 1.0]), confidence=0.95)
        held.append(abs(found.index - true) <= found.half_width)
        widths.append(found.half_width)
    # A share of 95 % of 200 scatters by 1.5 %; with a normal quantile 78 % were held.
    assert np.mean(held) > 0.88
    assert np.max(widths) <= 1.0
