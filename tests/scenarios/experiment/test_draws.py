"""Random variables: their distributions, how flights are drawn, and what is refused."""

from collections import Counter

import pytest
from scipy import stats

from scenarios.errors import InputError
from scenarios.experiment.draws import check_draws, sampled_flight, speed_ratios, value_at
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import DrawConfig

SPEED = 19.42


def scenario(**changes):
    """Return a kinematic scenario: a vessel at 8 m/s in calm air unless ``changes`` say otherwise."""
    base = {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}}
    return Scenario.model_validate(base | changes)


WINDS = (
    {"key": "wind.speed_mps", "uniform": [2.0, 6.0]},
    {"key": "wind.from_deg", "uniform": [0.0, 360.0]},
    {"key": "fault.kind", "choice": ["none", "vessel_data", "satellite_navigation"]},
)


def test_a_flight_is_drawn_by_the_trials_seed_its_name_and_its_number_alone():
    trial = scenario(draws=WINDS)
    again = sampled_flight("trial", trial, 5)
    assert sampled_flight("trial", trial, 5) == again
    others = [
        sampled_flight("trial", trial, 6),
        sampled_flight("other", trial, 5),
        sampled_flight("trial", scenario(draws=WINDS, seed=2), 5),
    ]
    assert len({drawn.scenario.wind.from_deg for drawn in [again, *others]}) == 4
    assert len({drawn.seed for drawn in [again, *others]}) == 4
    more = sampled_flight("trial", scenario(draws=WINDS, flights=1000), 5)
    assert more.scenario.wind == again.scenario.wind
    wind, fault = again.scenario.wind, again.scenario.fault
    assert list(again.values.values()) == [wind.speed_mps, wind.from_deg, fault.kind]


def test_flights_keep_to_their_speed_ratios_also_after_a_manoeuvre():
    turn = {"at_s": 100.0, "turn_deg": 180.0, "turn_rate_deg_s": 1.0}
    draws = [{"key": "wind.speed_mps", "uniform": [0.0, 10.0]}]
    vessel = {"speed_mps": 8.0, "manoeuvres": [turn]}
    trial = scenario(speed_ratio=[0.3, 0.5], draws=draws, vessel=vessel)
    for number in range(5):
        drawn = sampled_flight("trial", trial, number)
        wind, (least, greatest) = drawn.scenario.wind.speed_mps, speed_ratios(drawn.scenario)
        # Against the wind before it turns round, and with it after.
        assert greatest == pytest.approx((8.0 + wind) / SPEED)
        assert least == pytest.approx(abs(8.0 - wind) / SPEED)
        assert 0.3 <= least <= greatest <= 0.5


def test_what_is_drawn_is_distributed_as_was_said():
    trial = scenario(
        draws=[
            {"key": "wind.speed_mps", "weibull": [2.0, 4.0], "within": [0.0, 9.0]},
            {"key": "vessel.course_deg", "normal": [90.0, 20.0]},
            {"key": "wind.from_deg", "uniform": [0.0, 360.0]},
            {"key": "fault.kind", "choice": ["none", "vessel_data"]},
        ]
    )
    flights = [sampled_flight("trial", trial, number).scenario for number in range(400)]
    cut = stats.weibull_min(2.0, scale=4.0)
    # Kolmogorov's test; of samples that are what they should be, one in a thousand has less, and
    # these are always the same.
    for drawn, distribution in (
        ([flight.wind.speed_mps for flight in flights], lambda x: cut.cdf(x) / cut.cdf(9.0)),
        ([flight.vessel.course_deg for flight in flights], stats.norm(90.0, 20.0).cdf),
        ([flight.wind.from_deg for flight in flights], stats.uniform(0.0, 360.0).cdf),
    ):
        assert stats.kstest(drawn, distribution).pvalue > 1e-3
    # Choices are dealt equally.
    assert Counter(flight.fault.kind for flight in flights) == {"none": 200, "vessel_data": 200}


def test_a_key_within_a_list_is_drawn_and_the_rest_of_the_list_stays():
    draw = {"key": "vessel.manoeuvres.1.turn_deg", "uniform": [30.0, 60.0]}
    turns = [{"at_s": 50.0, "turn_deg": 10.0}, {"at_s": 150.0, "turn_deg": 20.0}]
    trial = scenario(vessel={"speed_mps": 8.0, "manoeuvres": turns}, draws=[draw])
    check_draws("trial", trial)
    turns = []
    for number in range(5):
        drawn = sampled_flight("trial", trial, number)
        first, second = drawn.scenario.vessel.manoeuvres
        assert first == trial.vessel.manoeuvres[0]
        assert second.at_s == 150.0
        assert 30.0 <= second.turn_deg == drawn.values[draw["key"]] <= 60.0
        turns.append(second.turn_deg)
    assert len(set(turns)) == 5


def uniform(key, *within):
    return {"key": key, "uniform": [*within]}


# Some 4e-12 of it lies beyond 41 m/s: rounding takes a little from the limit.
BEYOND = {"key": "wind.speed_mps", "weibull": [2.0, 8.0], "within": [0.0, 41.0]}


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        (uniform("wind.sped_mps", 0.0, 1.0), "unknown key 'wind.sped_mps'"),
        (uniform("vessel.speed_mps", -5.0, 10.0), "vessel.speed_mps is -5.0"),
        ({"key": "title.first", "choice": ["a"]}, "'title' is a value, not a section"),
        (BEYOND, "wind.speed_mps is 40.9999"),
        (uniform("vessel.manoeuvres.first.turn_deg", 0.0, 9.0), "vessel.manoeuvres has 0 entries"),
    ],
)
def test_what_cannot_be_drawn_is_refused_before_anything_is_flown(draw, words):
    with pytest.raises(InputError, match=words) as refused:
        check_draws("trial", scenario(draws=[draw]))
    assert "\n" not in str(refused.value)


SHARES = (1e-6, 0.01, 0.2, 0.5, 0.8, 0.99, 1.0 - 1e-6)


RAYLEIGH = stats.weibull_min(2.0, scale=8.0)
"""Shape 2 is that of winds at sea, nearly (Hellmann)."""


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
        ({"weibull": (2.0, 8.0)}, RAYLEIGH.ppf),
        ({"weibull": (1.7, 9.5)}, stats.weibull_min(1.7, scale=9.5).ppf),
        ({"normal": (8.0, 2.0), "within": (5.0, 9.0)}, stats.truncnorm(-1.5, 0.5, 8.0, 2.0).ppf),
        # Cut off on one side of its mean.
        ({"normal": (8.0, 2.0), "within": (10.0, 14.0)}, stats.truncnorm(1.0, 3.0, 8.0, 2.0).ppf),
        ({"weibull": (2.0, 8.0), "within": (3.0, 12.0)}, below(RAYLEIGH, (3.0, 12.0))),
        # Nothing of it lies below 0.
        ({"weibull": (2.0, 8.0), "within": (-5.0, 12.0)}, below(RAYLEIGH, (0.0, 12.0))),
    ],
)
def test_a_value_is_the_quantile_of_its_share(values, quantile):
    draw = DrawConfig(key="wind.speed_mps", **values)
    # Both invert by series that are good to some 1e-14 of the quantile; a share near 1 has
    # 1e-16/1e-6 of its complement.
    expected = [float(quantile(share)) for share in SHARES]
    assert [value_at(draw, share) for share in SHARES] == pytest.approx(expected, rel=1e-9)
    # Rounding of a share, 1e-16, is 3e-7 where the density begins at 0.
    if low_high := values.get("within", values.get("uniform")):
        ends = max(low_high[0], 0.0), low_high[1]
        assert (value_at(draw, 0.0), value_at(draw, 1.0)) == pytest.approx(ends, abs=1e-6)


def test_a_choice_takes_as_much_of_its_distribution_as_it_weighs():
    weighed = DrawConfig(key="fault.kind", choice=("a", "b", "c"), weights=(2.0, 0.0, 2.0))
    assert [value_at(weighed, share) for share in (0.0, 0.49, 0.5, 1.0)] == ["a", "a", "c", "c"]
    alike = DrawConfig(key="fault.kind", choice=("a", "b", "c"))
    found = [value_at(alike, share) for share in (0.0, 0.33, 0.34, 0.66, 0.67, 1.0)]
    assert found == ["a", "a", "b", "b", "c", "c"]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({}, "has none of uniform, normal, weibull and choice; give one"),
        ({"uniform": [1.0, 0.0]}, "its first value must not exceed"),
        ({"uniform": [0.0, 1.0], "within": [0.0, 1.0]}, "it cuts off normal or weibull"),
        ({"weibull": [0.0, 8.0]}, "greater than 0"),
        ({"choice": [1.0, 2.0], "weights": [1e308, 1e308]}, "give each choice one, with a sum"),
    ],
)
def test_a_distribution_that_makes_no_sense_is_refused(values, words):
    with pytest.raises(ValueError, match=words):
        DrawConfig(key="wind.speed_mps", **values)
