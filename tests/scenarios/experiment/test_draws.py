from collections import Counter

import pytest
from scipy import stats

from scenarios.errors import InputError
from scenarios.experiment.draws import check_draws, sampled_flight, speed_ratios
from scenarios.scenario.scenario import Scenario

SPEED = 19.42


def scenario(**changes):
    """Return a kinematic scenario: a vessel at 8 m/s in calm air unless ``changes`` say otherwise."""
    return Scenario.model_validate(
        {"title": "test", "fidelity": "kinematic", "vessel": {"speed_mps": 8.0}} | changes
    )


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
        # More flights than before change none of them.
    ]
    assert len({drawn.scenario.wind.from_deg for drawn in [again, *others]}) == 4
    assert len({drawn.seed for drawn in [again, *others]}) == 4
    assert (
        sampled_flight("trial", scenario(draws=WINDS, flights=1000), 5).scenario.wind
        == again.scenario.wind
    )
    # What was drawn is what was set.
    assert again.values == {
        "wind.speed_mps": again.scenario.wind.speed_mps,
        "wind.from_deg": again.scenario.wind.from_deg,
        "fault.kind": again.scenario.fault.kind,
    }


def test_draws_stay_within_their_ranges_and_choices_are_dealt_equally():
    trial = scenario(draws=WINDS, flight={"duration_max_s": 300.0})
    flights = [sampled_flight("trial", trial, number).scenario for number in range(60)]
    speeds = [flight.wind.speed_mps for flight in flights]
    assert 2.0 <= min(speeds) < 3.0
    assert 5.0 < max(speeds) <= 6.0
    assert Counter(flight.fault.kind for flight in flights) == {
        "none": 20,
        "vessel_data": 20,
        "satellite_navigation": 20,
    }


def test_flights_keep_to_their_speed_ratios_also_after_a_manoeuvre():
    trial = scenario(
        speed_ratio=[0.3, 0.5],
        draws=[{"key": "wind.speed_mps", "uniform": [0.0, 10.0]}],
        vessel={
            "speed_mps": 8.0,
            "manoeuvres": [{"at_s": 100.0, "turn_deg": 180.0, "turn_rate_deg_s": 1.0}],
        },
    )
    for number in range(5):
        drawn = sampled_flight("trial", trial, number)
        wind, (least, greatest) = drawn.scenario.wind.speed_mps, speed_ratios(drawn.scenario)
        # Against the wind before it turns round, and with it after.
        assert greatest == pytest.approx((8.0 + wind) / SPEED)
        assert least == pytest.approx(abs(8.0 - wind) / SPEED)
        assert 0.3 <= least <= greatest <= 0.5


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        ({"key": "wind.sped_mps", "uniform": [0.0, 1.0]}, "unknown key 'wind.sped_mps'"),
        ({"key": "vessel.speed_mps", "uniform": [-5.0, 10.0]}, "vessel.speed_mps is -5.0"),
        ({"key": "title.first", "choice": ["a"]}, "'title' is a value, not a section"),
        # Some 4e-12 of it lies beyond 41 m/s: rounding takes a little from the limit.
        (
            {"key": "wind.speed_mps", "weibull": [2.0, 8.0], "within": [0.0, 41.0]},
            "wind.speed_mps is 40.9999",
        ),
        (
            {"key": "vessel.manoeuvres.first.turn_deg", "uniform": [-90.0, 90.0]},
            "unknown key 'vessel.manoeuvres.first.turn_deg'; vessel.manoeuvres has 0 entries",
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused_before_anything_is_flown(draw, words):
    with pytest.raises(InputError, match=words) as refused:
        check_draws("trial", scenario(draws=[draw]))
    assert "\n" not in str(refused.value)


def test_what_is_drawn_is_distributed_as_was_said():
    trial = scenario(
        draws=[
            {"key": "wind.speed_mps", "weibull": [2.0, 4.0], "within": [0.0, 9.0]},
            {"key": "vessel.course_deg", "normal": [90.0, 20.0]},
            {"key": "wind.from_deg", "uniform": [0.0, 360.0]},
        ],
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


MANOEUVRES = {
    "speed_mps": 8.0,
    "manoeuvres": [{"at_s": 50.0, "turn_deg": 10.0}, {"at_s": 150.0, "turn_deg": 20.0}],
}


def test_a_key_within_a_list_is_drawn_and_the_rest_of_the_list_stays():
    draw = {"key": "vessel.manoeuvres.1.turn_deg", "uniform": [30.0, 60.0]}
    trial = scenario(vessel=MANOEUVRES, draws=[draw])
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
