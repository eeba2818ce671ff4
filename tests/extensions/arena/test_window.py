"""What the end of a flight was worth to the measurement."""

import math

import pytest

from extensions.arena.window import measured_figures

MEASURED = {
    "seconds_in_plume_s": 20.0,
    "fsc_noise_percent": 0.01,
    "sulphur_quality": "B",
    "outcome": "not_settled",
    "duration_s": 400.0,
}


def test_information_is_that_of_a_minute_and_adds_up():
    # 1/0.01^2 in two minutes and a half.
    found = measured_figures(MEASURED, window=150.0)
    assert found == pytest.approx(
        {"plume_s_per_minute": 8.0, "sulphur_information_per_minute": 4000.0}
    )
    # Noise falls with the root of time: twice the time at 1/sqrt(2) of the noise is as much
    # information a minute.
    longer = MEASURED | {"fsc_noise_percent": 0.01 / math.sqrt(2.0), "seconds_in_plume_s": 40.0}
    assert measured_figures(longer, window=300.0) == pytest.approx(found)


@pytest.mark.parametrize(
    "row",
    [
        {"outcome": "aircraft_lost"},
        {"sulphur_quality": "C"},
        {"sulphur_quality": "C", "fsc_noise_percent": math.nan},
    ],
)
def test_a_result_that_is_not_admitted_or_lost_with_the_aircraft_is_no_information(row):
    assert measured_figures(MEASURED | row, window=150.0)["sulphur_information_per_minute"] == 0.0
