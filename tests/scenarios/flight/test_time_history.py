"""Which time histories a run keeps, and what it keeps of the guard's interventions."""

import json

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.task import Result, Task
from scenarios.flight.record import GuardedStep, interventions
from scenarios.flight.time_history import history_files, keeps_history
from tests.run_tables import history_in

MET = {"outcome": "completed", "criteria_met": True}
UNMET = {"outcome": "failed", "criteria_met": False}


def test_as_many_are_kept_as_are_demanded_evenly_among_all():
    for planned, demanded in ((1, 1), (7, 3), (100, 7), (20, 20), (5, 200), (1000, 1), (10, 0)):
        how = {"planned": planned, "kept": demanded, "row": MET}
        kept = [i for i in range(planned) if keeps_history(Task(number=i), **how)]
        assert len(kept) == min(planned, demanded)
        # Every so many: two gaps differ by one at most.
        assert len(kept) < 2 or np.ptp(np.diff(kept)) <= 1


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
    how = {"columns": {}, "planned": 1, "kept": 1, "row": MET | {"flight_id": "a"}}
    files = history_files(Task(number=0), history, {"fsc": 0.1}, b"{}", **how)
    assert list(files) == ["flights/a.parquet", "flights/a.json", "flights/a.smoke.json"]
    assert json.loads(files["flights/a.json"]) == {"fsc": 0.1}
    result = Result(task=Task(number=0), tables={}, files=files)
    pd.testing.assert_frame_equal(history_in(result), history, check_exact=True)


def test_each_stretch_of_steps_is_one_intervention():
    steps, distances = (1, 2, 5, 6, 7, 9), (225.0, 221.0, 212.0, 205.0, 207.0, 216.0)
    guarding = zip(steps, distances, [False] * 3 + [True] + [False] * 2, strict=True)
    found = interventions([GuardedStep(*step) for step in guarding], 0.05)
    # Read off the list above: steps 1-2, 5-7 and 9, a twentieth of a second each.
    assert [stretch.time_s for stretch in found] == pytest.approx([0.05, 0.25, 0.45], abs=1e-12)
    assert [stretch.duration_s for stretch in found] == pytest.approx([0.1, 0.15, 0.05], abs=1e-12)
    assert [stretch.distance_min_m for stretch in found] == [221.0, 205.0, 216.0]
    assert [stretch.lost for stretch in found] == [False, True, False]
