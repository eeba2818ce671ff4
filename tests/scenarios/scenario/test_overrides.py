"""What a document says of its experiment: keys that are set, what is random, faults and tables."""

import json
import re

import pytest
from flight_cases import fly, plan, scenario

from scenarios.errors import InputError
from scenarios.experiment.points import points_of
from scenarios.experiment.requests import Experiment, scenario_file
from scenarios.experiment.sampling import flights_per_sample, is_random_sample
from scenarios.measures.columns import SUMMARY_COLUMNS, further_faults
from scenarios.planning.air.errors import drift_rate
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import TrialStudy
from scenarios.studies.checks import check_without_design
from scenarios.world.faults import SATELLITES, VESSEL_DATA
from scenarios.world.world import mean_wind, vessel_of


def write(folder, name, text):
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_a_chain_of_files_is_resolved_relative_to_each_file(tmp_path):
    (tmp_path / "bases").mkdir()
    first = 'extends = "sea_wind"\ntitle = "first"\nwind = { speed_mps = 3.0, from_deg = 10.0 }\n'
    write(tmp_path / "bases", "first.toml", first)
    write(tmp_path / "bases", "second.toml", 'extends = "first.toml"\nwind.speed_mps = 4.0\n')
    third = 'extends = "bases/second.toml"\ntitle = "third"\nvessel.speed_mps = 5.0\n'
    found, base = load_study(write(tmp_path, "third.toml", third)), load_study("sea_wind")
    assert (found.title, found.wind.speed_mps, found.wind.from_deg) == ("third", 4.0, 10.0)
    assert found.vessel.speed_mps == 5.0
    same = {"title", "description", "wind", "vessel", "draws"}
    assert found.model_dump(exclude=same) == base.model_dump(exclude=same)


SWEPT = """
title = "swept"
fidelity = "kinematic"
[sweep]
nu = [0.3, 0.5]
"wind.speed_mps" = [2, 5]
wind.from_deg = [0, 90]
"""


@pytest.mark.parametrize(
    ("override", "left"),
    [
        ("wind.speed_mps=9", {"nu", "wind.from_deg"}),
        ("wind.from_deg=45", {"nu", "wind.speed_mps"}),
        ("vessel.speed_ratio=0.4", {"wind.speed_mps", "wind.from_deg"}),
        ("keepout.radius_m=150", {"nu", "wind.speed_mps", "wind.from_deg"}),
    ],
)
def test_an_override_of_a_swept_key_ends_its_sweep(tmp_path, override, left):
    path = write(tmp_path, "swept.toml", SWEPT)
    points = points_of(load_study(path, [override]))
    section, key, value = re.split("[.=]", override, maxsplit=2)
    assert {getattr(getattr(point.scenario, section), key) for point in points} == {float(value)}
    # Two values of each key that is still swept.
    assert len(points) == 2 ** len(left)
    assert {*load_study(path, [override]).sweep.root} == left


@pytest.mark.parametrize(
    ("override", "gone", "value_of"),
    [
        ("vessel.manoeuvres=[]", "vessel.manoeuvres.", lambda s: s.vessel.manoeuvres == ()),
        (
            "wind={speed_mps=5}",
            "wind.",
            lambda s: (s.wind.speed_mps, s.wind.from_deg) == (5.0, 0.0),
        ),
        ("start.range_m=500", "start.range_m", lambda s: s.start.range_m == 500.0),
        ("vessel.speed_ratio=0.4", "vessel.speed_mps", lambda s: s.vessel.speed_ratio == 0.4),
        ("sweep.nu=[0.4]", "vessel.speed_mps", lambda s: s.vessel.speed_ratio == 0.4),
    ],
)
def test_an_override_ends_what_is_sampled_of_its_key_and_below_it(override, gone, value_of):
    study = load_study("monte_carlo", [override])
    every = [draw.key for draw in load_study("monte_carlo").draws]
    assert [draw.key for draw in study.draws] == [key for key in every if not key.startswith(gone)]
    experiment = Experiment("t", study)
    assert all(value_of(experiment.request(number).scenario) for number in range(3))


@pytest.mark.parametrize(
    "override", ["sweep.wind.from_deg=[0,90]", 'sweep={"wind.from_deg"=[0,90]}']
)
def test_a_key_that_a_base_samples_is_swept_in_place_of_that(override, tmp_path):
    given = write(tmp_path, "own.toml", 'extends = "sea_wind"\nsweep.wind.from_deg = [0, 90]\n')
    for study in (load_study("sea_wind", [override]), load_study(given)):
        assert [draw.key for draw in study.draws] == ["wind.speed_mps", "vessel.speed_mps"]
        experiment = Experiment("t", study)
        flown = [experiment.request(number).scenario.wind for number in range(experiment.flights)]
        assert {wind.from_deg for wind in flown} == {0.0, 90.0}
        # Samples with a speed ratio out of range are sampled again at the point that needs it.
        assert len({wind.speed_mps for wind in flown}) >= study.flights


def test_an_override_of_a_speed_ends_a_sampled_speed_ratio_and_one_of_the_ratio_a_swept_speed(
    tmp_path,
):
    drawn = 'title = "d"\ndraws = [{ key = "vessel.speed_ratio", uniform = [0.2, 0.5] }]\n'
    study = load_study(write(tmp_path, "drawn.toml", drawn), ["vessel.speed_mps=5"])
    assert (study.draws, study.vessel_speed) == ((), 5.0)
    swept = write(tmp_path, "speeds.toml", 'title = "s"\nsweep.vessel.speed_mps = [5, 6]\n')
    points = points_of(load_study(swept, ["vessel.speed_ratio=0.5"]))
    assert [point.scenario.vessel_speed for point in points] == [9.71]


def test_a_trial_in_a_file_is_relative_to_the_list_and_in_an_override_to_the_current_directory(
    tmp_path, monkeypatch
):
    for folder in ("lists", "elsewhere"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "own.toml").write_text(f'title = "{folder}"\n', encoding="utf-8")
    path = tmp_path / "lists" / "list.toml"
    text = 'study = "trials"\ntitle = "list"\ntrials = ["own.toml", "sea_wind"]\n'
    path.write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path / "elsewhere")
    listed, overridden = load_study(str(path)), load_study(str(path), ['trials=["own.toml"]'])
    assert listed.trials == (str(tmp_path / "lists" / "own.toml"), "sea_wind")
    assert TrialStudy(listed, "list").trials["own"].title == "lists"
    assert TrialStudy(overridden, "list").trials["own"].title == "elsewhere"


WIND = {"key": "wind.speed_mps", "uniform": [0.0, 5.0]}
FROM = {"key": "wind.from_deg", "choice": [0.0, 90.0, 180.0, 270.0]}
LOAD = {"key": "emission.load", "uniform": [0.2, 0.9]}
WEIGHED = FROM | {"weights": [1.0, 1.0, 2.0, 1.0]}
ONE_SEED = {"flight_seed": 5}
SEEDS = {"key": "flight_seed", "choice": [1, 2]}
SNIFFERS = {"payload.sensor": ["fast", "electrochemical"]}
COMMON = {"common_random_numbers": True}
OWN = {"common_random_numbers": False}
ABOARD = {"payload": ["sniffer"], "emission": {"ship": "container"}}
START = {"place_m": [-400.0, 0.0], "course_deg": 0.0}


@pytest.mark.parametrize(
    ("keys", "at_random"),
    [
        ({}, True),
        ({"start": START}, False),
        ({"start": START, "draws": [WIND]}, True),
        # One seed for all: a hundred times the same flight.
        ({"flight_seed": 3, "flights": 100}, False),
        ({"flight_seed": 3, "draws": [WIND]}, True),
        ({"study": "monte_carlo", "draws": [WIND]}, True),
        # One seed, and four winds in turn: fifty times the same four flights. At random by their
        # weights they are a sample.
        (ONE_SEED | {"flights": 200, "draws": [FROM]}, False),
        (ONE_SEED | {"flights": 200, "draws": [WEIGHED]}, True),
        (ONE_SEED | {"flights": 200, "draws": [FROM, WIND]}, True),
        ({"flights": 200, "draws": [FROM]}, True),
        # Seeds in turn, and each once; or each ten times.
        ({"flights": 2, "draws": [SEEDS]}, True),
        ({"flights": 20, "draws": [SEEDS]}, False),
        ({"flights": 4, "draws": [{"key": "flight_seed", "choice": [7, 7, 7, 7]}]}, False),
        # Two seeds with two winds each, or one seed with both: no flight twice, and no sample more
        # than there are seeds.
        ({"flights": 4, "draws": [SEEDS, FROM]}, False),
        ({"flights": 2, "draws": [SEEDS, FROM]}, True),
        ({"flights": 2, "draws": [FROM, SEEDS]}, False),
        ({"flights": 4, "sweep": {"flight_seed": [1, 2]}, "draws": [FROM]}, False),
        # Random variables of one value.
        (ONE_SEED | {"flights": 8, "draws": [WIND | {"uniform": [5.0, 5.0]}]}, False),
        ({"flights": 1, "sweep": {"flight_seed": [1, 2]}}, True),
        ({"flights": 10, "sweep": {"flight_seed": [1, 2]}}, False),
        # In calm air nothing but the start depends on the seed.
        ({"start": START, "flights": 8, "draws": [FROM]}, False),
        ({"start": START, "flights": 8, "draws": [FROM], "turbulence": {"level": "light"}}, True),
        # Sniffers that read the same flight, and those on flights of their own.
        ({"flights": 8, "sweep": SNIFFERS}, False),
        (ABOARD | {"flights": 8, "sweep": SNIFFERS} | COMMON, False),
        (ABOARD | {"flights": 8, "sweep": SNIFFERS}, True),
        # And sniffers that are drawn, without and with a path that depends on what is read.
        (ONE_SEED | {"flights": 8, "draws": [LOAD]}, False),
        (ONE_SEED | {"flights": 8, "draws": [LOAD, WIND]}, True),
        (ONE_SEED | {"flights": 8, "draws": [LOAD], "following": {"plume": "estimated"}}, True),
        ({"flights": 8, "draws": [LOAD]}, True),
        # Each level starts from the nearest flights of the one before.
        ({"study": "monte_carlo", "method": "subset", "draws": [WIND]}, False),
        ({"study": "falsify", "draws": [WIND]}, False),
        ({"cases": [{"name": "one"}]}, False),
    ],
)
def test_flights_are_a_random_sample_where_they_differ_by_chance_alone(keys, at_random):
    assert is_random_sample(Scenario(title="own", **keys)) is at_random


@pytest.mark.parametrize(
    ("keys", "shared"),
    [
        ({"flights": 8}, 1),
        ({"sweep": {"nu": [0.3, 0.5]}}, 1),
        ({"sweep": {"nu": [0.3, 0.5]}, "flights": 8}, 2),
        ({"sweep": {"nu": [0.3, 0.5], "keepout.radius_m": [200.0, 250.0, 300.0]}}, 3),
        ({"sweep": {"keepout.radius_m": [200.0, 250.0, 300.0]}, "flights": 8}, 3),
        ({"sweep": {"keepout.radius_m": [200.0, 250.0, 200.0]}, "flights": 8}, 2),
        ({"sweep": {"flight_seed": [1, 2, 3]}}, 1),
        ({"fidelity": "both", "flights": 8}, 2),
        # Speed ratios of one flight each have seeds of their own, but all points of a sweep the
        # same sample of random variables.
        ({"sweep": {"nu": [0.3, 0.5]}, "draws": [WEIGHED]}, 2),
        # Numbers of their own, by the key or because of an instrument; the vehicles share them.
        (OWN | {"sweep": {"nu": [0.3, 0.5]}, "flights": 8}, 1),
        (OWN | {"sweep": {"vessel.speed_ratio": [0.3, 0.5]}}, 1),
        (ABOARD | {"sweep": {"nu": [0.3, 0.5], "keepout.radius_m": [200.0, 250.0, 300.0]}}, 1),
        (ABOARD | {"sweep": {"nu": [0.3, 0.5]}, "draws": [WEIGHED]}, 1),
        (OWN | {"fidelity": "both", "sweep": {"keepout.radius_m": [200.0, 250.0]}}, 2),
        # Seeds that are given come again.
        (OWN | {"sweep": {"flight_seed": [1, 2, 3], "keepout.radius_m": [200.0, 250.0]}}, 2),
        (OWN | {"sweep": {"keepout.radius_m": [200.0, 250.0]}, "flight_seed": 3}, 2),
        # Common numbers.
        (COMMON | {"sweep": {"nu": [0.3, 0.5]}}, 2),
        (ABOARD | COMMON | {"sweep": {"wind.from_deg": [0.0, 90.0]}, "flights": 8}, 2),
    ],
)
def test_flights_of_several_points_share_what_is_random(keys, shared):
    scenario = Scenario(title="own", **keys)
    assert flights_per_sample(scenario) == shared
    experiment = Experiment("own", scenario)
    seeds = {experiment.request(i).seed for i in range(experiment.flights)}
    assert len(seeds) == experiment.flights / shared


COASTER = ("emission.ship=coaster", "vessel.speed_mps=6")


@pytest.mark.parametrize(
    ("name", "overrides", "funnel", "start"),
    [
        # measurement/ships.toml: 35 m of the container, 16 of the coaster, 55 of the cruise ship.
        ("sulphur", (), 35.0, 35.0),
        ("sulphur", ("emission.ship=cruise",), 55.0, 55.0),
        # The UAV keeps 3 m, in light turbulence 6, within flight.altitude_min_m and altitude_max_m:
        # 20 and 120 m above the sea.
        ("sulphur", COASTER, 16.0, 23.0),
        ("sulphur", ("plume.source_height_m=150", "turbulence.level=light"), 150.0, 114.0),
        ("sulphur", ("flight.altitude_min_m=36", "flight.altitude_max_m=40"), 35.0, 38.0),
        ("sulphur", (*COASTER, "plume.source_height_m=25"), 25.0, 25.0),
        ("sulphur", (*COASTER, "flight.altitude_m=40"), 16.0, 40.0),
        ("sweep_nu", (), 60.0, 60.0),
    ],
)
def test_a_plume_begins_at_the_funnel_of_its_ship_unless_its_height_is_given(
    name, overrides, funnel, start
):
    scenario = load_study(name, overrides)
    assert (scenario.source_height, scenario.altitude) == (funnel, start)


ONCE = {"kind": VESSEL_DATA, "at_s": (40.0, 60.0), "vessel_data_s": 20.0}
BOTH = (
    {"kind": SATELLITES, "at_s": (60.0, 70.0), "satellite_navigation_s": 20.0},
    {"kind": VESSEL_DATA, "at_s": (30.0, 40.0), "vessel_data_s": 60.0},
)
SHORT = {"flight": {"crossings": 0, "duration_max_s": 130.0}, "criteria": {"settles": False}}


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
        ((ONCE, {**ONCE, "at_s": (70.0, 90.0)}), "between 40 s and 80 s, and again between 70 s"),
        (
            ({"kind": "sniffer_dead", "at_s": 50.0}, {"kind": "sniffer_saturated", "at_s": 90.0}),
            "the sniffer may fail between 50 s and the end of the flight, and again between 90 s",
        ),
        ((ONCE, {"kind": "engin"}), "fault.1.kind is 'engin'"),
        ((ONCE, {"kind": SATELLITES, "declared": ["rudder"]}), "fault.1.declared has 'rudder'"),
    ],
)
def test_faults_that_cannot_be_are_refused_with_their_keys(faults, words):
    with pytest.raises(InputError, match=words.replace(".", r"\.")) as refused:
        check_without_design(scenario(fault=faults))
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
    planned = plan(request.scenario, seed=request.seed).world.faults
    assert plan(again, seed=again.flight_seed).world.faults == planned


KINEMATIC = 'title = "mine"\nfidelity = "kinematic"\n'


DIALECTS = {
    # Day before month, which cannot be found: the first of June, and not the sixth of January.
    "order of day and month": (
        "time_utc;speed_mps;from_deg\n01.06.2026 09:00;5,0;90\n01.06.2026 13:00;5,0;90\n",
        {"time_format": "%d.%m.%Y %H:%M"},
    ),
    # Every comma may be of thousands: a wind of 5.000 or 5000 m/s.
    "commas of three decimals": (
        "height_m;speed_mps;from_deg\n1;5,000;90\n60;5,000;90\n",
        {"decimal": ","},
    ),
    "milliseconds": (
        "time_utc,speed_mps,from_deg\n1780304400000,5,90\n1780318800000,5,90\n",
        {"time_unit": "ms"},
    ),
    "a separator that is not looked for": (
        "time_utc:speed_mps:from_deg\n20260601 09:5:90\n20260601 13:5:90\n".replace(" ", ""),
        {"separator": ":", "time_format": "%Y%m%d%H"},
    ),
    # The head's first letters would be a comment in UTF-8.
    "an encoding": (
        "time_utc,speed_mps,from_deg,Bö\n2026-06-01T09:00:00Z,5,90,x\n2026-06-01T13:00:00Z,5,90,x\n",
        {"encoding": "cp850"},
    ),
}


def east_wind(tmp_path, text, table, *, encoding="utf-8"):
    (tmp_path / "wind.csv").write_text(text, encoding=encoding)
    keys = "".join(f"table.{key} = {json.dumps(value)}\n" for key, value in table.items())
    (tmp_path / "mine.toml").write_text(
        f'{KINEMATIC}wind.table = "wind.csv"\nplace.utc = 2026-06-01T10:00:00Z\n{keys}',
        encoding="utf-8",
    )
    return load_study(str(tmp_path / "mine.toml"))


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_wind_is_read_as_the_scenario_says(tmp_path, dialect):
    text, table = DIALECTS[dialect]
    scenario = east_wind(tmp_path, text, table, encoding=table.get("encoding", "utf-8"))
    north, east = mean_wind(scenario, vessel_of(scenario)).now(0.0, 10.0)
    # 5 m/s from the east, at 10 o'clock of the first of June.
    assert (north, east) == (pytest.approx(0.0, abs=1e-12), pytest.approx(-5.0))
