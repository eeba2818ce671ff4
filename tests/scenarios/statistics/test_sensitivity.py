"""Which inputs drive a figure: cases whose indices are known, and data that has none."""

import numpy as np
import pandas as pd
import pytest

from scenarios.statistics.sensitivity import first_order_index, sensitivity_indices


def words_and_noise(flights=400):
    """Return a category that moves a uniform figure by more than its width, an input that does
    nothing, and the figure.
    """
    generator = np.random.default_rng(5)
    level = generator.choice(["light", "severe"], flights)
    direction = generator.uniform(0.0, 360.0, flights)
    inputs = pd.DataFrame({"turbulence.level": level, "wind.from_deg": direction})
    return inputs, 2.0 * (level == "severe") + generator.uniform(size=flights)


@pytest.fixture(scope="module", autouse=True)
def few_resamples():
    """Make 8 bootstraps instead of 20: they take nearly all of the time."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("scenarios.statistics.sensitivity.RESAMPLES", 8)
        yield


@pytest.fixture(scope="module")
def found():
    return sensitivity_indices(*words_and_noise(), confidence=0.95, seed=1)


def test_a_category_that_parts_the_figure_in_two_has_the_indices_that_follow_from_their_definitions(
    found,
):
    driver, _ = found.inputs
    assert driver.key == "turbulence.level"
    # Two densities that do not meet, each 1 wide: either is 1/2 away from their mean over both
    # supports, so delta is 1/2. The densities are smoothed by kernels some tenth wide, whose tails
    # beyond either support are some hundredths of it.
    assert driver.delta == pytest.approx(0.5, abs=0.03)
    # The means lie 2 apart, variance 1, of 1 + 1/12 in all. The variance within, 1/12, is known
    # from 400 flights to 4.5 %.
    assert driver.first_order == pytest.approx(12.0 / 13.0, abs=3.0 * 0.045 / 13.0)


def test_a_sum_of_two_inputs_has_their_shares_of_the_variance():
    generator = np.random.default_rng(6)
    speeds = {name: generator.uniform(size=800) for name in ("wind.speed_mps", "vessel.speed_mps")}
    inputs = pd.DataFrame(speeds)
    found = sensitivity_indices(inputs, inputs.to_numpy() @ [2.0, 1.0], confidence=0.95, seed=1)
    assert [index.key for index in found.inputs] == ["wind.speed_mps", "vessel.speed_mps"]
    # Variances are 4/12 and 1/12. Classes, six of 133 flights here, hide 1/36 of an input's
    # variance and add 1/133 of the other's; shares of 800 flights have a deviation of some 0.02.
    assert [index.first_order for index in found.inputs] == pytest.approx([0.8, 0.2], abs=0.06)


def test_inputs_that_say_nothing_are_left_out_with_the_reason_and_the_others_stay(found):
    inputs, figure = words_and_noise(250)
    inputs["keepout.radius_m"] = 200.0
    inputs["reports.missing"] = np.where(np.arange(250) < 100, np.nan, inputs["wind.from_deg"])
    left = sensitivity_indices(inputs, figure, confidence=0.95, seed=1)
    assert left.left_out == {
        "keepout.radius_m": "the same in every flight",
        "reports.missing": "not sampled for every flight",
    }
    assert [index.key for index in left.inputs] == [index.key for index in found.inputs]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda inputs, figure: (inputs.head(199), figure[:199]), "199 flights have this figure"),
        (lambda inputs, figure: (inputs, figure * np.nan), "0 flights have this figure"),
        (lambda inputs, figure: (inputs, figure * 0.0 + 3.7), "the figure is the same in every"),
        (lambda inputs, figure: (inputs[[]], figure), "no input differs between flights"),
        # A single flight apart: some bootstrap sample misses it, and has no density.
        (lambda inputs, figure: (inputs, 1.0 * (figure == figure.max())), "too few flights differ"),
    ],
)
def test_where_there_are_no_indices_the_reason_is_given(change, message):
    found = sensitivity_indices(*change(*words_and_noise()), confidence=0.95, seed=1)
    assert found.message.startswith(message)
    assert found.inputs == ()
    assert np.isnan(found.delta_floor)


REPEATS = 100
"""Samples of each model: a share of 95 % is known to 2.2 %."""

FLIGHTS = 300


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


@pytest.mark.slow
@pytest.mark.parametrize("model", [ishigami, g_function, parabola, jump])
def test_intervals_hold_the_true_index_and_indices_have_no_bias(model):
    generator = np.random.default_rng(FLIGHTS)
    errors, widths = [], []
    for _ in range(REPEATS):
        inputs, figure, true = model(generator, FLIGHTS)
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


@pytest.mark.slow
def test_an_interval_is_as_narrow_as_the_efficient_estimators():
    # 1 - R/T of normal residuals and a normal figure: Var(S1) = 4 S1 (1 - S1)^2 (1 + ...)/n; for Y
    # = X + E the influence is e^2/2 - y^2/4, of variance 1/2 + 1/2 - 2 (1/8) 2 = 1/2.
    generator = np.random.default_rng(3)
    x, noise = generator.standard_normal((2, 4000))
    found = first_order_index(x, x + noise, confidence=0.95)
    # 5 %: the price of the spline is 1 %, the sum of 4,000 squares is known to some 4 %.
    assert found.half_width == pytest.approx(1.960 * np.sqrt(0.5 / 4000.0), rel=0.08)


@pytest.mark.slow
def test_a_figure_that_few_flights_decide_on_has_a_wide_interval_that_holds():
    held, widths = [], []
    generator = np.random.default_rng(8)
    # Lognormal with exponents 1.5 and 1: kurtosis 30,000. Variance of each factor, exp(s^2) - 1.
    true = (np.exp(2.25) - 1.0) / (np.exp(3.25) - 1.0)
    for _ in range(100):
        x = generator.standard_normal((300, 2))
        found = first_order_index(x[:, 0], np.exp(x @ [1.5, 1.0]), confidence=0.95)
        held.append(abs(found.index - true) <= found.half_width)
        widths.append(found.half_width)
    # A share of 95 % of 100 scatters by 2.2 %; with a normal quantile 78 % were held.
    assert np.mean(held) > 0.88
    assert np.max(widths) <= 1.0
