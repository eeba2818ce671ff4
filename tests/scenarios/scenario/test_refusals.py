"""What is wrong with a scenario is said in one line: the key, its value, the limit, the nearest
known name. One table for files and overrides.
"""

import pytest

from scenarios.errors import InputError
from scenarios.scenario.files import load_study

DIGITS = "9" * 5000
CELL = "{t90_s=2,delay_s=0.5,noise=5}"

VALUES = [
    (
        "keepout.radius_m=-5",
        "keepout.radius_m is -5; input should be greater than or equal to 10 [m]",
    ),
    ("keepout.radius_m=nan", "keepout.radius_m is nan; input should be a finite number [m]"),
    ("keepout.radius_m=wide", "keepout.radius_m is 'wide'; input should be a valid number"),
    ("wind.speed_mps=5kn", "wind.speed_mps is '5kn'; input should be a valid number"),
    ("wind.speed_mps=50", "wind.speed_mps is 50; input should be less than or equal to 40 [m/s]"),
    ("wind=5", "wind is 5; input should be a valid dictionary"),
    ("flight.crossings=2.5", "flight.crossings is 2.5; input should be a valid integer"),
    ("start.distance_m=[800, 400]", "start.distance_m is [800.0, 400.0]; its first value must not"),
    (
        "start.distance_m=[1,2,3]",
        "start.distance_m is [1, 2, 3]; tuple should have at most 2 items",
    ),
    ("start.distance_m=[400]", "key 'start.distance_m.1' is missing"),
    ("reports.interval_s=5", "reports.interval_s is 5; input should be a valid tuple [s]"),
    ("search.methods=[]", "search.methods is []; tuple should have at least 1 item"),
    ("guidance.preview=maybe", "guidance.preview is 'maybe'; input should be a valid boolean"),
    ("guidance.law=3", "guidance.law is 3; input should be a valid string"),
    ("title=true", "title is true; input should be a valid string"),
    ("title=", "title: value is ''; give one word at least"),
    ('cases=[{name="My case"}]', "cases.0.name is 'My case'; string should match pattern"),
    (
        "criteria.crossing_interval_error=no",
        "criteria.crossing_interval_error is 'no'; input should be a valid number, unable to parse"
        " string as a number, or input should be False",
    ),
    ("criteria.tracking_error_rms_m=0", "value is 0; give a limit above 0, or false where"),
    ("place.utc=2026", "place.utc: value is 2026, a number; give date and time"),
    ("place.utc=1965-06-01T12:00:00Z", "give a time from 1970 to 2199"),
    ("seed=-1", "seed is -1; input should be greater than or equal to 0"),
    ("sweep.nu=[]", "sweep: nu has no values"),
    ("sweep.nu=[0.5, -0.1]", "sweep.nu is -0.1; speed ratios lie between 0 and 10"),
    (f"sweep.start.range_m=[{'9' * 400}]", "start.range_m has a number of more than 308 digits"),
    # Truth values are no numbers.
    ("wind.speed_mps=true", "wind.speed_mps is true; it must be a number"),
    ("seed=true", "seed is true; it must be a number"),
    ("start.distance_m=[true, 500]", "start.distance_m is [true, 500]; it must be a number"),
    ("arena.limits=[[0.5, true]]", "arena.limits is [[0.5, true]]; it must be a number"),
    ("criteria.tracking_error_rms_m=true", "tracking_error_rms_m is true; it must be a number"),
    (
        "payload={instruments=['sniffer'],limit_percent=true}",
        "limit_percent is true; it must be a number",
    ),
    # Names.
    ("wind.form_deg=3", "unknown key 'wind.form_deg'; did you mean 'wind.from_deg'?"),
    ("winds.speed_mps=5", "unknown key 'winds'; did you mean 'wind'?"),
    ("speed_mps=3", "did you mean 'vessel.speed_mps' or 'wind.speed_mps'?"),
    ("wind.direction=3", "unknown key 'wind.direction'; known in wind are speed_mps, from_deg"),
    ("nu=0.5", "unknown key 'nu'; did you mean 'sweep.nu' or 'vessel.speed_ratio'?"),
    ("vessel.manoeuvres=[{at_s=1, turn_dg=3}]", "did you mean 'vessel.manoeuvres.0.turn_deg'?"),
    ("vessel.manouvres.0.turn_deg=90", "unknown key 'vessel.manouvres'; did you mean"),
    ("vessel.manoeuvres.0.turn_deg=90", "vessel.manoeuvres has 0 entries"),
    ("vessel.manoeuvres.².turn_deg=5", "vessel.manoeuvres is {'²': {'turn_deg': 5}}"),
    ("keepout.radius_m.x=1", "unknown key 'keepout.radius_m.x'; 'radius_m' is a value"),
    ("payload.sensor=fast", "payload: key 'sensor' is not known; set payload.instruments"),
    ("plume.haze_m=1", "plume: key 'haze_m' is not known; set plume.model"),
    (
        "turbulence.level=sever",
        "turbulence.level is 'sever'; did you mean 'severe'? input should be",
    ),
    (
        "guidance.law=lyapunow",
        "unknown steering law 'lyapunow'; did you mean 'lyapunov'? known are",
    ),
    ("guidance.law=mine.py", "names a file, and no part in it; give mine.py:NAME"),
    ("study=monte_karlo", "study is 'monte_karlo'; did you mean 'monte_carlo'? it must be one of"),
    ('criteria.modes_at_end=["traking"]', "'traking' is not a mode; did you mean 'tracking'?"),
    # The form of an override.
    ("guidance.preview", "not of the form key=value"),
    ("extends=sim3", "extends stands in a scenario file"),
    ("sweep.nu=[half]", "--set sweep.nu='[half]' is not valid TOML"),
    (f"seed={DIGITS}", "has too many brackets or digits"),
    (f"sweep.nu={'[' * 3000}{']' * 3000}", "has too many brackets or digits"),
    ("wind.speed_mps=1\nflights=1", "a line break, and 'flights' after it"),
]


@pytest.mark.parametrize(("override", "words"), VALUES, ids=[words for _, words in VALUES])
def test_a_wrong_override_is_one_line_with_key_value_and_limit(override, words):
    assert words in refusal("sweep_nu", override)


TOGETHER = [
    ("sweep_nu", ["guidance.rate_hz=50"], "rate_hz is 50 Hz; it must divide 120 Hz, e.g. 40"),
    ("sweep_nu", ["flight.log_rate_hz=7"], "log_rate_hz is 7 Hz; it must divide 20 Hz"),
    ("sweep_nu", ["reference.path=circle"], "reference.path is 'circle' beside"),
    ("sweep_nu", ["flight.duration_max_s=0.05"], "duration_max_s is 0.05 s; at log_rate_hz, 10 Hz"),
    ("sweep_nu", ["guidance.command_limit=false"], "command_limit is false; an aircraft"),
    (
        "sweep_nu",
        ["fidelity=kinematic", "guidance.command_limit=false"],
        "set guidance.approach and guidance.keepout_guard to false",
    ),
    (
        "sweep_nu",
        ["start.place_m=[-100, 0]"],
        "place_m lies at 100 m; it must exceed keepout.radius_m",
    ),
    ("sweep_nu", ["guidance={tuning='bounded', law='lyapunov'}"], "set law to 'cascade'"),
    ("sweep_nu", ["study=paper"], "study is 'paper' without cases"),
    ("sweep_nu", ["study=falsify", "sweep={}", "comparison={}"], "draws is empty"),
    ("sweep_nu", ["fault.kind=engine", "fault.at_s=[100, 1500]"], "fault.at_s ends at 1500 s"),
    ("sea_wind", ["fidelity=kinematic", "turbulence.level=light"], "set fidelity to 'six_dof'"),
    ("sweep_nu", ["reports.interval_s=[1e-9, 1e-9]"], "more than 200000 reports"),
    ("ship_from_ais", ["sweep.vessel.speed_mps=[5, 6]"], "a file that it comes from"),
    ("sulphur", ["plume.source_height_m=500"], "plume.source_height_m is 500 m; exhaust"),
    ("sulphur", ["flight.altitude_m=5"], "flight.altitude_m is 5 m; exhaust is crossed from"),
    ("sulphur", ["flight.altitude_m=130"], "altitude_max_m, 20 to 120 m"),
    (
        "monte_carlo",
        ["method=subset", "statistics.violation_upper=0.1"],
        "by which plain sampling stops",
    ),
    ("monte_carlo", ["method=subset", "fidelity=both"], "it estimates one probability"),
    ("monte_carlo", ["method=subset", "draws=[]"], "draws is empty"),
    ("falsify", ["sweep.keepout.radius_m=[150, 200]"], "it searches one point"),
    ("falsify", ["search.generations=10000", "search.population=10000"], "the most is 1000000"),
    ("paper", ["sweep.nu=[0.3]", "sweep.wind.speed_mps=[1, 2]"], "beside 4 cases"),
    (
        "convergence",
        ["guidance.laws=cascade"],
        "guidance.laws is 'cascade'; input should be a valid tuple",
    ),
    ("sea_trial", ["shares=0.1"], "unknown key 'shares'; did you mean 'share'?"),
    ("sea_trial", ["wnd.speed_mps=5"], "unknown key 'wnd'; did you mean 'wind'?"),
    ("sea_trial", ["xyzzy=1"], "set, report, and the keys of each trial"),
    # Keys without effect.
    (
        "sweep_nu",
        ["criteria.resumes_within_periods=2"],
        "has no effect here: it is used by a vessel that",
    ),
    ("sulphur", ["plume.structure_length=0.5"], "set plume.structure_intensity"),
    ("sulphur", ["plume.meander=false", "plume.meander_length_up=1"], "leave plume.meander out"),
    ("sulphur", ["plume.mean=true", "plume.structure_intensity=0.3"], "leave plume.mean out"),
    ("sea_wind", ["plume.model=fluctuating", "plume.richardson=0.5"], "set emission.ship"),
    ("sulphur", ["emission.methane_slip_percent=3"], "add the table payload.channels.ch4"),
    ("sulphur", ["emission.black_carbon_g_kg=30", "payload.channels.bc=" + CELL], "is 30; input"),
    ("sulphur", ["emission.particle_number_1e15_kg=-1"], "particle_number_1e15_kg is -1; input"),
    ("sulphur", ["emission.methane_slip=3"], "did you mean 'emission.methane_slip_percent'?"),
    ("sulphur", ["payload.channels.co=" + CELL], "the key 'co'"),
    ("sulphur", ["payload.channels.ch4={t90_s=2}"], "no t90_s, delay_s or noise"),
    ("sulphur", ["payload.channels.ch4={t90=2}"], "did you mean 't90_s'?"),
    ("sulphur", ["payload.channels.ch4=3"], "give a table [channels.ch4]"),
    ("sulphur", ["payload.channels=3"], "channels is 3; input should be a valid dictionary"),
    ("plume_search", ["wind.height_m=20"], "'wind.height_m' has no effect here"),
    (
        "sulphur",
        ["guidance.mission=standoff", "following.distance=best_measurement"],
        "the vessel is circled",
    ),
    ("plume_search", ["guidance.mission=standoff"], "with following.plume 'estimated'"),
    ("sulphur", ["guidance.mission=standoff", "flight.until=verdict"], "flight.until 'verdict'"),
    ("sweep_nu", ["sweep.nu=[0.3, 0.6]", "comparison.nu=[0.33]"], "these ratios in sweep.nu, too"),
    (
        "monte_carlo",
        ["start.distance_m=[300, 350]"],
        "'start.range_m' is swept or sampled in every flight",
    ),
    (
        "monte_carlo",
        ["start.spread_deg=10"],
        "'start.aspect_deg' is swept or sampled in every flight",
    ),
    ("sweep_nu", ["vessel.speed_mps=5"], "'vessel.speed_mps' has no effect here"),
    ("sweep_nu", ["arena.window_s=20"], "it is used by laws side by side: set study to 'arena'"),
    ("patrol", ["criteria.settles=false"], "a patrol is judged by patrol.oracle_share_min"),
]


@pytest.mark.parametrize(("name", "overrides", "words"), TOGETHER, ids=[of[2] for of in TOGETHER])
def test_what_does_not_go_together_is_one_line(name, overrides, words):
    assert words in refusal(name, *overrides)


WIND = {"key": "wind.speed_mps", "uniform": [0.0, 5.0]}
SAME = [{"name": "own", "set": {"guidance.preview": of}} for of in (True, False)]

DOCUMENTS = [
    (
        {"draws": [{"key": "criteria.settles", "choice": [True]}]},
        "draws has 'criteria.settles', which",
    ),
    ({"draws": [{"key": "flights", "choice": [1, 2]}]}, "draws has 'flights', which sets nothing"),
    ({"draws": [WIND, WIND]}, "draws has 'wind.speed_mps' 2 times; give a key once"),
    ({"draws": [{**WIND, "normal": [1.0, 1.0]}]}, "has uniform and normal of"),
    (
        {"draws": [WIND, {"key": "draws.0.uniform", "choice": [[0, 1]]}]},
        "draws has 'draws.0.uniform'",
    ),
    (
        {"draws": [{"key": "aircraft", "choice": ["x8"]}]},
        "autopilot and margins are worked out once",
    ),
    ({"sweep": {"seed": [1, 2]}}, "sweep has 'seed', which sets nothing of a flight"),
    ({"sweep": {"nu": [0.3], "vessel.speed_ratio": [0.4]}}, "which are the same; give one of them"),
    (
        {"sweep": {"nu": [0.3]}, "draws": [{"key": "vessel.speed_ratio", "uniform": [0.2, 0.4]}]},
        "'vessel.speed_ratio' is in sweep and in draws; give it in one of them",
    ),
    (
        {"sweep": {"wind.from_deg": [*range(200)], "vessel.course_deg": [*range(200)]}},
        "40000 points",
    ),
    (
        {"cases": [{"name": "own", "set": {"seed": 3}}]},
        "case 'own' sets 'seed', on which its flights",
    ),
    ({"cases": [{"name": "own", "set_kinematic": {"flights": 3}}]}, "case 'own' sets 'flights'"),
    ({"cases": [{"name": "a"}, {"name": "a"}]}, "cases are called a, a; 'a' is there 2 times"),
    (
        {"comparison": {"variants": [{"name": "own", "set": {"draws": []}}]}},
        "comparison 'own' sets 'draws'",
    ),
    ({"comparison": {"variants": SAME}}, "'own' is there 2 times: give each a name of its own"),
    (
        {"cases": [{"name": "own", "comparison": True}], "comparison": {"variants": SAME[:1]}},
        "'own' is there 2 times",
    ),
    ({"cases": [{"name": "study", "comparison": True}]}, "'study' is there 2 times"),
    (
        {"arena": {"conditions": [{"name": "own", "title": "Own", "set": {"arena": {}}}]}},
        "condition 'own' sets 'arena'",
    ),
    ({"wind": {3: 4}, "extends": "sea_wind"}, "'wind' has the key 3"),
]


@pytest.mark.parametrize(("document", "words"), DOCUMENTS, ids=[words for _, words in DOCUMENTS])
def test_a_document_whose_experiment_cannot_be_flown_is_one_line(document, words):
    assert words in refusal({"title": "own", **document})


FILES = [
    ("title = \n", "not valid TOML"),
    ("[sweep]\nnu = [0.5]\n", "key 'title' is missing"),
    (
        'title = "t"\n[winds]\nspeed_mps = 5.0\n',
        "own.toml: unknown key 'winds'; did you mean 'wind'?",
    ),
    (f'title = "long"\nseed = {DIGITS}\n', "not valid TOML"),
    ('title = "t"\nextends = "own.toml"\n', "extends goes in a circle"),
    ('title = "t"\nextends = "sea_wnd"\n', "extends: unknown scenario 'sea_wnd'; did you mean"),
    ('title = "t"\nextends = 3\n', "extends is 3; give one catalog name"),
]


@pytest.mark.parametrize(("text", "words"), FILES, ids=[words for _, words in FILES])
def test_what_is_wrong_in_a_file_names_the_file(tmp_path, text, words):
    path = tmp_path / "own.toml"
    path.write_text(text, encoding="utf-8")
    message = refusal(str(path), "seed=3")
    assert words in message
    assert "own.toml" in message


def refusal(name, *overrides):
    with pytest.raises(InputError) as refused:
        load_study(name, overrides)
    message = str(refused.value)
    assert "\n" not in message
    return message
