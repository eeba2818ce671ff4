"""Several faults in one flight, ``[[fault]]``: how they are read, refused, sampled, flown and shown."""

import pytest
from flight_cases import fly, plan, scenario

from scenarios.errors import InputError
from scenarios.experiment.requests import Experiment, scenario_file
from scenarios.measures.columns import SUMMARY_COLUMNS, further_faults
from scenarios.planning.air.errors import drift_rate
from scenarios.scenario.files import load_study
from scenarios.studies.checks import check_without_design
from scenarios.world.faults import SATELLITES, VESSEL_DATA

TWICE = (
    {"kind": VESSEL_DATA, "at_s": (40.0, 60.0), "vessel_data_s": 20.0},
    {"kind": VESSEL_DATA, "at_s": (100.0, 110.0), "vessel_data_s": 15.0},
)
BOTH = (
    {"kind": SATELLITES, "at_s": (60.0, 70.0), "satellite_navigation_s": 20.0},
    {"kind": VESSEL_DATA, "at_s": (30.0, 40.0), "vessel_data_s": 60.0},
)
SHORT = {"flight": {"crossings": 0, "duration_max_s": 130.0}, "criteria": {"settles": False}}


def checked(*faults, **changes):
    check_without_design(scenario(fault=faults, **changes))


def test_each_fault_acts_at_its_time_and_is_in_the_row_in_the_order_of_time():
    flown = fly(fault=BOTH, reports={"interval_s": (2.0, 4.0)}, **SHORT)
    row, time = flown.row, flown.history["time_s"].to_numpy()
    assert set(row) <= {*SUMMARY_COLUMNS, *further_faults(2)}
    assert (row["fault"], row["fault_2"]) == (VESSEL_DATA, SATELLITES)
    assert 30.0 <= row["fault_time_s"] <= 40.0
    assert 60.0 <= row["fault_2_time_s"] <= 70.0
    lost = flown.history["satellites_lost_s"].to_numpy()
    during = (time > row["fault_2_time_s"]) & (time < row["fault_2_time_s"] + 20.0)
    assert (lost[during] > 0.0).all()
    assert not (lost[~during] > 0.0)[time[~during] < row["fault_2_time_s"]].any()


@pytest.mark.parametrize(
    ("faults", "words"),
    [
        (
            (TWICE[0], {**TWICE[1], "at_s": (70.0, 90.0)}),
            "fault.0.at_s and fault.1.at_s: 'vessel_data' may fail between 40 s and 80 s, and again"
            " between 70 s and 105 s",
        ),
        (
            ({"kind": "sniffer_dead", "at_s": 50.0}, {"kind": "sniffer_saturated", "at_s": 90.0}),
            "the sniffer may fail between 50 s and the end of the flight, and again between 90 s",
        ),
        (
            (TWICE[0], {"kind": "engin"}),
            "fault.1.kind is 'engin'",
        ),
        (
            (TWICE[0], {"kind": SATELLITES, "declared": ["rudder"]}),
            "fault.1.declared has 'rudder'",
        ),
    ],
)
def test_faults_that_cannot_be_are_refused_with_their_keys(faults, words):
    with pytest.raises(InputError, match=words.replace(".", r"\.")) as refused:
        checked(*faults)
    assert "\n" not in str(refused.value)


def test_the_guard_reckons_with_the_longest_loss_of_satellites():
    def drift(*lasting):
        faults = tuple(
            {"kind": SATELLITES, "at_s": 40.0 + 100.0 * i, "satellite_navigation_s": lasts}
            for i, lasts in enumerate(lasting)
        )
        given = scenario(fault=faults, turbulence={"gusts": 0}, wind={"speed_mps": 5.0})
        return drift_rate(given, plan(given).world.weather.wind, 10.0)

    assert drift(10.0, 60.0) == drift(60.0)
    assert drift(10.0, 10.0) == drift(10.0)


def test_a_flight_with_several_is_written_to_a_file_that_repeats_it(tmp_path):
    given = scenario(fault=BOTH, draws=({"key": "fault.1.at_s", "uniform": (30.0, 40.0)},))
    request = Experiment("trial", given).request(0)
    (tmp_path / "again.toml").write_bytes(scenario_file(request, title="again"))
    again = load_study(str(tmp_path / "again.toml"))
    assert again.faults == tuple(
        fault.model_copy(update={"declared": ()}) for fault in request.scenario.faults
    )
    assert (
        plan(again, seed=again.flight_seed).world.faults
        == plan(request.scenario, seed=request.seed).world.faults
    )
