"""The X8 in the plume of a ship when a part of it fails: it ends outside the keep-out area, in a
stated mode.
"""

import pandas as pd
import pytest
from flight_cases import run_here, scenario

from common.verdict import NOT_MET
from gnc.mission.mission import Mode
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.sections.flight import DITCHED
from scenarios.studies.base import run_study
from tests.run_tables import rows_of

pytestmark = pytest.mark.slow

KINDS = ("engine", "throttle", "left_elevon")
FAILS, ENDS = 55.0, 130.0
ENDS_IN = {
    "engine": DITCHED,
    "throttle": Mode.TRACKING.value,
    "left_elevon": DITCHED,
}


@pytest.fixture(scope="module")
def flown(designs, tmp_path_factory):
    """A flight for each kind of fault, by its kind: row and time history. At 100 m, to have some
    way before the sea.
    """
    flights = scenario(
        fidelity="six_dof",
        flights=len(KINDS),
        vessel={"speed_mps": 6.0},
        plume={"source_height_m": 100.0},
        start={"distance_m": (350.0, 350.0), "spread_deg": 10.0},
        fault={"at_s": (FAILS, FAILS)},
        draws=({"key": "fault.kind", "choice": KINDS},),
        guidance={"reserve": 0.1},
        flight={"crossings": 0, "duration_max_s": ENDS},
        criteria={"settles": False},
    )
    path = tmp_path_factory.mktemp("faults") / "run"
    with pytest.MonkeyPatch.context() as patch:
        # The design of the other tests, for 60 m.
        patch.setattr("scenarios.studies.base.design_of", lambda *_: (designs("x8"), ""))
        run_study(flights, "faults", path, executor_factory=InProcessExecutor)
    return {
        row["fault"]: (row, pd.read_parquet(path / "flights" / f"{row['flight_id']}.parquet"))
        for row in rows_of(path)
    }


@pytest.mark.parametrize("kind", KINDS)
def test_whatever_fails_the_flight_ends_outside_in_its_mode(flown, kind):
    row, history = flown[kind]
    assert row["outcome"] == ("aircraft_lost" if row["mode_at_end"] == DITCHED else "completed"), (
        row["message"]
    )
    assert (row["kept_out"], row["criteria_met"]) == (True, kind == "throttle")
    assert row["keepout_violations"] == 0
    assert row["mode_at_end"] == ENDS_IN[kind]
    # It was in the plume until then: nothing had been found wrong with it.
    before = history[history["time_s"] < FAILS]
    assert list(Mode)[int(before["mode"].iloc[-1])] is Mode.TRACKING


def test_an_aircraft_that_is_lost_before_its_last_crossing_is_not_met(tmp_path):
    # An engine that failed in sea_wind ended in the sea, with "met every criterion" and exit status
    # 0.
    keys = ["flights=1", "fault.kind=engine", "fault.at_s=[20, 20]"]
    result = run_here("sea_wind", tmp_path / "run", *keys)
    (row,) = rows_of(tmp_path / "run")
    assert (row["outcome"], row["criteria_met"], row["kept_out"]) == ("aircraft_lost", False, True)
    assert row["message"].startswith("it came down on the sea at ")
    assert result.verdict.exit_status == NOT_MET
    assert result.lines[0].startswith("flights: 1 planned, 1 flown, 0 completed, 0 met every")
    assert "; 0 of 1 kept out, 1 ended outside, lost or failed; 0 keep-out" in result.lines[0]
