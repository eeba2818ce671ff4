"""Which inputs drive a figure: cases whose indices are known, and data that has none."""

import numpy as np
import pandas as pd
import pytest

from scenarios.statistics.sensitivity import sensitivity_indices


def words_and_noise(flights=400):
    """Return a category that moves a uniform figure by more than its width, an input that does
    nothing, and the figure.
    """
    generator = np.random.default_rng(5)
    level = generator.choice(["light", "severe"], flights)
    inputs = pd.DataFrame(
        {"turbulence.level": level, "wind.from_deg": generator.uniform(0.0, 360.0, flights)}
    )
    return inputs, 2.0 * (level == "severe") + generator.uniform(size=flights)


@pytest.fixture(scope="module", autouse=True)
def few_resamples():
    """Make 8 bootstraps instead of 20: they take nearly all of the time, and an index hardly hangs
    on their number.
    """
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
    inputs = pd.DataFrame(
        {
            "wind.speed_mps": generator.uniform(size=800),
            "vessel.speed_mps": generator.uniform(size=800),
        }
    )
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
        (
            lambda inputs, figure: (inputs.head(199), figure[:199]),
            "199 flights have this figure; indices take 200 at least",
        ),
        (lambda inputs, figure: (inputs, figure * np.nan), "0 flights have this figure"),
        (
            lambda inputs, figure: (inputs, figure * 0.0 + 3.7),
            "the figure is the same in every flight",
        ),
        (lambda inputs, figure: (inputs[[]], figure), "no input differs between flights"),
        # A single flight apart: some bootstrap sample misses it, and has no density.
        (
            lambda inputs, figure: (inputs, np.where(figure == figure.max(), 1.0, 0.0)),
            "too few flights differ in this figure",
        ),
    ],
)
def test_where_there_are_no_indices_the_reason_is_given(change, message):
    found = sensitivity_indices(*change(*words_and_noise()), confidence=0.95, seed=1)
    assert found.message.startswith(message)
    assert found.inputs == ()
    assert np.isnan(found.delta_floor)
