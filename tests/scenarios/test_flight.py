"""One flight as a task: whatever becomes of it is a row."""

import pytest
from flight_cases import ASTERN, fly

from scenarios.measures.columns import SUMMARY_COLUMNS


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (
            {"vessel": {"speed_mps": 19.0}},
            "nu = 0.98; the UAV at 19.42 m/s follows up to nu = 0.97: fly faster",
        ),
        # Not at first, but once the vessel has turned against the wind.
        (
            {
                "vessel": {
                    "speed_mps": 10.0,
                    "manoeuvres": [{"at_s": 60.0, "turn_deg": 180.0, "turn_rate_deg_s": 2.0}],
                },
                "wind": {"speed_mps": 9.5, "from_deg": 180.0},
            },
            "the vessel moves at up to 19.5 m/s through the air",
        ),
        (
            {"vessel": {"speed_mps": 0.0}},
            "the apparent wind is 0.00 m/s; below 1 m/s the plume has no direction",
        ),
        (
            {"wind": {"speed_mps": 8.0, "from_deg": 180.0}},
            "another speed, or the plume a direction (plume.direction=given)",
        ),
        # Exhaust goes with the wind in any case.
        (
            {"wind": {"speed_mps": 8.0, "from_deg": 180.0}, "emission": {"ship": "container"}},
            "another speed",
        ),
    ],
)
def test_what_cannot_be_flown_is_an_infeasible_row_with_one_clear_line(changes, words):
    result = fly(**changes)
    assert (result.row["outcome"], result.row["criteria_met"]) == ("infeasible", False)
    assert words in result.row["message"]
    assert "\n" not in result.row["message"]
    assert not ("emission" in changes and "plume.direction" in result.row["message"])
    assert set(result.row) <= set(SUMMARY_COLUMNS)
    assert result.history is None


@pytest.mark.parametrize(
    ("changed", "outcome", "words"),
    [
        ({}, "completed", ""),
        # Settled, but not yet back at the axis.
        (
            {"flight": {"crossings": 0, "duration_max_s": 40.0}},
            "not_settled",
            "did not settle within 40 s",
        ),
        # Nothing is received from the vessel for a minute at its end: it holds off, until the next
        # report.
        ({"fault": {"kind": "vessel_data", "at_s": (130.0, 130.0)}}, "completed", ""),
    ],
)
def test_a_flight_for_a_while_completes_if_it_settles_and_crosses(changed, outcome, words):
    row = fly(
        **{
            "start": ASTERN,
            "flight": {"crossings": 0, "duration_max_s": 160.0},
            "criteria": {"settles": False},
        }
        | changed
    ).row
    assert (row["outcome"], row["criteria_met"]) == (outcome, outcome == "completed"), row[
        "message"
    ]
    assert words in row["message"]
    assert row["mode_at_end"] == ("holding off" if "fault" in changed else "tracking")


@pytest.mark.parametrize("mission", ["track", "follow"])
def test_beside_a_plume_that_rises_steeply_a_cylinder_is_kept_out_of_horizontally(mission):
    steep = {
        "guidance": {"mission": mission}, "plume": {"elevation_deg": 60.0}, "flight": {"crossings": 4}, "wind": {"speed_mps": 0.0},
        "start": ASTERN,
    }  # fmt: skip
    cylinder = fly(**steep, keepout={"shape": "cylinder"}).row
    assert (cylinder["outcome"], cylinder["keepout_violations"], cylinder["keepout_shape"]) == (
        "completed",
        0,
        "cylinder",
    )
    # Its distance is the horizontal one, and the orbit comes as near to r_min as over a level
    # plume: within the margin.
    assert cylinder["min_distance_m"] == cylinder["horizontal_distance_min_m"]
    assert 200.0 <= cylinder["min_distance_m"] < 230.0
    sphere = fly(**steep).row
    assert (sphere["outcome"], sphere["keepout_violations"], sphere["keepout_shape"]) == (
        "completed",
        0,
        "sphere",
    )
    assert sphere["min_distance_m"] >= 200.0
    if mission == "track":
        # Issue: at 60 degrees the UAV passes 80 m beside the funnel, outside the sphere.
        assert sphere["horizontal_distance_min_m"] < 130.0
    # A steered reference keeps off horizontally whatever the shape: outside of either.
    assert sphere["horizontal_distance_min_m"] <= sphere["min_distance_m"]
