import numpy as np
import pytest

from scenarios.metrics.figures import settling_index, unmet_criteria
from scenarios.schema.config import Criteria


@pytest.mark.parametrize(
    ("distance", "index"),
    [([9, 8, 3, 2, 1], 2), ([1, 1, 1], 0), ([1, 9, 1, 9, 1, 1], 4), ([1, 2, 9], None), ([5.0, 4.999], 1)],
)
def test_settling_is_the_first_moment_from_which_the_distance_stays_below_the_band(distance, index):
    assert settling_index(np.array(distance, dtype=float), 5.0) == index


GOOD = {
    "keepout_violations": 0, "keepout_radius_m": 200.0, "crossing_distance_min_m": 200.0, "tracking_error_rms_m": 1.5,
    "airspeed_error_rms_mps": 0.3, "altitude_error_max_m": 1.5, "crossing_interval_mean_s": 10.0,
    "crossing_interval_predicted_s": 10.0, "heading_rate_command_max_rad_s": 0.5, "heading_rate_limit_rad_s": 0.5,
    "heading_rate_wanted_max_rad_s": 0.6,
}  # fmt: skip


def test_a_flight_at_every_limit_is_met():
    assert unmet_criteria(GOOD, Criteria()) == []


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"keepout_violations": 2}, "entered the keep-out area 2 times"),
        ({"crossing_distance_min_m": 199.99}, "crossed at 199.99 m"),
        ({"tracking_error_rms_m": 1.51}, "tracking error 1.51 m above 1.5 m"),
        ({"airspeed_error_rms_mps": 0.31}, "airspeed error"),
        ({"altitude_error_max_m": 1.6}, "altitude error"),
        ({"crossing_interval_mean_s": 10.11}, "crossing interval 10.110 s"),
        ({"heading_rate_command_max_rad_s": 0.5001}, "above omega_max"),
        ({"tracking_error_rms_m": float("nan")}, "tracking error"),
    ],
)
def test_every_criterion_can_fail(changed, words):
    unmet = unmet_criteria({**GOOD, **changed}, Criteria())
    assert len(unmet) == 1
    assert words in unmet[0]


def test_a_flight_without_crossings_fails():
    row = {key: value for key, value in GOOD.items() if not key.startswith("crossing") or key.endswith("predicted_s")}
    assert len(unmet_criteria(row, Criteria())) == 2


@pytest.mark.parametrize(
    ("criteria", "wanted", "words"),
    [
        (Criteria(law_within_heading_rate_max=True), 0.5, None),
        (Criteria(law_within_heading_rate_max=True), 0.51, "asked for 0.5100 rad/s, above omega_max"),
        (Criteria(law_beyond_heading_rate_max=True), 0.51, None),
        (Criteria(law_beyond_heading_rate_max=True), 0.5, "asked for 0.5000 rad/s, within omega_max"),
        (Criteria(crossing_interval_s=(9.0, 11.0)), 0.5, None),
        (Criteria(crossing_interval_s=(9.0, 9.5)), 0.5, "mean crossing interval 10.000 s outside 9 to 9.5 s"),
        (Criteria(crossing_distance_m=(210.0, 220.0)), 0.5, "mean crossing distance nan m outside 210 to 220 m"),
    ],
)
def test_criteria_that_are_asked_for_can_be_met_and_missed(criteria, wanted, words):
    unmet = unmet_criteria({**GOOD, "heading_rate_wanted_max_rad_s": wanted}, criteria)
    assert len(unmet) == (words is not None)
    assert words is None or words in unmet[0]


def test_a_flight_that_need_not_settle_is_not_judged_by_its_tracking():
    row = {key: value for key, value in GOOD.items() if "error" not in key}
    assert len(unmet_criteria(row, Criteria())) == 3
    assert unmet_criteria(row, Criteria(settles=False)) == []
