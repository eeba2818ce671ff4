"""Distributions of random variables: their quantiles, and which are refused."""

import numpy as np
import pytest
from scipy import stats

from scenarios.experiment.draws import value_at
from scenarios.scenario.sections.experiment import DrawConfig

SHARES = (1e-6, 0.01, 0.2, 0.5, 0.8, 0.99, 1.0 - 1e-6)


def below(distribution, within):
    """Return the quantiles of a distribution that is cut off, by its definition: what lies between,
    counted as the whole.
    """
    low, high = distribution.cdf(within)
    return lambda share: distribution.ppf(low + (high - low) * share)


@pytest.mark.parametrize(
    ("values", "quantile"),
    [
        ({"uniform": (2.0, 6.0)}, stats.uniform(2.0, 4.0).ppf),
        ({"normal": (8.0, 2.0)}, stats.norm(8.0, 2.0).ppf),
        # Hellmann: shape 2 is Rayleigh's, as winds at sea nearly have it.
        ({"weibull": (2.0, 8.0)}, stats.weibull_min(2.0, scale=8.0).ppf),
        ({"weibull": (1.7, 9.5)}, stats.weibull_min(1.7, scale=9.5).ppf),
        ({"normal": (8.0, 2.0), "within": (5.0, 9.0)}, stats.truncnorm(-1.5, 0.5, 8.0, 2.0).ppf),
        # Cut off on one side of its mean.
        ({"normal": (8.0, 2.0), "within": (10.0, 14.0)}, stats.truncnorm(1.0, 3.0, 8.0, 2.0).ppf),
        (
            {"weibull": (2.0, 8.0), "within": (3.0, 12.0)},
            below(stats.weibull_min(2.0, scale=8.0), (3.0, 12.0)),
        ),
        # Nothing of it lies below 0.
        (
            {"weibull": (2.0, 8.0), "within": (-5.0, 12.0)},
            below(stats.weibull_min(2.0, scale=8.0), (0.0, 12.0)),
        ),
    ],
)
def test_a_value_is_the_quantile_of_its_share(values, quantile):
    draw = DrawConfig(key="wind.speed_mps", **values)
    # Both invert by series that are good to some 1e-14 of the quantile; a share near 1 has
    # 1e-16/1e-6 of its complement.
    assert [value_at(draw, share) for share in SHARES] == pytest.approx(
        [float(quantile(share)) for share in SHARES], rel=1e-9
    )


@pytest.mark.parametrize(
    ("values", "ends"),
    [
        ({"uniform": (2.0, 6.0)}, (2.0, 6.0)),
        ({"normal": (8.0, 2.0), "within": (5.0, 9.0)}, (5.0, 9.0)),
        ({"weibull": (2.0, 8.0), "within": (3.0, 12.0)}, (3.0, 12.0)),
    ],
)
def test_what_has_limits_begins_and_ends_there(values, ends):
    draw = DrawConfig(key="wind.speed_mps", **values)
    # At the ends the quantile's slope is at most 1/density, some 30 here: rounding of a share,
    # 1e-16, is 1e-14.
    assert (value_at(draw, 0.0), value_at(draw, 1.0)) == pytest.approx(ends, abs=1e-12)
    assert all(ends[0] <= value_at(draw, share) <= ends[1] for share in np.linspace(0.0, 1.0, 101))


def test_a_choice_takes_as_much_of_its_distribution_as_it_weighs():
    weighed = DrawConfig(key="fault.kind", choice=("a", "b", "c"), weights=(2.0, 0.0, 2.0))
    assert [value_at(weighed, share) for share in (0.0, 0.49, 0.5, 1.0)] == ["a", "a", "c", "c"]
    alike = DrawConfig(key="fault.kind", choice=("a", "b", "c"))
    assert [value_at(alike, share) for share in (0.0, 0.33, 0.34, 0.66, 0.67, 1.0)] == [
        "a",
        "a",
        "b",
        "b",
        "c",
        "c",
    ]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "has none of uniform, normal, weibull and choice; give one"),
        (
            {"uniform": [1.0, 0.0]},
            "uniform of the draw of 'wind.speed_mps' is .* its first value must not exceed",
        ),
        (
            {"uniform": [0.0, 1.0], "within": [0.0, 1.0]},
            "has within beside uniform; it cuts off normal or weibull",
        ),
        ({"weibull": [0.0, 8.0]}, "greater than 0"),
        (
            {"choice": [1.0, 2.0], "weights": [1e308, 1e308]},
            "give each choice one, with a sum above 0",
        ),
        ({"choice": [1.0, 2.0], "weights": [-1.0, 2.0]}, "greater than or equal to 0"),
    ],
)
def test_a_distribution_that_makes_no_sense_is_refused(values, words):
    with pytest.raises(ValueError, match=words):
        DrawConfig(key="wind.speed_mps", **values)
