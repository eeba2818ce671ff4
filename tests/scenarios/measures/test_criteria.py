"""What a flight's row fails of its criteria."""

import math

import pytest

from scenarios.measures.criteria import failed_criteria
from scenarios.scenario.sections.flight import CriteriaConfig

GOOD = {
    "outcome": "completed", "message": "", "mode_at_end": "tracking", "fault": "none", "fault_time_s": math.nan,
    "duration_s": 300.0, "settling_time_s": 80.0, "resume_periods": 1.5, "tracking_error_end_m": 1.0,
    "keepout_violations": 0, "keepout_depth_m": 0.0, "keepout_radius_m": 200.0, "crossing_clearance_min_m": 0.0,
    "tracking_error_rms_m": 1.5, "airspeed_error_rms_mps": 0.3, "altitude_error_max_m": 1.5, "crossing_interval_mean_s": 10.0,
    "crossing_interval_predicted_s": 10.0, "crossing_distance_mean_m": 215.0, "heading_rate_command_max_rad_s": 0.5,
    "heading_rate_limit_rad_s": 0.5, "heading_rate_demand_max_rad_s": 0.6,
}  # fmt: skip
"""A row at every limit of the criteria that there are unless a scenario says otherwise."""


def failed(changed, **criteria):
    return failed_criteria({**GOOD, **changed}, CriteriaConfig(**criteria))


def test_a_flight_at_every_limit_has_met_them():
    assert failed({}) == []


@pytest.mark.parametrize(
    ("changed", "criteria", "words"),
    [
        (
            {"keepout_violations": 1, "keepout_depth_m": 10.0},
            {},
            "1 keep-out violation, the deepest by 10.00 m",
        ),
        ({"keepout_violations": 2}, {}, "2 keep-out violations"),
        ({"outcome": "not_settled"}, {}, "did not complete"),
        (
            {"outcome": "diverged", "message": "it rolled over"},
            {"settles": False},
            "it rolled over",
        ),
        (
            {"outcome": "diverged", "fault": "left_elevon", "fault_time_s": 50.0},
            {"settles": False},
            "did not complete",
        ),
        ({"settling_time_s": math.nan}, {}, "did not settle"),
        ({"crossing_clearance_min_m": -0.01}, {}, "crossed at 199.99 m"),
        (
            {"tracking_error_rms_m": 1.51},
            {},
            "rms tracking error 1.51 m, above the limit of 1.5 m, in the 220 s since it settled",
        ),
        ({"tracking_error_rms_m": math.nan}, {}, "tracking error"),
        ({"airspeed_error_rms_mps": 0.31}, {}, "airspeed error"),
        ({"altitude_error_max_m": 1.6}, {}, "altitude error"),
        (
            {"tracking_error_end_m": 1.1},
            {"tracking_error_end_m": 1.0},
            "tracking error at the end 1.10 m",
        ),
        ({"crossing_interval_mean_s": 10.11}, {}, "mean crossing interval 10.110 s"),
        (
            {"crossing_interval_mean_s": 12.0},
            {"crossing_interval_error": 0.02},
            "mean crossing interval 12.000 s",
        ),
        (
            {"crossing_interval_mean_s": 10.05},
            {"crossing_interval_s": (9.0, 10.0)},
            "10.050 s outside 9 to 10 s",
        ),
        (
            {},
            {"crossing_distance_m": (210.0, 214.0)},
            "mean crossing distance 215.000 m outside 210 to 214 m",
        ),
        ({"heading_rate_command_max_rad_s": 0.5001}, {}, "commanded 0.5001 rad/s, above omega_max"),
        (
            {"heading_rate_demand_max_rad_s": 0.51},
            {"law_within_heading_rate_max": True},
            "demanded 0.5100 rad/s, above omega_max",
        ),
        (
            {"heading_rate_demand_max_rad_s": 0.5},
            {"law_beyond_heading_rate_max": True},
            "demanded 0.5000 rad/s, within omega_max",
        ),
        (
            {"resume_periods": 2.1},
            {"resumes_within_periods": 2.0},
            "crossings resumed 2.10 periods",
        ),
        (
            {"outcome": "incomplete", "message": "flew 12 of 30 crossings"},
            {"settles": False},
            "flew 12 of 30 crossings",
        ),
        ({"mode_at_end": "outrun"}, {"modes_at_end": ("tracking", "holding off")}, "ended outrun"),
        (
            {"time_to_find_s": 301.0},
            {"time_to_find_s": 300.0},
            "time to find the plume 301.00 s, above the limit of 300 s",
        ),
        # A plume that was never detected has no time.
        ({}, {"time_to_find_s": 300.0}, "time to find the plume nan s"),
        ({"altitude_outside_s": 0.1}, {"within_altitudes": True}, "0.1 s outside"),
    ],
)
def test_every_criterion_can_fail_and_says_so_in_a_short_sentence(changed, criteria, words):
    (found,) = failed(changed, **criteria)
    assert words in found
