from collections import Counter

import pytest
from sea_cases import SPEED, scenario

from scenarios.errors import InputError
from scenarios.sea_draws import check_draws, drawn_flight

WINDS = (
    {"key": "wind.speed_mps", "uniform": [2.0, 6.0]},
    {"key": "wind.from_deg", "uniform": [0.0, 360.0]},
    {"key": "fault.kind", "choice": ["none", "vessel_data", "satellite_navigation"]},
)


def test_a_flight_is_drawn_by_the_trials_seed_its_name_and_its_number_alone():
    trial = scenario(draws=WINDS)
    again = drawn_flight("trial", trial, 5)
    assert drawn_flight("trial", trial, 5) == again
    others = [
        drawn_flight("trial", trial, 6),
        drawn_flight("other", trial, 5),
        drawn_flight("trial", scenario(draws=WINDS, seed=2), 5),
        # More flights than before change none of them.
    ]
    assert len({flight.wind.from_deg for flight, _, _ in [again, *others]}) == 4
    assert len({seed for _, seed, _ in [again, *others]}) == 4
    assert drawn_flight("trial", scenario(draws=WINDS, flights=1000), 5)[0].wind == again[0].wind


def test_draws_stay_within_their_ranges_and_choices_are_dealt_equally():
    trial = scenario(draws=WINDS, flight={"duration_max_s": 300.0})
    flights = [drawn_flight("trial", trial, number)[0] for number in range(60)]
    speeds = [flight.wind.speed_mps for flight in flights]
    assert 2.0 <= min(speeds) < 3.0
    assert 5.0 < max(speeds) <= 6.0
    assert Counter(flight.fault.kind for flight in flights) == {"none": 20, "vessel_data": 20, "satellite_navigation": 20}


def test_a_flight_knows_its_speed_ratio():
    # 8 m/s north against 4 m/s from the north: 12 m/s through the air.
    flight = scenario(wind={"speed_mps": 4.0, "from_deg": 0.0})
    assert drawn_flight("trial", flight, 0)[2] == pytest.approx(12.0 / SPEED)


def test_flights_keep_to_their_speed_ratios_also_after_a_manoeuvre():
    trial = scenario(
        speed_ratio=[0.3, 0.5],
        draws=[{"key": "wind.speed_mps", "uniform": [0.0, 10.0]}],
        vessel={"speed_mps": 8.0, "manoeuvres": [{"at_s": 100.0, "turn_deg": 180.0, "turn_rate_deg_s": 1.0}]},
    )
    for number in range(5):
        flight, _, nu = drawn_flight("trial", trial, number)
        wind = flight.wind.speed_mps
        # Against the wind before it turns round, and with it after.
        assert nu == pytest.approx((8.0 + wind) / SPEED)
        assert nu <= 0.5
        assert abs(8.0 - wind) / SPEED >= 0.3


def test_speed_ratios_that_no_draw_has_are_refused_in_a_line():
    draws = [{"key": "wind.from_deg", "uniform": [0.0, 360.0]}]
    trial = scenario(speed_ratio=[0.8, 0.9], draws=draws, flight={"duration_max_s": 10.0})
    with pytest.raises(InputError, match=r"trial 'trial': 1000 draws .* within 0.8 to 0.9; .* widen speed_ratio"):
        drawn_flight("trial", trial, 0)


@pytest.mark.parametrize(
    ("draw", "words"),
    [
        ({"key": "wind.sped_mps", "uniform": [0.0, 1.0]}, "unknown key 'wind.sped_mps'"),
        ({"key": "vessel.speed_mps", "uniform": [5.0, 500.0]}, "vessel.speed_mps: value is 500.0"),
        ({"key": "vessel.speed_mps", "uniform": [-5.0, 10.0]}, "vessel.speed_mps: value is -5.0"),
        # Only the third flight would have met it.
        ({"key": "plume.direction", "choice": ["given", "apparent_wind", "up"]}, "plume.direction: value is 'up'"),
        ({"key": "title.first", "choice": ["a"]}, "'title' is a value, not a section"),
    ],
)
def test_what_cannot_be_drawn_is_refused_before_anything_is_flown(draw, words):
    with pytest.raises(InputError, match=words) as refused:
        check_draws("trial", scenario(draws=[draw]))
    assert "\n" not in str(refused.value)
