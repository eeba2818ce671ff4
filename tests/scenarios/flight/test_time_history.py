"""Which time histories a run keeps."""

import json

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.task import Result, Task
from scenarios.flight.time_history import history_files, keeps_history
from tests.run_tables import history_in

MET, UNMET = (
    {"outcome": "completed", "criteria_met": True},
    {"outcome": "failed", "criteria_met": False},
)


@pytest.mark.parametrize(
    ("planned", "asked"), [(1, 1), (7, 3), (100, 7), (20, 20), (5, 200), (1000, 1), (10, 0)]
)
def test_as_many_are_kept_as_are_asked_for_evenly_among_all(planned, asked):
    kept = [
        number
        for number in range(planned)
        if keeps_history(Task(number=number), planned=planned, kept=asked, row=MET)
    ]
    assert len(kept) == min(planned, asked)
    if len(kept) > 1:
        # Every so many: two gaps differ by one at most.
        assert np.ptp(np.diff(kept)) <= 1


@pytest.mark.parametrize(
    ("row", "kept"),
    [
        ({"outcome": "completed", "kept_out": True}, True),
        ({"outcome": "aircraft_lost", "kept_out": True}, True),
        # There may be many: the study chooses among them.
        ({"outcome": "not_settled", "kept_out": True}, False),
        ({"outcome": "incomplete", "kept_out": True}, False),
        ({"outcome": "incomplete", "kept_out": False}, True),
        ({"outcome": "aircraft_lost", "kept_out": True, "required": "keep_out"}, False),
        ({"outcome": "aircraft_lost", "kept_out": False, "required": "keep_out"}, True),
    ],
)
def test_of_flights_that_are_not_met_those_are_kept_that_did_not_do_what_is_required(row, kept):
    assert keeps_history(Task(number=3), planned=10, kept=0, row=UNMET | row) == kept


def test_a_history_comes_back_from_its_file_exactly():
    history = pd.DataFrame({"time_s": [0.0, 0.1 + 0.2], "north_m": [np.nan, 5e-324]})
    result = Result(
        task=Task(number=0),
        tables={},
        files=history_files(
            Task(number=0),
            history,
            {"fsc": 0.1},
            b"{}",
            columns={},
            planned=1,
            kept=1,
            row=MET | {"flight_id": "a"},
        ),
    )
    assert list(result.files) == [
        "flights/a.parquet",
        "flights/a.json",
        "flights/a.smoke.json",
    ]
    assert json.loads(result.files["flights/a.json"]) == {"fsc": 0.1}
    pd.testing.assert_frame_equal(history_in(result), history, check_exact=True)
